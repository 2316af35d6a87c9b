//! Algorithms on a mesh, one per file.

mod distortion;
mod normal;
mod pose;

pub use distortion::{Distortion, diagonal};
pub use normal::vertex_normals;
pub use pose::Pose;
