//! The seed paper's study: what smoothing does to the vertices that a mark would be in.
//!
//! Every function answers one question about one mesh; a mesh of the paper's size is made by [`Preparation`].

pub mod errors;
mod hosts;
mod map;
mod report;
mod smoothing;
mod spread;

pub use hosts::{Count, HostsOptions, HostsRow, Rule, RuleCounts, hosts};
pub use map::{Fields, Tracing, fields, trace};
pub use report::{Study, study};
pub use smoothing::Smoothing;
pub use spread::Spread;

use crate::attack::{optimize, simplify_to};
use crate::carrier::osveta::{Ranking, rank};
use crate::mesh::Mesh;
use crate::random::Random;

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

/// The vertices in decreasing order of stability, equals at random: by index the original vertices, which come first in every
/// smoothed mesh, would win every tie.
fn ranked(mesh: &Mesh, ranking: Ranking, seed: u64) -> Vec<u32> {
    let names = Random::new(seed).permutation(mesh.positions.len());
    let mut renamed = Mesh {
        positions: mesh.positions.clone(),
        triangles: mesh
            .triangles
            .iter()
            .map(|triangle| triangle.map(|vertex| names[vertex as usize]))
            .collect(),
    };
    let mut vertices = vec![0; names.len()];
    for (vertex, (&name, &position)) in (0..).zip(names.iter().zip(&mesh.positions)) {
        renamed.positions[name as usize] = position;
        vertices[name as usize] = vertex;
    }
    let order = rank(&renamed, ranking).order;
    order
        .into_iter()
        .map(|name| vertices[name as usize])
        .collect()
}
