//! Algorithms on a mesh, one per file.

mod arc;
mod curvature;
mod cuts;
mod deformation;
mod dihedral;
mod distortion;
mod facet;
mod fins;
mod leeway;
mod linear;
mod merge;
mod msdm;
mod normal;
mod orientation;
mod parts;
mod pieces;
pub mod places;
mod pose;
mod quadrature;
mod quadric;
mod quality;
mod registration;
mod repeats;
mod roughness;
mod rounding;
mod seams;
pub mod spectral;
mod strays;
mod surface;

pub use arc::refined;
pub use curvature::{
    Curvature, CurvatureIntegrals, cotangents, curvature_integrals, fitted_curvature,
};
pub use cuts::cuts;
pub use deformation::Deformation;
pub use dihedral::{Dihedral, dihedrals};
pub use distortion::{Distortion, diagonal};
pub use fins::without_fins;
pub use leeway::{Bounds, Leeway};
pub use linear::{conjugate_gradients, symmetric_eigen, unconditioned};
pub use merge::merged;
pub use normal::{face_areas, normal_deviations, vertex_normals};
pub use orientation::{oriented, outward};
pub use parts::Parts;
pub use pieces::{Piece, Pieces};
pub use pose::Pose;
pub use quadrature::{Quadrature, Sample};
pub use quadric::{Quadric, collapse_costs};
pub use quality::Quality;
pub use registration::registered;
pub use repeats::without_repeats;
pub use roughness::roughness;
pub use rounding::{evenly, rounded, rounded_for_web};
pub use seams::{Seams, seams};
pub use strays::without_strays;
pub use surface::{Nearest, Surface};
