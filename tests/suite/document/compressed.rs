//! Compressed geometry: read as the plain document that it stands for, and never trusted.

use crate::portable_test;
use meshmark::internals::document::{Document, DocumentError, Files};
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::Scene;
use meshmark::{EmbedOptions, Payload, Verdict, detect, embed};
use meshoptimizer_rs::codec::ExpMode;
use serde_json::{Value, json};

use crate::support::compress::{by_draco, by_meshopt, packed};
use crate::support::fixtures::key;

/// All of them, each with the largest distance that its numbers may be off.
fn all(mesh: &Mesh) -> Vec<(&'static str, Vec<u8>, f64)> {
    let (ext, khr) = ("EXT_meshopt_compression", "KHR_meshopt_compression");
    vec![
        ("EdgeBreaker", by_draco(mesh, 7, 14), 3e-4),
        ("EdgeBreaker by valence", by_draco(mesh, 0, 11), 3e-3),
        ("sequential", by_draco(mesh, 10, 16), 1e-4),
        ("version 0", by_meshopt(mesh, ext, 0, None), 0.0),
        ("version 1", by_meshopt(mesh, khr, 1, None), 0.0),
        (
            "an exponent for each axis",
            by_meshopt(mesh, khr, 1, Some(ExpMode::SharedComponent)),
            3e-4,
        ),
        (
            "an exponent for each number",
            by_meshopt(mesh, khr, 1, Some(ExpMode::Separate)),
            3e-4,
        ),
    ]
}

fn mesh() -> Mesh {
    shapes::asteroid(20, 24)
}

#[portable_test]
fn compressed_geometry_is_what_was_compressed() {
    let mesh = mesh();
    for (name, model, tolerance) in all(&mesh) {
        let document = Document::read(&model, &Files::new()).expect(name);
        let scene = Scene::gather(&document).expect(name);
        assert_eq!(scene.mesh.positions.len(), mesh.positions.len(), "{name}");
        assert_eq!(scene.mesh.triangles.len(), mesh.triangles.len(), "{name}");
        // Codecs order triangles as they like: each one's middle has to be the middle of one that there was.
        let middles = |mesh: &Mesh| -> Vec<glam::DVec3> {
            let middle = |triangle: &[u32; 3]| {
                triangle
                    .map(|corner| mesh.positions[corner as usize])
                    .into_iter()
                    .sum::<glam::DVec3>()
                    / 3.0
            };
            mesh.triangles.iter().map(middle).collect()
        };
        let there = middles(&mesh);
        for middle in middles(&scene.mesh) {
            let nearest = there
                .iter()
                .map(|other| other.distance(middle))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest <= tolerance.max(1e-6), "{name}: {nearest}");
        }
    }
}

/// The JSON text of a .glb.
fn text_of(model: &[u8]) -> Value {
    let length = u32::from_le_bytes(*model[12..].first_chunk().expect("a length")) as usize;
    serde_json::from_slice(&model[20..20 + length]).expect("JSON")
}

/// Takes out of a JSON text what may differ: where bytes are, and the bounds of the positions.
fn without_places(mut json: Value) -> Value {
    fn forget(value: &mut Value) {
        match value {
            Value::Object(members) => {
                members.retain(|name, _| name != "byteOffset" && name != "byteLength");
                members.values_mut().for_each(forget);
            }
            Value::Array(items) => items.iter_mut().for_each(forget),
            _ => {}
        }
    }
    json["accessors"][0]["min"] = Value::Null;
    json["accessors"][0]["max"] = Value::Null;
    forget(&mut json);
    json
}

