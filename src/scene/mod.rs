//! Document <-> welded world-space mesh, and the map back to every accessor element.
//!
//! Rules: corners weld where their world positions agree bit by bit, and where a codec or an exporter parted them by a little
//! (`geometry::seams`), so that all copies of a vertex at a seam are one vertex and move as one. Every node that places a mesh
//! adds an instance; a shared vertex has one displacement, which moves all its instances. Skinned meshes stay as they are
//! modelled (the bind pose). Morph targets are deltas and stay as they are. Triangles with fewer than three distinct corners
//! are dropped. Only elements that a triangle uses become vertices; points and lines that lie on the surface move with it.

#![deny(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

mod count;
mod follow;
mod gather;
mod orbits;
mod plain;
mod room;
mod scatter;
mod surface;
mod uses;

pub use count::Count;
pub use plain::to_glb;

use crate::document::{Document, DocumentError};
use crate::geometry::Parts;
use crate::mesh::{Admissible, Mesh};
use glam::{DAffine3, DMat3, DVec3};

/// The most elements of position accessors that a scene may show, every instance counted. Small files can ask for more, by showing
/// the same bytes many times.
///
/// Measured natively, as the most memory that a run of the command line held: loose triangles take up to 250 bytes for each of
/// their elements (`embed`, 2.1 million elements), ribbons with a vertex for each triangle 330.
pub const MAX_ELEMENTS: u64 = if IN_A_TAB { 1 << 22 } else { 1 << 24 };

/// The most triangles that a scene may show, every instance counted.
///
/// Measured likewise: closed surfaces take up to 370 bytes for each of their triangles, half a vertex for each included
/// (`measure`, 2.1 million triangles), triangles between few vertices 210 (`embed`, 2 million). So 2^24 triangles take up to 6 GiB,
/// and in a browser tab, which has 4 GiB of addresses, 2^22 of them 1.5 GiB beside the copies of the file.
pub const MAX_TRIANGLES: u64 = if IN_A_TAB { 1 << 22 } else { 1 << 24 };

/// The most mesh parts that a scene may show: primitives, each as often as a node shows it. One of three vertices takes 800 bytes
/// (`inspect`, 262 144 parts), so these take 0.8 GiB, and 0.2 GiB in a browser tab.
pub const MAX_PARTS: u64 = if IN_A_TAB { 1 << 18 } else { 1 << 20 };

/// Whether an address has 32 bits, as in WebAssembly.
const IN_A_TAB: bool = cfg!(target_pointer_width = "32");

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
    /// A triangle of a surface names a vertex that is not there.
    #[error("triangle {triangle} uses vertex {vertex}, but there are only {count}")]
    NoVertex {
        /// The triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// The number of vertices.
        count: usize,
    },
    /// A vertex of a surface that a triangle uses is not at a finite place.
    #[error("vertex {vertex} has a position that is not a finite number: repair the mesh first")]
    NotANumber {
        /// The vertex.
        vertex: u32,
    },
    /// All positions are in bytes that have another use, or in none.
    #[error(
        "no vertex can be moved: the bytes of all positions have another use too (an attribute of another name, a morph target, an \
         animation), or are not stored; export the model with positions of their own"
    )]
    NothingMovable,
    /// The values that positions can take are too far apart for a mark. Told where no mark could be read back.
    #[error(
        "the numbers that the file keeps positions in are {percent:.2} % of the model's size apart, too coarse for a mark: 32-bit \
         numbers far away from the origin are, and integers of few bits; move the model to the origin and keep its place in the \
         translation of a node, or quantize with more bits"
    )]
    CoarseNumbers {
        /// Their distance, in percent of the diagonal.
        percent: f64,
    },
    /// More than 2^24 triangles or vertices (2^22 in a browser tab), 2^20 parts (2^18 there), or 2^20 vertices that no bytes of the
    /// file stand behind; every instance counted.
    #[error(
        "the scene has {value} {what}, every instance counted, and the limit is {limit}: {advice}"
    )]
    TooLarge {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        value: u64,
        /// The largest number accepted.
        limit: u64,
        /// What helps.
        advice: &'static str,
    },
}

impl SceneError {
    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            SceneError::Document(error) => error.code(),
            SceneError::NoTriangles => "scene.no-triangles",
            SceneError::NotFinite { .. } => "scene.not-finite",
            SceneError::NoVertex { .. } => "scene.no-vertex",
            SceneError::NotANumber { .. } => "scene.not-a-number",
            SceneError::NothingMovable => "scene.nothing-movable",
            SceneError::CoarseNumbers { .. } => "scene.coarse-numbers",
            SceneError::TooLarge { .. } => "scene.too-large",
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
    /// The parts of the triangles before seams were closed, where any were.
    parts: Option<Vec<u32>>,
    /// The corners of triangles that lie far from the model, and are no part of the mesh.
    pub strays: Vec<[DVec3; 3]>,
    placements: Vec<Placement>,
}

/// One accessor as one node shows it.
#[derive(Clone, Debug)]
struct Placement {
    node: usize,
    accessor: usize,
    to_world: DAffine3,
    /// The linear part's inverse; `None` where it has none.
    to_local: Option<DMat3>,
    /// The vertex of each element; `None` for elements that no triangle uses.
    vertices: Vec<Option<u32>>,
}

impl Scene {
    /// What a person sees as one thing each: the components of the mesh, before seams between them were closed.
    pub fn parts(&self) -> Parts {
        match &self.parts {
            Some(parts) => Parts::named(&self.mesh, parts.clone()),
            None => Parts::new(&self.mesh),
        }
    }
}

impl Scene {
    /// Where the strays lie, in a sentence for people; `None` without strays.
    pub fn strays_in_words(&self) -> Option<String> {
        let [first, _, _] = self.strays.first()?;
        Some(format!(
            "{} of the file's triangles lie far from the model, the first at ({}, {}, {}): they are left as they are, and its size is taken without them",
            self.strays.len(),
            first.x,
            first.y,
            first.z
        ))
    }
}

impl Scene {
    /// What the node is called that shows most of some vertices, or the next above it that has a name.
    pub fn name_of<'a>(&self, document: &'a Document, vertices: &[u32]) -> Option<&'a str> {
        let mut is_asked = vec![false; self.mesh.positions.len()];
        for &vertex in vertices {
            if let Some(is_asked) = is_asked.get_mut(vertex as usize) {
                *is_asked = true;
            }
        }
        let num_shown = |placement: &&Placement| {
            let shown = placement.vertices.iter().flatten();
            shown
                .filter(|&&vertex| is_asked.get(vertex as usize) == Some(&true))
                .count()
        };
        let node = self.placements.iter().max_by_key(num_shown)?.node;
        let parent_of = |node: usize| {
            let mut nodes = document.nodes().iter();
            nodes.position(|other| other.children.contains(&node))
        };
        let above = std::iter::successors(Some(node), |&node| parent_of(node));
        let name = |node: usize| document.nodes().get(node)?.name.as_deref();
        above.filter_map(name).find(|name| !name.is_empty())
    }
}

impl Placement {
    /// The vertex of an element.
    fn vertex(&self, element: u32) -> Option<u32> {
        *self.vertices.get(element as usize)?
    }
}

/// The inverse of a matrix that has a usable one.
fn inverse(matrix: DMat3) -> Option<DMat3> {
    let scale = matrix
        .to_cols_array()
        .iter()
        .fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    let inverse = matrix.inverse();
    (matrix.determinant().abs() > 1e-12 * scale * scale * scale && inverse.is_finite())
        .then_some(inverse)
}
