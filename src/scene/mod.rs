//! Document <-> welded world-space mesh, and the map back to every accessor element.
//!
//! Rules: corners weld where their world positions agree bit by bit, so that all copies of a vertex at a UV seam are one
//! vertex and move as one. Every node that places a mesh adds an instance; a shared vertex has one displacement, which moves
//! all its instances. Skinned meshes stay as they are modelled (the bind pose). Morph targets are deltas and stay as they
//! are. Triangles with fewer than three distinct corners are dropped. Only elements that a triangle uses become vertices.

#![deny(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

mod gather;
mod orbits;
mod plain;
mod scatter;
mod uses;

pub use plain::to_glb;

use crate::document::DocumentError;
use crate::mesh::{Admissible, Mesh};
use glam::{DAffine3, DMat3};

/// Elements of all placements together. Small files can ask for more, by showing the same bytes many times.
pub const MAX_ELEMENTS: usize = 1 << 24;

/// Why there is no mesh in a document.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The document cannot be read.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// No node of any scene shows a triangle.
    #[error("the file has no triangles: points, lines and empty scenes cannot carry a mark")]
    NoTriangles,
    /// A node's transform carries vertices out of the range of numbers.
    #[error("node {node} moves vertices out of the range of numbers")]
    NotFinite {
        /// Index of the node.
        node: usize,
    },
    /// More than fits into a browser tab's memory.
    #[error("the scene has more than {MAX_ELEMENTS} vertices, every instance counted")]
    TooLarge,
}

impl SceneError {
    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            SceneError::Document(error) => error.code(),
            SceneError::NoTriangles => "scene.no-triangles",
            SceneError::NotFinite { .. } => "scene.not-finite",
            SceneError::TooLarge => "scene.too-large",
        }
    }
}

/// A document's triangles in world space.
#[derive(Clone, Debug)]
pub struct Scene {
    /// All instances, welded.
    pub mesh: Mesh,
    /// Which displacements of its vertices can be written back.
    pub admissible: Admissible,
    placements: Vec<Placement>,
}

/// One accessor as one node shows it.
#[derive(Clone, Debug)]
struct Placement {
    accessor: usize,
    to_world: DAffine3,
    /// The linear part's inverse; `None` where it has none.
    to_local: Option<DMat3>,
    /// The vertex of each element; `None` for elements that no triangle uses.
    vertices: Vec<Option<u32>>,
}
