//! The parts of a mesh that hang together by edges: what a person sees as one thing.

use crate::mesh::{Edges, Mesh};
use glam::DVec3;

/// The connected parts of a mesh.
pub struct Parts {
    /// For each triangle the number of its part.
    pub of_triangles: Vec<u32>,
    /// The diagonal of each part's axis-parallel bounding box, in scene units.
    pub diagonals: Vec<f64>,
}

impl Parts {
    /// Finds them. O(V + F log D), D the most triangles at a vertex.
    pub fn new(mesh: &Mesh) -> Parts {
        Parts::named(mesh, Edges::new(mesh).components())
    }

    /// Of a mesh whose triangles are in parts of these numbers.
    pub fn named(mesh: &Mesh, of_triangles: Vec<u32>) -> Parts {
        let num_parts = of_triangles
            .iter()
            .max()
            .map_or(0, |&last| last as usize + 1);
        let mut boxes = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); num_parts];
        for (&triangle, &part) in mesh.triangles.iter().zip(&of_triangles) {
            let (low, high) = &mut boxes[part as usize];
            for corner in mesh.corners(triangle) {
                (*low, *high) = (low.min(corner), high.max(corner));
            }
        }
        Parts {
            of_triangles,
            diagonals: boxes
                .into_iter()
                .map(|(low, high)| (high - low).length())
                .collect(),
        }
    }
}
