//! Golden marks: the same bytes natively and in wasm, today and after every change that is not a new format.

use crate::support::fixtures::{gallery, key, payload};
use crate::support::gltf_builder::{Model, Packing};
use meshmark::mesh::{Mesh, shapes};
use meshmark::scene::to_glb;
use meshmark::{EmbedOptions, Files, Strength, embed, ignore, measure};
use sha2::{Digest, Sha256};
use wasm_bindgen_test::wasm_bindgen_test;

fn check(model: &Model, digests: [&str; 3]) {
    let options = EmbedOptions {
        strength: Strength::STRONG,
        ..EmbedOptions::default()
    };
    let embedding = embed(
        &model.bytes,
        &model.files,
        payload(),
        &key(1),
        &options,
        &mut ignore,
    )
    .unwrap();
    let bytes = measure(&embedding.model, &embedding.files, &mut ignore)
        .unwrap()
        .to_bytes();
    let seen = [&model.bytes, &embedding.model, &bytes].map(|bytes| digest(bytes));
    assert_eq!(seen, digests, "host, marked model, evidence");
}

/// The first 8 bytes of SHA-256.
fn digest(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .take(8)
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

fn glb(mesh: &Mesh) -> Model {
    Model {
        bytes: to_glb(mesh),
        files: Files::new(),
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn golden_torus_knot() {
    check(
        &glb(&shapes::torus_knot(120, 20)),
        ["8b54599e9fac4ede", "f4eddc1cd6308240", "78f25e65960831b4"],
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn golden_planet() {
    check(
        &glb(&shapes::planet(30, 40)),
        ["695519387c64ccbf", "b9cdc241f474ffd2", "2300fca8d18c909f"],
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn golden_terrain() {
    check(
        &glb(&shapes::terrain(40)),
        ["e69e4e67e7687dc8", "cd61af5f948ca0cc", "4adde0e5897c5359"],
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn golden_gallery() {
    check(
        &gallery(Packing::Glb),
        ["2f7fe1c19cf3a651", "a1bf0e1dc6ddfe29", "e9a619b78949563b"],
    );
}
