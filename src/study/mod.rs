//! The seed paper's study: what smoothing does to the vertices that a mark would be in.
//!
//! Every function answers one question about one mesh; a mesh of the paper's size is made by [`brought`].

pub mod errors;
mod hosts;
mod map;
mod smoothing;
mod spread;

pub use hosts::{Count, HostsOptions, HostsRow, Rule, RuleCounts, hosts};
pub use map::{Fields, Tracing, fields, trace};
pub use smoothing::Smoothing;
pub use spread::Spread;

use crate::attack::simplify_to;
use crate::carrier::osveta::{Ranking, rank};
use crate::mesh::Mesh;
use crate::random::Random;

/// Faces of the paper's model after its simplification.
pub const NUM_FACES: usize = 11_732;

/// A mesh as the paper's: simplified to [`NUM_FACES`] if it has more.
pub fn brought(mesh: &Mesh) -> Mesh {
    simplify_to(mesh, NUM_FACES)
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