#[portable_test]
fn compressed_documents_are_written_as_they_were() {
    for (name, model, tolerance) in all(&mesh()) {
        let mut document = Document::read(&model, &Files::new()).expect(name);
        let written = document.write().expect(name);
        assert_eq!(
            (written.model, written.unpacked),
            (model.clone(), Vec::new()),
            "{name}"
        );
        let mut positions = document.positions(0).expect(name);
        positions[0][1] += 0.125;
        document.set_positions(0, &positions).expect(name);
        let written = document.write().expect(name);
        let again = Document::read(&written.model, &Files::new()).expect(name);
        assert_eq!(written.unpacked, [""; 0], "{name}");
        assert!(written.is_packed, "{name}");
        assert_eq!(
            without_places(text_of(&written.model)),
            without_places(text_of(&model)),
            "{name}"
        );
        let ratio = written.model.len() as f64 / model.len() as f64;
        assert!((0.97..1.03).contains(&ratio), "{name}: {ratio}");
        // Codecs may order vertices anew: every one has to be somewhere.
        let after = again.positions(0).expect(name);
        assert_eq!(after.len(), positions.len(), "{name}");
        for position in &positions {
            let distance =
                |other: &[f64; 3]| glam::DVec3::from(*other).distance(glam::DVec3::from(*position));
            let nearest = after.iter().map(distance).fold(f64::INFINITY, f64::min);
            assert!(nearest <= 2.0 * tolerance, "{name}: {nearest}");
        }
        let bound = |name: &str, pick: fn(f64, f64) -> f64, from: f64| {
            let stated = text_of(&written.model)["accessors"][0][name].clone();
            let stated: Vec<f64> = serde_json::from_value(stated).expect("numbers");
            for (axis, stated) in stated.iter().enumerate() {
                let found = after.iter().map(|position| position[axis]).fold(from, pick);
                assert_eq!(*stated as f32, found as f32);
            }
        };
        bound("min", f64::min, f64::INFINITY);
        bound("max", f64::max, f64::NEG_INFINITY);
    }
}

/// A Draco model whose JSON text and bytes were changed.
fn changed(change: impl FnOnce(&mut Value, &mut Vec<u8>)) -> Vec<u8> {
    let model = by_draco(&mesh(), 7, 14);
    let mut json = text_of(&model);
    let length = json["bufferViews"][0]["byteLength"]
        .as_u64()
        .expect("a length") as usize;
    let start = 28 + u32::from_le_bytes(*model[12..].first_chunk().expect("a length")) as usize;
    let mut binary = model[start..start + length].to_vec();
    binary.resize(length.next_multiple_of(4), 0);
    change(&mut json, &mut binary);
    json["buffers"][0]["byteLength"] = json!(binary.len());
    packed(&json, binary)
}

/// The document with a vertex moved, as it is written, and what is read of that.
fn moved(model: &[u8]) -> (Document, Vec<&'static str>, Document) {
    let mut document = Document::read(model, &Files::new()).expect("a document");
    let mut positions = document.positions(0).expect("positions");
    positions[5][0] += 0.25;
    document.set_positions(0, &positions).expect("movable");
    let written = document.write().expect("a written document");
    let again = Document::read(&written.model, &Files::new()).expect("a document");
    (document, written.unpacked, again)
}

/// What follows the order of the vertices, and is not in the stream, stays with its vertices.
#[portable_test]
fn compressed_primitives_with_companions_keep_their_order() {
    let model = changed(|json, binary| {
        let (offset, count) = (binary.len(), mesh().positions.len());
        binary.extend(vec![7; 4 * count]);
        let views = json["bufferViews"].as_array_mut().expect("views");
        views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": 4 * count }));
        let accessors = json["accessors"].as_array_mut().expect("accessors");
        accessors.push(
            json!({ "bufferView": 1, "componentType": 5125, "count": count, "type": "SCALAR" }),
        );
        json["meshes"][0]["primitives"][0]["attributes"]["_ID"] = json!(2);
    });
    let (document, unpacked, again) = moved(&model);
    assert_eq!(unpacked, [""; 0]);
    assert_eq!(again.triangles(0, 0), document.triangles(0, 0));
    let [before, after] = [&document, &again].map(|document| document.positions(0).expect("there"));
    for (before, after) in before.into_iter().zip(after) {
        let distance = glam::DVec3::from(before).distance(glam::DVec3::from(after));
        assert!(distance < 3e-4, "{distance}");
    }
}

