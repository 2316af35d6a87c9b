//! Additive noise.

use crate::mesh::{Edges, Mesh};
use crate::random::Random;
use glam::DVec3;

/// Moves every coordinate by a uniform random amount of up to `amplitude` times the mean distance of the vertices from their
/// mean; vertices of a boundary stay. The noise of the LIRIS benchmark (Wang et al. 2010) has amplitudes of 0.0005 to 0.005.
pub fn noise(mesh: &Mesh, amplitude: f64, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let size = amplitude * mean_radius(mesh);
    let mut amount = || (2.0 * random.unit() - 1.0) * size;
    let mut positions: Vec<DVec3> = mesh
        .positions
        .iter()
        .map(|p| *p + DVec3::new(amount(), amount(), amount()))
        .collect();
    for (from, _) in Edges::new(mesh).boundary(&mesh.triangles) {
        positions[from as usize] = mesh.positions[from as usize];
    }
    mesh.with_positions(positions)
}

/// The mean distance of the vertices from their mean: the benchmark's unit of length.
pub(super) fn mean_radius(mesh: &Mesh) -> f64 {
    let count = mesh.positions.len().max(1) as f64;
    let mean = mesh.positions.iter().sum::<DVec3>() / count;
    mesh.positions.iter().map(|p| p.distance(mean)).sum::<f64>() / count
}
