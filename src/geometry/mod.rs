//! Algorithms on a mesh, one per file.

mod distortion;
mod normal;

pub use distortion::{Distortion, diagonal};
pub use normal::vertex_normals;
