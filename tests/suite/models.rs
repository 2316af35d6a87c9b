//! Research and sample models, which lie beside the project on some machines: `cargo xtask test` runs these tests there.
#![cfg(not(target_arch = "wasm32"))]

use crate::support::fixtures::{key, payload};
use glam::DVec3;
use meshmark::internals::attack::{crop, noise, quantize, similarity, smooth};
use meshmark::internals::document::Document;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{
    Carrier, EmbedOptions, Embedding, Evidence, Files, Strength, Verdict, embed, extract,
};
use std::path::{Path, PathBuf};

fn model(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/models")
        .join(name)
}

/// The surface of a Wavefront .obj of triangles.
fn read_obj(path: &Path) -> Mesh {
    let (models, _) = tobj::load_obj(path, &tobj::LoadOptions::default()).unwrap();
    Mesh::joined(models.into_iter().map(|model| {
        let (positions, _) = model.mesh.positions.as_chunks();
        let (triangles, _) = model.mesh.indices.as_chunks();
        Mesh {
            positions: positions.iter().copied().map(DVec3::from_array).collect(),
            triangles: triangles.to_vec(),
        }
    }))
}

#[test]
#[ignore = "needs ../shared/models"]
fn models_bunny_is_found_in_half_of_itself() {
    let path = model("obj/stanford-bunny.obj");
    let host = to_glb(&read_obj(&path));
    let options = EmbedOptions::default()
        .with_strength(Strength::new(0.0001).unwrap())
        .with_carriers([Carrier::Ring]);
    let marked = embed(&host, payload(), &key(9), &options).unwrap();
    assert!(
        marked.report.rms_rel <= 0.00011,
        "{}",
        marked.report.rms_rel
    );
    let mesh = Scene::gather(&Document::read(&marked.model, &Files::new()).unwrap())
        .unwrap()
        .mesh;
    for seed in 20..23 {
        let half = extract(&Evidence::of_mesh(&crop(&mesh, 0.5, seed)), &key(9));
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
    let marked = embed(&host, payload(), &key(9), &EmbedOptions::default()).unwrap();
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
        let found = extract(&Evidence::of_mesh(&suspect), &key(9));
        assert_eq!(
            (found.verdict, found.tag.as_deref()),
            (Verdict::Found, Some("ADA-1")),
            "{attack}: {found:?}"
        );
    }
}

/// A file with a mark that is read back with ease.
fn marked(path: &Path) -> Embedding {
    let host = std::fs::read(path).unwrap();
    let marked = embed(&host, payload(), &key(9), &EmbedOptions::default()).unwrap();
    assert!(
        marked.report.read_back.details().ln_p < -30.0,
        "{:?}",
        marked.report.read_back
    );
    marked
}

#[test]
#[ignore = "needs ../shared/models"]
fn models_knight_is_marked_and_found() {
    let path = model("gltf/chr_knight.glb");
    marked(&path);
}

/// Spheres, tori and boxes in a row, one of them shown twice: 34 neighbourhoods by connectivity, but every vertex has a place.
#[test]
#[ignore = "needs ../shared/models"]
fn models_regular_shapes_are_marked_and_found() {
    let path = model("gltf/ShapeCollection.glb");
    let marked = marked(&path);
    let mesh = Scene::gather(&Document::read(&marked.model, &Files::new()).unwrap())
        .unwrap()
        .mesh;
    let altered = quantize(&similarity(&mesh, 31), 14);
    let found = extract(&Evidence::of_mesh(&altered), &key(9));
    assert_eq!(
        (found.verdict, found.tag.as_deref()),
        (Verdict::Found, Some("ADA-1")),
        "{found:?}"
    );
}
