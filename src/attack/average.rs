//! Collusion.

use crate::mesh::Mesh;
use glam::DVec3;

/// The mean of copies of one model: what several buyers make of theirs, or one of theirs and the original. All have the
/// vertices of the first, in its order.
pub fn average(copies: &[Mesh]) -> Mesh {
    let Some(first) = copies.first() else {
        return Mesh::default();
    };
    let mean =
        |v: usize| copies.iter().map(|copy| copy.positions[v]).sum::<DVec3>() / copies.len() as f64;
    first.with_positions((0..first.positions.len()).map(mean).collect())
}
