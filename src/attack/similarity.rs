//! Rotation, scale and translation.

use super::noise::mean_radius;
use crate::mesh::Mesh;
use crate::random::Random;
use glam::DVec3;

/// A random translation, by up to 5 mean distances of the vertices from their mean along each axis, then a rotation by any angle about any
/// axis, and a scale from 0.1 to 10: the LIRIS benchmark's (Wang et al. 2010).
pub fn similarity(mesh: &Mesh, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let farthest = 5.0 * mean_radius(mesh);
    let mut amount = || (2.0 * random.unit() - 1.0) * farthest;
    let translation = DVec3::new(amount(), amount(), amount());
    let linear = random.rotation() * (0.1 + 9.9 * random.unit());
    mesh.with_positions(
        mesh.positions
            .iter()
            .map(|&p| linear * (p + translation))
            .collect(),
    )
}
