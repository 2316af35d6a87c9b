//! The data structure: positions, triangles, and how they hang together. Accepts what real assets contain: holes, edges
//! with three faces and more, inconsistent winding, many components, isolated vertices.

mod admissible;
mod edges;
pub mod shapes;

pub use admissible::{Admissible, Orbit};
pub use edges::{Edges, Pair, Rings, Winding};

use glam::DVec3;

/// A triangle mesh with V vertices and F triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// V positions, finite, in scene units.
    pub positions: Vec<DVec3>,
    /// F triples of distinct vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The same triangles with other positions.
    pub fn with_positions(&self, positions: Vec<DVec3>) -> Mesh {
        Mesh {
            positions,
            triangles: self.triangles.clone(),
        }
    }

    /// The area of all triangles, in squared scene units.
    pub fn area(&self) -> f64 {
        let double = |&triangle: &[u32; 3]| {
            let [a, b, c] = self.corners(triangle);
            (b - a).cross(c - a).length()
        };
        self.triangles.iter().map(double).sum::<f64>() * 0.5
    }

    /// The mean length of a triangle's side, in scene units; 0 without triangles.
    pub fn mean_edge(&self) -> f64 {
        let perimeter = |&triangle: &[u32; 3]| {
            let [a, b, c] = self.corners(triangle);
            a.distance(b) + b.distance(c) + c.distance(a)
        };
        let perimeters = self.triangles.iter().map(perimeter);
        perimeters.sum::<f64>() / (3 * self.triangles.len()).max(1) as f64
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|vertex| self.positions[vertex as usize])
    }
}
