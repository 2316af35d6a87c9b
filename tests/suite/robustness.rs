//! What survives natively and in wasm on a regular shape. Every attack's floors are in `floors.rs`.

use crate::portable_test;
use crate::support::fixtures::{key, marked};
use glam::DVec3;
use meshmark::internals::attack::{quantize, reorder, similarity};
use meshmark::internals::document::Document;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{Evidence, Verdict, extract};
use std::f64::consts::TAU;

/// The marked copy of a mesh, as it comes out of its file.
fn marked_mesh(mesh: &Mesh) -> Mesh {
    let model = marked(&to_glb(mesh), &key(1)).unwrap().model;
    Scene::gather(&Document::read(&model, &Default::default()).unwrap())
        .unwrap()
        .mesh
}

/// A regular mesh: four copies of a smooth, regular tube of different sizes, which only their places tell apart.
#[portable_test]
fn robustness_of_regular_shapes() {
    let mut mesh = Mesh::default();
    for (copy, size) in [1.0, 0.8, 0.65, 0.9].into_iter().enumerate() {
        let first = mesh.positions.len() as u32;
        let tube = tube();
        let place = DVec3::new(copy as f64 * 3.0, size, 0.3 * size);
        mesh.positions
            .extend(tube.positions.iter().map(|p| *p * size + place));
        mesh.triangles.extend(
            tube.triangles
                .iter()
                .map(|triangle| triangle.map(|v| v + first)),
        );
    }
    let marked = marked_mesh(&mesh);
    for (attack, suspect) in [
        ("none", marked.clone()),
        ("similarity, reorder", reorder(&similarity(&marked, 41), 42)),
        ("quantize 14", quantize(&marked, 14)),
        (
            "similarity, quantize 12",
            quantize(&similarity(&marked, 43), 12),
        ),
    ] {
        let answer = extract(&Evidence::of_mesh(&suspect), &key(1));
        assert_eq!(answer.verdict, Verdict::Found, "{attack}: {answer:?}");
        assert!(
            answer.details().ln_p < -100.0,
            "{attack}: ln p {:.0}",
            answer.details().ln_p
        );
    }
}

/// A torus whose vertices all look alike.
fn tube() -> Mesh {
    let (along, across) = (30, 16);
    let position = |v: u32| {
        let (s, t) = (
            TAU * f64::from(v / across) / f64::from(along),
            TAU * f64::from(v % across) / f64::from(across),
        );
        let radius = 1.0 + 0.35 * libm::cos(t);
        DVec3::new(
            radius * libm::cos(s),
            radius * libm::sin(s),
            0.35 * libm::sin(t),
        )
    };
    let at = |i: u32, j: u32| i % along * across + j % across;
    let quad = |v: u32| {
        let (i, j) = (v / across, v % across);
        [
            [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
            [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
        ]
    };
    let count = along * across;
    Mesh {
        positions: (0..count).map(position).collect(),
        triangles: (0..count).flat_map(quad).collect(),
    }
}
