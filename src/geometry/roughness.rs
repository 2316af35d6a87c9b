//! How rough a surface is, vertex by vertex: where a displacement will not be seen.

use super::vertex_normals;
use crate::mesh::{Mesh, Rings};
use crate::order::order_by;
use glam::DVec3;

/// V roughnesses relative to their median, 0.25 to 3: the square root of how far the normals of a neighbourhood disagree.
///
/// Normals are averaged over 12 half-steps of the umbrella operator; what that takes from their length is averaged in turn.
/// (Perceptual metrics such as MSDM, Lavoue et al. 2006, rate distortions by the roughness that masks them.)
pub fn roughness(mesh: &Mesh, rings: &Rings) -> Vec<f64> {
    let mut normals = vertex_normals(mesh);
    for _ in 0..12 {
        normals = half_step(&normals, rings, DVec3::ZERO);
    }
    let mut spread: Vec<f64> = normals
        .iter()
        .map(|normal| (1.0 - normal.length()).max(0.0))
        .collect();
    for _ in 0..6 {
        spread = half_step(&spread, rings, 0.0);
    }
    let rough: Vec<f64> = spread.iter().map(|spread| spread.sqrt()).collect();
    // The bits of positive numbers are in the order of the numbers.
    let curved = rough.iter().filter(|&&rough| rough > 1e-4);
    let sorted = order_by(curved.map(|rough| rough.to_bits()));
    let median = sorted
        .get(sorted.len() / 2)
        .map_or(1.0, |&(bits, _)| f64::from_bits(bits));
    rough
        .iter()
        .map(|rough| (rough / median).clamp(0.25, 3.0))
        .collect()
}

/// Half of each value and half of its neighbours' mean.
fn half_step<T>(values: &[T], rings: &Rings, zero: T) -> Vec<T>
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let step = |v: usize| {
        let neighbours = rings.neighbours(v);
        if neighbours.is_empty() {
            return values[v];
        }
        let sum = neighbours
            .iter()
            .fold(zero, |sum, &n| sum + values[n as usize]);
        values[v] * 0.5 + sum * (0.5 / neighbours.len() as f64)
    };
    (0..values.len()).map(step).collect()
}
