//! A model among others.

use crate::mesh::{Mesh, shapes};
use crate::random::Random;
use glam::DVec3;
use std::f64::consts::TAU;

/// Things that stand around the model.
const THINGS: u32 = 8;

/// Puts the model, y up, on a square slab whose sides are `times` the model's longest one, 2 or more, with eight boxes, balls, capsules and
/// rings of random sizes about it; all of it one mesh, not welded, the model in the middle of the order.
pub fn into_scene(mesh: &Mesh, times: f64, seed: u64) -> Mesh {
    let Some(&first) = mesh.positions.first() else {
        return Mesh::default();
    };
    let positions = mesh.positions.iter();
    let (low, high) = positions.fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
    let size = (high - low).max_element();
    let floor = DVec3::new((low.x + high.x) / 2.0, low.y, (low.z + high.z) / 2.0);
    let side = times * size;
    let thickness = 0.01 * side;

    let placed = |shape: Mesh, scale: f64, centre: DVec3| {
        let positions = shape.positions.iter();
        shape.with_positions(positions.map(|&p| floor + p * scale + centre).collect())
    };
    let slab = shapes::cuboid(DVec3::new(side, thickness, side), [24, 1, 24]);
    let mut parts = vec![placed(slab, 1.0, DVec3::NEG_Y * (thickness / 2.0))];
    let mut random = Random::new(seed);
    for number in 0..THINGS {
        // Each about one unit high.
        let shape = match number % 4 {
            0 => shapes::cuboid(DVec3::new(0.8, 1.0, 0.6), [6, 8, 5]),
            1 => shapes::icosphere(2),
            2 => shapes::capsule(16, 20),
            _ => shapes::torus(32, 12),
        };
        let scale = size * (0.1 + 0.15 * random.unit());
        let azimuth = TAU * (f64::from(number) + 0.5 * random.unit()) / f64::from(THINGS);
        let distance = side * (0.42 + 0.06 * random.unit());
        let centre = DVec3::new(
            distance * libm::cos(azimuth),
            scale,
            distance * libm::sin(azimuth),
        );
        parts.push(placed(shape, scale, centre));
        if number == THINGS / 2 {
            parts.push(mesh.clone());
        }
    }
    Mesh::joined(parts)
}
