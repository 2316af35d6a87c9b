//! Rotation, scale and translation.

use crate::geometry::diagonal;
use crate::mesh::Mesh;
use crate::random::Random;

/// A random rotation, a scale from 0.2 to 5, and a translation by about the model's size.
pub fn similarity(mesh: &Mesh, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let linear = random.rotation() * (0.2 + 4.8 * random.unit());
    let translation = random.direction() * diagonal(&mesh.positions);
    mesh.with_positions(
        mesh.positions
            .iter()
            .map(|&p| linear * p + translation)
            .collect(),
    )
}
