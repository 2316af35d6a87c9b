//! Floors of robustness on small generated meshes: what once survived must survive.

use crate::support::fixtures::{key, marked, payload};
use glam::DVec3;
use meshmark::attack::{crop, noise, quantize, reorder, similarity, smooth};
use meshmark::document::Document;
use meshmark::mesh::{Mesh, shapes};
use meshmark::scene::{Scene, to_glb};
use meshmark::{Evidence, Verdict, extract};
use std::f64::consts::TAU;
use wasm_bindgen_test::wasm_bindgen_test;

/// The marked copy of a mesh, as it comes out of its file.
fn marked_mesh(mesh: &Mesh) -> Mesh {
    let model = marked(&to_glb(mesh), &key(1)).unwrap().model;
    Scene::gather(&Document::read(&model, &Default::default()).unwrap())
        .unwrap()
        .mesh
}

/// A regular mesh: four copies of a smooth, regular tube of different sizes, which only their places tell apart.
#[wasm_bindgen_test(unsupported = test)]
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
        let answer = extract(&Evidence::measure(&suspect), &key(1));
        assert_eq!(answer.verdict, Verdict::Found, "{attack}: {answer:?}");
        assert!(answer.ln_p < -100.0, "{attack}: ln p {:.0}", answer.ln_p);
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

/// Every attack with the largest ln p at which each mesh must be found.
fn check(name: &str, mesh: &Mesh, floors: [f64; 9]) {
    let marked = marked_mesh(mesh);
    let attacked = [
        ("none", marked.clone()),
        ("reorder", reorder(&marked, 11)),
        ("similarity", similarity(&marked, 12)),
        ("quantize 14", quantize(&marked, 14)),
        ("quantize 12", quantize(&marked, 12)),
        ("crop 10 %", crop(&marked, 0.1, 13)),
        ("crop 30 %", crop(&marked, 0.3, 14)),
        ("crop 50 %", crop(&marked, 0.5, 15)),
        (
            "crop 30 %, similarity, reorder, quantize 14",
            quantize(&reorder(&similarity(&crop(&marked, 0.3, 16), 17), 18), 14),
        ),
    ];
    hold(name, attacked.into_iter().zip(floors));
}

#[wasm_bindgen_test(unsupported = test)]
fn robustness_of_a_torus_knot() {
    check(
        "torus knot",
        &shapes::torus_knot(160, 24),
        [
            -575.0, -575.0, -575.0, -571.0, -518.0, -448.0, -279.0, -190.0, -285.0,
        ],
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn robustness_of_an_asteroid() {
    check(
        "asteroid",
        &shapes::asteroid(40, 60),
        [
            -216.0, -216.0, -216.0, -213.0, -184.0, -158.0, -84.0, -28.0, -82.0,
        ],
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn robustness_of_a_terrain() {
    check(
        "terrain",
        &shapes::terrain(60),
        [
            -731.0, -731.0, -731.0, -723.0, -615.0, -609.0, -454.0, -276.0, -419.0,
        ],
    );
}

/// Reads every suspect, and names all that are not found, or with a ln p above the floor.
fn hold(name: &str, suspects: impl Iterator<Item = ((&'static str, Mesh), f64)>) {
    let below = suspects.filter_map(|((attack, suspect), floor)| {
        let answer = extract(&Evidence::measure(&suspect), &key(1));
        let holds = answer.verdict == Verdict::Found
            && answer.number == Some(payload().number())
            && answer.ln_p <= floor;
        (!holds).then(|| format!("{attack}: ln p {:.0}, the floor is {floor}", answer.ln_p))
    });
    let below: Vec<String> = below.collect();
    assert!(below.is_empty(), "{name}: {}", below.join("; "));
}

/// What leaves nothing of the rings, and the shape as it was.
#[wasm_bindgen_test(unsupported = test)]
fn robustness_of_a_shape() {
    let marked = marked_mesh(&shapes::asteroid(40, 60));
    let attacked = [
        (("noise 0.3 %", noise(&marked, 0.003, 51)), -63.0),
        (("quantize 9", quantize(&marked, 9)), -89.0),
        (("smooth 10", smooth(&marked, 0.1, 10)), -65.0),
        (
            (
                "smooth 40, similarity",
                similarity(&smooth(&marked, 0.1, 40), 52),
            ),
            -89.0,
        ),
    ];
    hold("asteroid", attacked.into_iter());
}
