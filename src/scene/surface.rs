//! Positions and triangles that are no document's: a suspect in another format.

use super::gather::Gathering;
use super::{Count, Scene, SceneError};
use crate::mesh::Mesh;

impl Scene {
    /// The mesh of a surface, welded as a document's is.
    ///
    /// # Errors
    ///
    /// [`SceneError::TooLarge`], [`SceneError::NoVertex`], [`SceneError::NotANumber`] for a position that a triangle uses, and
    /// [`SceneError::NoTriangles`].
    pub fn surface(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Mesh, SceneError> {
        Count {
            parts: 1,
            elements: positions.len() as u64,
            triangles: triangles.len() as u64,
            unbacked: 0,
        }
        .check()?;
        let is_beyond = |&vertex: &u32| vertex as usize >= positions.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|vertex| is_beyond(vertex)) {
                return Err(SceneError::NoVertex {
                    triangle,
                    vertex,
                    count: positions.len(),
                });
            }
        }
        Gathering::of_surface(positions, triangles).surface(positions)
    }
}
