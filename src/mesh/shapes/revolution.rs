//! Shapes without axes of their own: what a carrier that relies on them finds hardest.

use super::parts::{globe, irregular_quads, lathe};
use crate::mesh::Mesh;
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A torus of radii 1 and 0.4, V = `around * across`.
pub fn torus(around: u32, across: u32) -> Mesh {
    let position = |i: u32, j: u32| {
        let t = TAU * f64::from(i) / f64::from(around);
        let s = TAU * f64::from(j) / f64::from(across);
        let radius = 1.0 + 0.4 * libm::cos(s);
        DVec3::new(
            radius * libm::cos(t),
            radius * libm::sin(t),
            0.4 * libm::sin(s),
        )
    };
    let places = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    Mesh {
        positions: places.map(|(i, j)| position(i, j)).collect(),
        triangles: irregular_quads(around, across, |i, j| i % around * across + j % across),
    }
}

/// A vase of height 2, a surface of revolution, open at its top, V = `rings * sectors + 1`.
pub fn vase(rings: u32, sectors: u32) -> Mesh {
    let (side, foot) = (rings * 4 / 5, rings - rings * 4 / 5);
    let radius = |t: f64| 0.45 + 0.25 * libm::sin(4.4 * t + 0.4) + 0.1 * t;
    let down = (0..side).map(|i| f64::from(i) / f64::from(side - 1));
    let inwards = (0..=foot).map(|i| f64::from(foot - i) / f64::from(foot + 1));
    let profile: Vec<(f64, f64)> = down
        .map(|t| (radius(t), 1.0 - 2.0 * t))
        .chain(inwards.map(|t| (radius(1.0) * t, -1.0)))
        .collect();
    lathe(&profile, sectors)
}

/// A sphere of radius 1 with hills of a hundredth, V = `rings * sectors + 2`.
pub fn relief_sphere(rings: u32, sectors: u32) -> Mesh {
    globe(rings, sectors, |d| {
        let relief = libm::sin(11.0 * d.x + 4.0 * d.y * d.z)
            * libm::sin(9.0 * d.y - 3.0 * d.x)
            * libm::cos(8.0 * d.z + 2.0 * d.x);
        d * (1.0 + 0.01 * relief)
    })
}

/// A capsule about the z axis: a cylinder of radius 0.5 and height 1 between two half spheres, V = `rings * sectors + 2`.
pub fn capsule(rings: u32, sectors: u32) -> Mesh {
    // The rings are equally far apart along the profile: a quarter of a circle, the cylinder's side, a quarter.
    let quarter = TAU / 8.0;
    let total = 2.0 * quarter + 1.0;
    let profile: Vec<(f64, f64)> = (0..rings + 2)
        .map(|i| {
            let way = total * f64::from(i) / f64::from(rings + 1);
            let (on_arc, low) = if way < total / 2.0 {
                (way.min(quarter), (way - quarter).max(0.0))
            } else {
                ((total - way).min(quarter), (total - way - quarter).max(0.0))
            };
            let (sin, cos) = (libm::sin(2.0 * on_arc), libm::cos(2.0 * on_arc));
            let height = 0.5 + 0.5 * cos - low;
            let radius = if i == 0 || i == rings + 1 {
                0.0
            } else {
                0.5 * sin
            };
            (radius, if way < total / 2.0 { height } else { -height })
        })
        .collect();
    lathe(&profile, sectors)
}

/// A sphere of radius 1: an icosahedron whose triangles are divided in four `rounds` times, V = `10 * 4^rounds + 2`.
pub fn icosphere(rounds: u32) -> Mesh {
    let golden = (1.0 + libm::sqrt(5.0)) / 2.0;
    let mut positions = Vec::new();
    for (a, b) in [
        (1.0, golden),
        (1.0, -golden),
        (-1.0, golden),
        (-1.0, -golden),
    ] {
        positions.extend([(0.0, a, b), (a, b, 0.0), (b, 0.0, a)].map(DVec3::from));
    }
    // The faces are the triples of neighbours, at a distance of 2.
    let is_edge = |a: usize, b: usize| positions[a].distance(positions[b]) < 2.1;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if is_edge(a, b) && is_edge(b, c) && is_edge(c, a) {
                    let volume = positions[a].dot(positions[b].cross(positions[c]));
                    let [b, c] = if volume > 0.0 { [b, c] } else { [c, b] };
                    triangles.push([a, b, c].map(|v| v as u32));
                }
            }
        }
    }
    positions.iter_mut().for_each(|p| *p = p.normalize());
    for _ in 0..rounds {
        let mut middles = BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                let sum: DVec3 = positions[a as usize] + positions[b as usize];
                positions.push(sum.normalize());
                positions.len() as u32 - 1
            })
        };
        let divide = |&[a, b, c]: &[u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        };
        triangles = triangles.iter().flat_map(divide).collect();
    }
    Mesh {
        positions,
        triangles,
    }
}
