//! Floors of robustness on small generated meshes: what once survived must survive.

use crate::support::fixtures::{key, marked, payload};
use meshmark::attack::{crop, quantize, reorder, similarity};
use meshmark::document::Document;
use meshmark::mesh::{Mesh, shapes};
use meshmark::scene::{Scene, to_glb};
use meshmark::{Evidence, Verdict, extract};
use wasm_bindgen_test::wasm_bindgen_test;

/// The marked copy of a mesh, as it comes out of its file.
fn marked_mesh(mesh: &Mesh) -> Mesh {
    let model = marked(&to_glb(mesh), &key(1)).unwrap().model;
    Scene::gather(&Document::read(&model, &Default::default()).unwrap())
        .unwrap()
        .mesh
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
    for ((attack, suspect), floor) in attacked.iter().zip(floors) {
        let answer = extract(&Evidence::measure(suspect), &key(1));
        assert_eq!(
            answer.verdict,
            Verdict::Found,
            "{name}, {attack}: {answer:?}"
        );
        assert_eq!(answer.number, Some(payload().number()), "{name}, {attack}");
        assert!(
            answer.ln_p <= floor,
            "{name}, {attack}: ln p {:.0} is above the floor {floor}",
            answer.ln_p
        );
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn robustness_of_a_torus_knot() {
    check(
        "torus knot",
        &shapes::torus_knot(160, 24),
        [
            -800.0, -800.0, -800.0, -795.0, -710.0, -630.0, -425.0, -290.0, -415.0,
        ],
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn robustness_of_a_planet() {
    check(
        "planet",
        &shapes::planet(40, 60),
        [
            -520.0, -520.0, -520.0, -520.0, -485.0, -390.0, -225.0, -125.0, -220.0,
        ],
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn robustness_of_a_terrain() {
    check(
        "terrain",
        &shapes::terrain(60),
        [
            -765.0, -765.0, -765.0, -760.0, -655.0, -660.0, -420.0, -325.0, -420.0,
        ],
    );
}
