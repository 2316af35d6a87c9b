//! Additive noise.

use crate::mesh::Mesh;
use crate::random::Random;
use glam::DVec3;

/// Moves every coordinate by a uniform random amount of up to `amplitude` times the mean distance of the vertices from their
/// mean. The noise of the LIRIS benchmark (Wang et al. 2010) has amplitudes of 0.0005 to 0.005.
pub fn noise(mesh: &Mesh, amplitude: f64, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let count = mesh.positions.len().max(1) as f64;
    let mean = mesh.positions.iter().sum::<DVec3>() / count;
    let size = amplitude * mesh.positions.iter().map(|p| p.distance(mean)).sum::<f64>() / count;
    let mut amount = || (2.0 * random.unit() - 1.0) * size;
    mesh.with_positions(
        mesh.positions
            .iter()
            .map(|p| *p + DVec3::new(amount(), amount(), amount()))
            .collect(),
    )
}