/// What of a stream serves two primitives is not encoded: the copy is plain, and that is said.
#[portable_test]
fn compressed_primitives_that_share_a_stream_are_written_plain() {
    let model = changed(|json, _| {
        let primitives = json["meshes"][0]["primitives"].as_array_mut();
        let primitives = primitives.expect("primitives");
        primitives.push(primitives[0].clone());
    });
    let (document, unpacked, again) = moved(&model);
    assert_eq!(unpacked, ["KHR_draco_mesh_compression"]);
    assert_eq!(again.positions(0), document.positions(0));
    let text = text_of(&model).to_string();
    assert!(text.contains(r#""name":"é""#), "{text}");
}

/// A plain copy that goes with the streams, for readers without a decoder, holds what they hold.
#[portable_test]
fn compressed_models_keep_their_plain_copy_true() {
    let name = "EXT_meshopt_compression";
    for exponents in [None, Some(ExpMode::Separate)] {
        let model = by_meshopt(&mesh(), name, 0, exponents);
        let plain = Document::read(&model, &Files::new()).expect("a document");
        let plain = plain.write_plain().expect("a plain document").model;
        let bytes_of = |model: &[u8], range: std::ops::Range<u64>| {
            let start = 28 + u32::from_le_bytes(*model[12..].first_chunk().expect("a length"));
            model[start as usize..][range.start as usize..range.end as usize].to_vec()
        };
        let mut json = text_of(&model);
        let mut copy = Vec::new();
        for (view, packed) in text_of(&plain)["bufferViews"]
            .as_array()
            .expect("views")
            .iter()
            .zip(json["bufferViews"].as_array_mut().expect("views"))
        {
            let [start, length] =
                ["byteOffset", "byteLength"].map(|name| view[name].as_u64().expect("a number"));
            packed["byteOffset"] = json!(copy.len());
            copy.extend(bytes_of(&plain, start..start + length));
        }
        json["buffers"][1]["uri"] = json!("plain.bin");
        json["buffers"][1]["byteLength"] = json!(copy.len());
        let length = json["buffers"][0]["byteLength"].as_u64().expect("a length");
        let model = packed(&json, bytes_of(&model, 0..length));
        let files = Files::from([("plain.bin".to_owned(), copy.clone())]);
        let mut document = Document::read(&model, &files).expect("a document");
        let mut positions = document.positions(0).expect("positions");
        positions[5][0] += 0.25;
        document.set_positions(0, &positions).expect("movable");
        let written = document.write().expect("a written document");
        assert_eq!(written.unpacked, [""; 0]);
        let after = &written.files["plain.bin"];
        assert!(*after != copy && after.len() == copy.len());
        let seen = Document::read(&written.model, &written.files).expect("a document");
        let floats = after.as_chunks().0.iter().copied().map(f32::from_le_bytes);
        let floats: Vec<f64> = floats.map(f64::from).collect();
        assert_eq!(
            floats[..3 * positions.len()],
            seen.positions(0).expect("positions").as_flattened()[..]
        );
    }
}

/// A .gltf stays one, with its file.
#[portable_test]
fn compressed_gltf_stays_text() {
    let model = by_draco(&mesh(), 7, 14);
    let mut json = text_of(&model);
    json["buffers"][0]["uri"] = json!("a%20b.bin");
    let text = json.to_string();
    let start = 28 + u32::from_le_bytes(*model[12..].first_chunk().expect("a length")) as usize;
    let files = Files::from([("a b.bin".to_owned(), model[start..].to_vec())]);
    let mut document = Document::read(text.as_bytes(), &files).expect("a document");
    let mut positions = document.positions(0).expect("positions");
    positions[0][0] += 0.25;
    document.set_positions(0, &positions).expect("movable");
    for written in [document.write(), document.write_plain()] {
        let written = written.expect("a written document");
        assert_eq!(written.files.keys().collect::<Vec<_>>(), ["a b.bin"]);
        let again = Document::read(&written.model, &written.files).expect("a document");
        let count = again.positions(0).map(|positions| positions.len());
        assert_eq!(count, Ok(positions.len()));
        assert_eq!(
            written.unpacked.is_empty(),
            again.extensions_used().len() == 2
        );
    }
    let names = Document::file_names(text.as_bytes());
    assert_eq!(names, Ok(vec!["a b.bin".to_owned()]));
}

#[portable_test]
fn compressed_models_are_marked() {
    let mesh = shapes::asteroid(60, 70);
    for (name, model, _) in all(&mesh) {
        let tag = Payload::from_tag("ADA-1").expect("a tag");
        let marked = embed(&model, tag, &key(1), &EmbedOptions::default()).expect(name);
        let found = detect(&marked.model, &key(1), None).expect(name);
        assert_eq!(found.verdict, Verdict::Found);
        let ratio = marked.model.len() as f64 / model.len() as f64;
        assert!(ratio < 1.05, "{name}: {ratio}");
        let is_said = marked.report.warnings.len() == 1;
        assert_eq!(is_said, ratio > 1.03, "{:?}", marked.report.warnings);
    }
    // A regular surface costs a codec little, and a mark takes that from it.
    let model = by_draco(&shapes::terrain(40), 0, 14);
    let number = Payload::from_number(1).expect("a number");
    let marked = embed(&model, number, &key(1), &EmbedOptions::default()).expect("a mark");
    let percent = 100.0 * (marked.model.len() as f64 / model.len() as f64 - 1.0);
    assert!(percent > 3.0, "{percent}");
    let words = format!("the copy is {percent:.1} % larger than its host");
    let mut warnings = marked.report.warnings.iter();
    assert!(warnings.any(|warning| warning.starts_with(&words)));
}

/// Whatever is done to a stream, the answer is an error or a sound document.
#[portable_test]
fn compressed_damage_does_no_harm() {
    for (name, model, _) in all(&shapes::asteroid(6, 8)) {
        let length = u32::from_le_bytes(*model[12..].first_chunk().expect("a length")) as usize;
        let start = 20 + length + 8;
        let mut refused = 0;
        for place in start..model.len() {
            for change in [1, 0x80, 0xff] {
                let mut damaged = model.clone();
                damaged[place] ^= change;
                match Document::read(&damaged, &Files::new()) {
                    Ok(document) => _ = Scene::gather(&document),
                    Err(DocumentError::BadCompression { .. } | DocumentError::TooLarge { .. }) => {
                        refused += 1
                    }
                    Err(error) => panic!("{name}: {error}"),
                }
            }
        }
        assert!(refused > 0, "{name}");
    }
}

#[portable_test]
fn compressed_lies_are_refused_before_they_cost_anything() {
    let mesh = mesh();
    let count = format!(r#""count":{},"mode""#, mesh.positions.len());
    let meshopt = by_meshopt(&mesh, "EXT_meshopt_compression", 0, None);
    let draco = by_draco(&mesh, 7, 14);
    for (model, old, new, code) in [
        (
            &meshopt,
            count.as_str(),
            r#""count":4000000000,"mode""#,
            "document.too-large",
        ),
        (
            &meshopt,
            count.as_str(),
            r#""count":4,"mode""#,
            "document.bad-compression",
        ),
        (
            &meshopt,
            r#""mode":"ATTRIBUTES""#,
            r#""mode":"NONE""#,
            "document.bad-compression",
        ),
        (
            &meshopt,
            r#""byteOffset":0,"byteLength""#,
            r#""byteOffset":99999999,"byteLength""#,
            "document.out-of-bounds",
        ),
        (
            &draco,
            r#""attributes":{"POSITION":0}}"#,
            r#""attributes":{"POSITION":7}}"#,
            "document.bad-compression",
        ),
        (
            &draco,
            r#""attributes":{"POSITION":0}}"#,
            r#""attributes":{"NORMAL":0}}"#,
            "document.bad-compression",
        ),
        (
            &draco,
            r#""type":"VEC3""#,
            r#""type":"VEC2""#,
            "document.bad-compression",
        ),
        (
            &draco,
            r#"{"bufferView":0"#,
            r#"{"bufferView":3"#,
            "document.bad-compression",
        ),
    ] {
        let length = u32::from_le_bytes(*model[12..].first_chunk().expect("a length")) as usize;
        let text = String::from_utf8(model[20..20 + length].to_vec()).expect("UTF-8");
        assert!(text.contains(old), "{old} is not in {text}");
        let json: Value = serde_json::from_str(&text.replacen(old, new, 1)).expect("JSON");
        let lie = packed(&json, model[20 + length + 8..].to_vec());
        let error = Document::read(&lie, &Files::new())
            .map(|_| ())
            .expect_err(new);
        assert_eq!(error.code(), code, "{new}: {error}");
    }
}
