//! Golden marks: the same bytes natively and in wasm, today and after every change that is not a new format.

use crate::portable_test;
use crate::support::fixtures::{gallery, key, payload};
use crate::support::gltf_builder::{Built, Packing};
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::to_glb;
use meshmark::{EmbedOptions, Files, Model, Strength, embed, measure};
use sha2::{Digest, Sha256};

/// The rock that docs/VECTORS.md marks too.
pub const HOST_RINGS: u32 = 30;
pub const HOST_SECTORS: u32 = 40;

fn check(model: &Built, digests: [&str; 3]) {
    let options = EmbedOptions::default().with_strength(Strength::STRONG);
    let embedding = embed(
        Model::new(&model.bytes).with_files(&model.files),
        payload(),
        &key(1),
        &options,
    )
    .unwrap();
    let bytes = measure(Model::new(&embedding.model).with_files(&embedding.files))
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

fn glb(mesh: &Mesh) -> Built {
    Built {
        bytes: to_glb(mesh),
        files: Files::new(),
    }
}

#[portable_test]
fn golden_torus_knot() {
    check(
        &glb(&shapes::torus_knot(120, 20)),
        ["8b54599e9fac4ede", "b216d7ca261eb1e1", "443425bc1f8d9c1c"],
    );
}

#[portable_test]
fn golden_asteroid() {
    check(
        &glb(&shapes::asteroid(HOST_RINGS, HOST_SECTORS)),
        ["d387c5818dc2ec36", "28ac2fe82090cd81", "ba352e146b10046c"],
    );
}

#[portable_test]
fn golden_terrain() {
    check(
        &glb(&shapes::terrain(40)),
        ["f23c3019a503a436", "ce03b35f81855c6d", "3ed419e9bccd7e58"],
    );
}

#[portable_test]
fn golden_gallery() {
    check(
        &gallery(Packing::Glb),
        ["98c4293e50a09b79", "23063356782d995a", "f1ab9564a2111ff7"],
    );
}
