//! A smooth random deformation.

use crate::geometry::diagonal;
use crate::mesh::Mesh;
use crate::random::Random;
use glam::DVec3;
use std::f64::consts::TAU;

/// Waves of which the field is the sum: enough for it to be nearly Gaussian.
const WAVES: usize = 64;

/// Displaces by a random field of one wavelength, scaled so that the RMS displacement of the vertices is `rms_rel`; both are
/// fractions of the bounding box's diagonal. It is what somebody would try who knows that a mark is smooth, and not where.
pub fn warp(mesh: &Mesh, wavelength: f64, rms_rel: f64, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let diagonal = diagonal(&mesh.positions);
    let waves: Vec<(DVec3, f64, DVec3)> = (0..WAVES)
        .map(|_| {
            let number = random.direction() * (TAU / (wavelength * diagonal));
            let phase = TAU * random.unit();
            let amplitude = DVec3::new(random.normal(), random.normal(), random.normal());
            (number, phase, amplitude)
        })
        .collect();
    let field = |p: &DVec3| -> DVec3 {
        waves
            .iter()
            .map(|&(number, phase, amplitude)| amplitude * libm::cos(number.dot(*p) + phase))
            .sum()
    };
    let displacements: Vec<DVec3> = mesh.positions.iter().map(field).collect();
    let squares: f64 = displacements.iter().map(|d| d.length_squared()).sum();
    let rms = (squares / displacements.len().max(1) as f64).sqrt();
    let scale = if rms > 0.0 {
        rms_rel * diagonal / rms
    } else {
        0.0
    };
    let pairs = mesh.positions.iter().zip(displacements);
    mesh.with_positions(pairs.map(|(p, d)| *p + d * scale).collect())
}
