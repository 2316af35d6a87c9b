//! Writes what the fuzzer starts from: `cargo run --manifest-path fuzz/Cargo.toml --bin seeds`, in the project's folder.

#[allow(dead_code)] // a part of it is enough here
#[path = "../tests/suite/support"]
mod support {
    pub mod fixtures;
    pub mod glb;
    pub mod gltf_builder;
}

use meshmark::internals::carrier::{Measurement, ring, solid};
use meshmark::internals::document::Document;
use meshmark::internals::mesh::shapes;
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{EmbedOptions, Evidence, Files, Key, RecordOptions, prepare, record};
use std::fs;
use std::path::Path;
use support::fixtures::{gallery, marked};
use support::gltf_builder::Packing;

fn main() -> std::io::Result<()> {
    let small = to_glb(&shapes::asteroid(6, 8));
    write("document", "asteroid.glb", &small)?;
    write("document", "gallery.gltf", &gallery(Packing::DataUri).bytes)?;
    write("document", "gallery.glb", &gallery(Packing::Glb).bytes)?;
    let (host, key) = (
        shapes::asteroid(20, 30),
        Key::from_bytes(&[1; Key::BYTES]).expect("32 bytes"),
    );
    let marked = marked(&to_glb(&host), &key)
        .expect("a model that can be marked")
        .model;
    let document = Document::read(&marked, &Files::new()).expect("a model of ours");
    let mesh = Scene::gather(&document).expect("a model of ours").mesh;
    let rings = Measurement::Ring(ring::Measurement::new(&mesh));
    write(
        "evidence",
        "rings.mmev",
        &Evidence::from_iter([rings]).to_bytes(),
    )?;
    // Of all its surfaces, the suspect's own: with the others evidence has megabytes.
    let surface = Measurement::Solid(solid::Surfaces::new(&mesh).plain().collect());
    write(
        "evidence",
        "surface.mmev",
        &Evidence::from_iter([surface]).to_bytes(),
    )?;
    let plain = EmbedOptions::default();
    let plan =
        prepare(&*to_glb(&shapes::asteroid(16, 24)), &key, &plain).expect("a model for copies");
    write("plan", "asteroid.mmpl", &plan.0.to_bytes())?;
    let kept = record(&*to_glb(&host), &plan.1, &key, &RecordOptions::default());
    let kept = kept.expect("a model of ours");
    write("record", "asteroid.json", kept.as_bytes())?;
    write("round_trip", "large", &[29, 39])?;
    write(
        "round_trip",
        "small",
        &[33, 255, 255, 255, 255, 255, 255, 255, 39, 29, 39],
    )?;
    write(
        "round_trip",
        "holed",
        &[20, 25, 0, 9, 7, 0, 0, 30, 7, 0, 1, 2, 0, 160],
    )?;
    write(
        "round_trip",
        "spiked",
        &[15, 15, 0, 9, 1, 250, 0, 30, 4, 0, 0, 40, 6, 0],
    )
}

fn write(target: &str, name: &str, bytes: &[u8]) -> std::io::Result<()> {
    let folder = Path::new("fuzz/seeds").join(target);
    fs::create_dir_all(&folder)?;
    fs::write(folder.join(name), bytes)
}
