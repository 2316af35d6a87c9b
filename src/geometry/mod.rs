//! Algorithms on a mesh, one per file.

mod arc;
mod distortion;
mod normal;
mod orientation;
mod pose;
mod quadrature;
mod quadric;
mod roughness;
pub mod spectral;
mod surface;

pub use arc::refined;
pub use distortion::{Distortion, diagonal};
pub use normal::vertex_normals;
pub use orientation::outward;
pub use pose::Pose;
pub use quadrature::{Quadrature, Sample};
pub use quadric::{Quadric, collapse_costs};
pub use roughness::roughness;
pub use surface::{Nearest, Surface};
