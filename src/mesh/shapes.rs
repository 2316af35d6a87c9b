//! Generated meshes, for demonstrations, tests and benchmarks. Deterministic: a shape is a function of its arguments.

use super::Mesh;
use crate::random::Random;
use glam::DVec3;
use std::f64::consts::TAU;

/// A torus knot with relief, V = `around * across` vertices, about 4 units wide. Its diagonals are turned at random, so
/// that its connectivity is as irregular as that of a modelled or scanned mesh.
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
    let direction = |i: u32, j: u32| {
        let polar = TAU / 2.0 * f64::from(i + 1) / f64::from(rings + 1);
        let azimuth = TAU * f64::from(j) / f64::from(sectors);
        let (sin, cos) = (libm::sin(polar), libm::cos(polar));
        DVec3::new(sin * libm::cos(azimuth), sin * libm::sin(azimuth), cos)
    };
    let mut positions: Vec<DVec3> = (0..rings)
        .flat_map(|i| (0..sectors).map(move |j| direction(i, j)))
        .collect();
    positions.extend([DVec3::Z, DVec3::NEG_Z]);
    let positions = positions
        .into_iter()
        .map(|d| d * radius(d) * DVec3::new(1.3, 1.0, 0.75))
        .collect();
    let (north, south) = (rings * sectors, rings * sectors + 1);
    let mut triangles = irregular_quads(rings - 1, sectors, |i, j| i * sectors + j % sectors);
    for j in 0..sectors {
        let next = (j + 1) % sectors;
        let last = (rings - 1) * sectors;
        triangles.extend([[north, j, next], [south, last + next, last + j]]);
    }
    Mesh {
        positions,
        triangles,
    }
}

/// A square of side 1 with hills, open at its border, V = `(cells + 1)^2` vertices.
pub fn terrain(cells: u32) -> Mesh {
    let height = |x: f64, y: f64| {
        0.05 * libm::sin(9.0 * x + 4.0 * y) + 0.03 * libm::sin(17.0 * y - 6.0 * x * y)
    };
    let position = |i: u32, j: u32| {
        let (x, y) = (
            f64::from(i) / f64::from(cells),
            f64::from(j) / f64::from(cells),
        );
        DVec3::new(x, y, height(x, y))
    };
    let positions = (0..=cells)
        .flat_map(|i| (0..=cells).map(move |j| position(i, j)))
        .collect();
    let vertex = |i: u32, j: u32| i * (cells + 1) + j;
    Mesh {
        positions,
        triangles: irregular_quads(cells, cells, vertex),
    }
}

/// The quads of a grid, each split along one of its diagonals at random; `vertex` names the corner of a row and a column.
fn irregular_quads(rows: u32, columns: u32, vertex: impl Fn(u32, u32) -> u32) -> Vec<[u32; 3]> {
    let mut random = Random::new(1);
    let quads = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    quads
        .flat_map(|(i, j)| {
            split(
                [
                    vertex(i, j),
                    vertex(i + 1, j),
                    vertex(i + 1, j + 1),
                    vertex(i, j + 1),
                ],
                &mut random,
            )
        })
        .collect()
}

/// A quad as two triangles, along one of its diagonals.
fn split([a, b, c, d]: [u32; 4], random: &mut Random) -> [[u32; 3]; 2] {
    if random.bits() >> 63 == 0 {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    }
}
