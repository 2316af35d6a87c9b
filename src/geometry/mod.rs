//! Algorithms on a mesh, one per file.

mod distortion;
mod normal;
mod orientation;
mod pose;
mod quadrature;
mod roughness;
pub mod spectral;
mod surface;

pub use distortion::{Distortion, diagonal};
pub use normal::vertex_normals;
pub use orientation::outward;
pub use pose::Pose;
pub use quadrature::{Sample, samples};
pub use roughness::roughness;
pub use surface::{Nearest, Surface};
