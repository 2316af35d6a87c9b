//! Section IV: how a mesh is brought to the size of the paper's model.

use crate::attack::{optimize, simplify_to};
use crate::mesh::Mesh;

/// Faces of the paper's model after its simplification.
pub const NUM_FACES: usize = 11_732;

/// How a mesh is brought to the paper's size.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum Preparation {
    /// As the paper does, by a face threshold: it leaves thin triangles.
    Optimize,
    /// By quadric error metrics: it leaves triangles that follow the shape.
    Simplify,
}

impl Preparation {
    /// Both.
    pub const ALL: [Preparation; 2] = [Preparation::Optimize, Preparation::Simplify];

    /// The name that scripts and pages use.
    pub fn name(self) -> &'static str {
        match self {
            Preparation::Optimize => "optimize",
            Preparation::Simplify => "simplify",
        }
    }

    /// The preparation of a name.
    pub fn from_name(name: &str) -> Option<Preparation> {
        Self::ALL
            .into_iter()
            .find(|preparation| preparation.name() == name)
    }

    /// A mesh of [`NUM_FACES`] at most.
    pub fn apply(self, mesh: &Mesh) -> Mesh {
        match self {
            Preparation::Optimize => optimize(mesh, NUM_FACES),
            Preparation::Simplify => simplify_to(mesh, NUM_FACES),
        }
    }
}
