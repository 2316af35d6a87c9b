//! Any bytes as a model: refused, or read, moved, written and read again; never a panic, never two answers.
#![no_main]

use libfuzzer_sys::fuzz_target;
use meshmark::Files;
use meshmark::internals::document::Document;
use meshmark::internals::scene::Scene;

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut document) = Document::read(bytes, &Files::new()) else {
        return;
    };
    let Ok(scene) = Scene::gather(&document) else {
        return;
    };
    let mut displacement = vec![glam::DVec3::splat(1e-3); scene.mesh.positions.len()];
    scene.admissible.project(&mut displacement);
    if scene.scatter(&mut document, &displacement).is_err() {
        return;
    }
    let moved = scene
        .positions_in(&document)
        .expect("what was written is there");
    // A codec may order vertices anew.
    let written = document.write_plain().expect("a written document");
    let again =
        Document::read(&written.model, &written.files).expect("what was written can be read");
    assert_eq!(
        scene.positions_in(&again).expect("the same elements"),
        moved
    );
});
