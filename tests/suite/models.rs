//! Research and sample models, which lie beside the project on some machines: `cargo xtask test` runs these tests there.
#![cfg(not(target_arch = "wasm32"))]

use crate::support::fixtures::{key, payload};
use glam::DVec3;
use meshmark::attack::{crop, noise, quantize, similarity, smooth};
use meshmark::document::Document;
use meshmark::mesh::Mesh;
use meshmark::scene::{Scene, to_glb};
use meshmark::{Carrier, EmbedOptions, Evidence, Files, Strength, Verdict, embed, extract, ignore};
use std::path::{Path, PathBuf};

fn model(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/models")
        .join(name)
}

/// Positions and polygons of a Wavefront .obj, polygons as fans.
fn read_obj(path: &Path) -> Mesh {
    let mut mesh = Mesh::default();
    for line in std::fs::read_to_string(path).unwrap().lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => mesh.positions.push(DVec3::from_slice(
                &words
                    .take(3)
                    .map(|w| w.parse().unwrap())
                    .collect::<Vec<f64>>(),
            )),
            Some("f") => {
                let corner =
                    |word: &str| word.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                let corners: Vec<u32> = words.map(corner).collect();
                mesh.triangles.extend(
                    corners
                        .windows(2)
                        .skip(1)
                        .map(|pair| [corners[0], pair[0], pair[1]]),
                );
            }
            _ => {}
        }
    }
    mesh
}

#[test]
#[ignore = "needs ../shared/models"]
fn models_bunny_is_found_in_half_of_itself() {
    let path = model("obj/stanford-bunny.obj");
    let host = to_glb(&read_obj(&path));
    let options = EmbedOptions {
        strength: Strength::new(0.0001).unwrap(),
        carriers: vec![Carrier::Ring],
    };
    let marked = embed(
        &host,
        &Files::new(),
        payload(),
        &key(9),
        &options,
        &mut ignore,
    )
    .unwrap();
    assert!(
        marked.report.rms_rel <= 0.00011,
        "{}",
        marked.report.rms_rel
    );
    let mesh = Scene::gather(&Document::read(&marked.model, &Files::new()).unwrap())
        .unwrap()
        .mesh;
    for seed in 20..23 {
        let half = extract(&Evidence::measure(&crop(&mesh, 0.5, seed)), &key(9));
        assert_eq!(
            (half.verdict, half.tag.as_deref()),
            (Verdict::Found, Some("ADA-1"))
        );
        assert!(half.details().ln_p < -1000.0, "{}", half.details().ln_p);
    }
}

#[test]
#[ignore = "needs ../shared/models"]
fn models_bunny_is_found_after_everything_that_keeps_its_shape() {
    let path = model("obj/stanford-bunny.obj");
    let host = to_glb(&read_obj(&path));
    let marked = embed(
        &host,
        &Files::new(),
        payload(),
        &key(9),
        &EmbedOptions::default(),
        &mut ignore,
    )
    .unwrap();
    assert!(
        marked.report.rms_rel <= 0.0004 * (1.0 + 1e-6),
        "{}",
        marked.report.rms_rel
    );
    let mesh = Scene::gather(&Document::read(&marked.model, &Files::new()).unwrap())
        .unwrap()
        .mesh;
    for (attack, suspect) in [
        ("noise 0.5 %", noise(&mesh, 0.005, 1)),
        ("quantize 8", quantize(&mesh, 8)),
        ("smooth 10", smooth(&mesh, 0.1, 10)),
        (
            "smooth 50, similarity",
            similarity(&smooth(&mesh, 0.1, 50), 2),
        ),
    ] {
        let found = extract(&Evidence::measure(&suspect), &key(9));
        assert_eq!(
            (found.verdict, found.tag.as_deref()),
            (Verdict::Found, Some("ADA-1")),
            "{attack}: {found:?}"
        );
    }
}

#[test]
#[ignore = "needs ../shared/models"]
fn models_knight_is_marked_and_found() {
    let path = model("gltf/chr_knight.glb");
    let host = std::fs::read(path).unwrap();
    let marked = embed(
        &host,
        &Files::new(),
        payload(),
        &key(9),
        &EmbedOptions::default(),
        &mut ignore,
    )
    .unwrap();
    assert!(
        marked.report.read_back.details().ln_p < -30.0,
        "{:?}",
        marked.report.read_back
    );
}

/// Spheres, tori and boxes in a row, one of them shown twice: 34 neighbourhoods by connectivity, but every vertex has a place.
#[test]
#[ignore = "needs ../shared/models"]
fn models_regular_shapes_are_marked_and_found() {
    let path = model("gltf/ShapeCollection.glb");
    let host = std::fs::read(path).unwrap();
    let marked = embed(
        &host,
        &Files::new(),
        payload(),
        &key(9),
        &EmbedOptions::default(),
        &mut ignore,
    )
    .unwrap();
    assert!(
        marked.report.read_back.details().ln_p < -30.0,
        "{:?}",
        marked.report.read_back
    );
    let mesh = Scene::gather(&Document::read(&marked.model, &Files::new()).unwrap())
        .unwrap()
        .mesh;
    let altered = quantize(&similarity(&mesh, 31), 14);
    let found = extract(&Evidence::measure(&altered), &key(9));
    assert_eq!(
        (found.verdict, found.tag.as_deref()),
        (Verdict::Found, Some("ADA-1")),
        "{found:?}"
    );
}
