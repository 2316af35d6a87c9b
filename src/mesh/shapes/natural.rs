//! Organic shapes and land.

use super::parts::{globe, irregular_quads, sheet};
use crate::mesh::Mesh;
use glam::DVec3;
use std::f64::consts::TAU;

/// A torus knot with relief, V = `around * across` vertices, about 4 units wide.
pub fn torus_knot(around: u32, across: u32) -> Mesh {
    let centre = |t: f64| {
        let (u, v) = (2.0 * t, 3.0 * t);
        let radius = 1.2 + 0.45 * libm::cos(v);
        DVec3::new(
            radius * libm::cos(u),
            radius * libm::sin(u),
            0.45 * libm::sin(v),
        )
    };
    let position = |i: u32, j: u32| {
        let t = TAU * f64::from(i) / f64::from(around);
        let s = TAU * f64::from(j) / f64::from(across);
        let tangent = (centre(t + 1e-3) - centre(t - 1e-3)).normalize();
        let side = tangent.cross(DVec3::Z).normalize();
        let up = side.cross(tangent);
        let thickness =
            0.22 + 0.02 * libm::sin(9.0 * t + 3.0 * s) + 0.012 * libm::sin(23.0 * t - 5.0 * s);
        centre(t) + (side * libm::cos(s) + up * libm::sin(s)) * thickness
    };
    let positions = (0..around)
        .flat_map(|i| (0..across).map(move |j| position(i, j)))
        .collect();
    Mesh {
        positions,
        triangles: irregular_quads(around, across, |i, j| i % around * across + j % across),
    }
}

/// A rock: an ellipsoid with half-axes of 1.3, 1 and 0.75, with hills and valleys, V = `rings * sectors + 2` vertices.
pub fn asteroid(rings: u32, sectors: u32) -> Mesh {
    let radius = |d: DVec3| {
        1.0 + 0.06 * libm::sin(5.0 * d.x + 2.0 * d.y)
            + 0.05 * libm::sin(7.0 * d.y * d.z + 3.0 * d.x)
    };
    globe(rings, sectors, |d| {
        d * radius(d) * DVec3::new(1.3, 1.0, 0.75)
    })
}

/// A creature in few faces, of a game: a body with a head, four legs and a tail, no two alike. V = 602.
pub fn low_poly() -> Mesh {
    // Directions of its limbs, how long and how slender they are.
    let limbs = [
        (DVec3::new(1.0, 0.1, 0.55), 0.75, 9.0),
        (DVec3::new(0.7, 0.7, -0.7), 0.6, 14.0),
        (DVec3::new(0.75, -0.65, -0.7), 0.65, 14.0),
        (DVec3::new(-0.7, 0.6, -0.75), 0.7, 12.0),
        (DVec3::new(-0.65, -0.7, -0.7), 0.55, 12.0),
        (DVec3::new(-1.0, -0.15, 0.4), 0.9, 22.0),
    ];
    globe(20, 30, |d| {
        let reach = |&(limb, length, slenderness): &(DVec3, f64, f64)| {
            length * libm::exp(slenderness * (d.dot(limb.normalize()) - 1.0))
        };
        d * (0.6 + limbs.iter().map(reach).sum::<f64>()) * DVec3::new(1.3, 0.9, 1.0)
    })
}

/// A square of side 1 with hills, open at its border, V = `(cells + 1)^2` vertices.
pub fn terrain(cells: u32) -> Mesh {
    let height = |x: f64, y: f64| {
        0.05 * libm::sin(9.0 * x + 4.0 * y) + 0.03 * libm::sin(17.0 * y - 6.0 * x * y)
    };
    sheet(cells, cells, |x, y| DVec3::new(x, y, height(x, y)))
}

/// A leaf: closed, 2.6 long, 0.03 thick, and curled, V = `rings * sectors + 2` vertices.
pub fn leaf(rings: u32, sectors: u32) -> Mesh {
    globe(rings, sectors, |d| {
        let (x, y) = (1.3 * d.x, (0.8 + 0.2 * d.x) * d.y);
        let curl = 0.2 * x * x - 0.15 * y * y * (1.0 + x) + 0.02 * libm::sin(9.0 * x + 5.0 * y);
        DVec3::new(x, y, curl + 0.015 * d.z)
    })
}
