//! Levels of detail, and what else no scene shows.

use crate::portable_test;
use crate::support::fixtures::{key, payload};
use crate::support::gltf_builder::{Built, Component, GltfBuilder, Layout, Packing, primitive};
use meshmark::internals::attack::simplify;
use meshmark::internals::document::Document;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{EmbedOptions, Embedding, Model, Verdict, detect, embed};

fn add(builder: &mut GltfBuilder, mesh: &Mesh) -> usize {
    let points: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    let position = builder.positions(0, Layout::F32, &points);
    let corners: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
    let indices = builder.indices(0, Component::U32, &corners);
    builder.mesh(&[primitive(position, Some(indices), 4)])
}

/// A rock with a coarser level of detail, a speck that nothing shows, and a mesh that has the rock's positions.
fn levels() -> Built {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let rock = shapes::asteroid(40, 60);
    add(&mut builder, &rock);
    add(&mut builder, &simplify(&rock, 0.5));
    add(&mut builder, &shapes::icosphere(0));
    builder.mesh(&[primitive(0, Some(1), 4)]);
    builder.node(r#"{"mesh":0,"extensions":{"MSFT_lod":{"ids":[1]}}}"#);
    builder.node(r#"{"mesh":1}"#);
    builder.members = vec![
        r#""scene":0,"scenes":[{"nodes":[0]}]"#.to_owned(),
        r#""extensionsUsed":["MSFT_lod"]"#.to_owned(),
    ];
    builder.build()
}

#[portable_test]
fn levels_that_no_scene_shows_are_marked_and_read_alone() {
    let Built { bytes, files } = levels();
    let host = Model::new(&bytes).with_files(&files);
    let Embedding { model, report, .. } =
        embed(host, payload(), &key(1), &EmbedOptions::default()).unwrap();
    let told: Vec<(usize, bool)> = report
        .unshown
        .iter()
        .map(|unshown| (unshown.mesh, unshown.is_marked))
        .collect();
    assert_eq!(told, [(1, true), (2, false), (3, false)]);
    let document = Document::read(&model, &files).unwrap();
    let alone = to_glb(&Scene::of_mesh(&document, 1).unwrap().mesh);
    let found = detect(&alone, &key(1), None).unwrap();
    assert_eq!(found.verdict, Verdict::Found);
    assert_eq!(found.number, Some(payload().number()));
    // What could not be marked is as it was.
    let before = Document::read(&bytes, &files).unwrap();
    let speck = |document| Scene::of_mesh(document, 2).unwrap().mesh.positions;
    assert_eq!(speck(&document), speck(&before));
}
