//! Compressed geometry: read as the plain document that it stands for, and never trusted.

use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, MeshEncoder,
    PointAttribute,
};
use meshmark::internals::document::{Document, DocumentError, Files};
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::Scene;
use meshmark::{EmbedOptions, Payload, Verdict, detect, embed};
use meshoptimizer_rs::codec::{
    ExpMode, IndexEncoding, VertexEncoding, encode_filter_exp, encode_index_buffer,
    encode_vertex_buffer,
};
use meshoptimizer_rs::{Limits, Workspace};
use serde_json::{Value, json};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::support::fixtures::key;
use crate::support::gltf_builder::glb;

fn floats(mesh: &Mesh) -> Vec<f32> {
    mesh.positions
        .iter()
        .flat_map(|position| position.as_vec3().to_array())
        .collect()
}

fn bytes_of(floats: &[f32]) -> Vec<u8> {
    floats
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect()
}

/// The JSON text of a mesh of one primitive, for accessors 0 (positions) and 1 (indices).
fn json_of(mesh: &Mesh, name: &str) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_mesh_quantization", name],
        "extensionsRequired": [name],
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "é" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "componentType": 5126, "count": mesh.positions.len(), "type": "VEC3", "min": [-9, -9, -9], "max": [9.0, 9.0, 9.0] },
            { "componentType": 5123, "count": 3 * mesh.triangles.len(), "type": "SCALAR" },
        ],
    })
}

fn packed(json: &Value, binary: Vec<u8>) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = binary;
    binary.resize(binary.len().next_multiple_of(4), 0);
    glb(&[(*b"JSON", text), (*b"BIN\0", binary)])
}

/// The mesh by Draco, its positions in so many bits.
fn by_draco(mesh: &Mesh, speed: i32, bits: i32) -> Vec<u8> {
    let mut positions = PointAttribute::new();
    positions.init(
        GeometryAttributeType::Position,
        3,
        DataType::Float32,
        false,
        mesh.positions.len(),
    );
    positions.buffer_mut().write(0, &bytes_of(&floats(mesh)));
    let mut stream = draco_core::Mesh::new();
    let id = stream.add_attribute(positions);
    stream.set_num_faces(mesh.triangles.len());
    for (face, triangle) in (0..).zip(&mesh.triangles) {
        stream.set_face(FaceIndex(face), triangle.map(Into::into));
    }
    let mut options = EncoderOptions::new();
    options.set_global_int("encoding_speed", speed);
    options.set_attribute_quantization(id, bits);
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(stream);
    let mut buffer = EncoderBuffer::new();
    encoder.encode(&options, &mut buffer).expect("a stream");
    let stream = buffer.data().to_vec();
    let mut json = json_of(mesh, "KHR_draco_mesh_compression");
    json["buffers"] = json!([{ "byteLength": stream.len() }]);
    json["bufferViews"] = json!([{ "buffer": 0, "byteLength": stream.len() }]);
    json["meshes"][0]["primitives"][0]["extensions"] = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0 } } });
    packed(&json, stream)
}

/// The mesh by meshopt: positions with or without the filter for floats.
fn by_meshopt(mesh: &Mesh, name: &str, version: u8, filter: Option<&str>) -> Vec<u8> {
    let mut workspace = Workspace::new(Limits::default());
    let (count, indices) = (mesh.positions.len(), mesh.triangles.as_flattened());
    let plain = match filter {
        None => bytes_of(&floats(mesh)),
        Some(_) => encode_filter_exp(
            count,
            12,
            15,
            &floats(mesh),
            ExpMode::Separate,
            &mut workspace,
        )
        .expect("filtered"),
    };
    let encoding = VertexEncoding::new(version, 2).expect("a version");
    let vertices =
        encode_vertex_buffer(&plain, count, 12, encoding, &mut workspace).expect("a stream");
    let corners =
        encode_index_buffer(indices, IndexEncoding::DEFAULT, &mut workspace).expect("a stream");
    let start = vertices.len().next_multiple_of(4);
    let mut binary = vertices.clone();
    binary.resize(start, 0);
    binary.extend(&corners);
    let mut json = json_of(mesh, name);
    json["accessors"][0]["bufferView"] = json!(0);
    json["accessors"][1]["bufferView"] = json!(1);
    json["accessors"][1]["componentType"] = json!(5123);
    let mut of_positions = json!({
        "buffer": 0, "byteOffset": 0, "byteLength": vertices.len(), "byteStride": 12, "count": count, "mode": "ATTRIBUTES",
    });
    if let Some(filter) = filter {
        of_positions["filter"] = json!(filter);
    }
    let of_indices = json!({
        "buffer": 0, "byteOffset": start, "byteLength": corners.len(), "byteStride": 2, "count": indices.len(), "mode": "TRIANGLES",
    });
    json["bufferViews"] = json!([
        { "buffer": 1, "byteLength": 12 * count, "byteStride": 12, "extensions": { name: of_positions } },
        { "buffer": 1, "byteOffset": 12 * count, "byteLength": 2 * indices.len(), "extensions": { name: of_indices } },
    ]);
    json["buffers"] = json!([
        { "byteLength": binary.len() },
        { "byteLength": 12 * count + 2 * indices.len(), "extensions": { name: { "fallback": true } } },
    ]);
    packed(&json, binary)
}

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
            "exponents",
            by_meshopt(mesh, khr, 1, Some("EXPONENTIAL")),
            3e-4,
        ),
    ]
}

fn mesh() -> Mesh {
    shapes::asteroid(20, 24)
}

#[wasm_bindgen_test(unsupported = test)]
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

#[wasm_bindgen_test(unsupported = test)]
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
        if name == "exponents" {
            // A filter rounds: the copy is plain, and that is said.
            assert_eq!(written.unpacked, ["KHR_meshopt_compression"]);
            let text = text_of(&written.model).to_string();
            assert!(
                !text.contains("_compression") && text.contains(r#""name":"é""#),
                "{text}"
            );
            assert!(
                text.contains(r#""extensionsUsed":["KHR_mesh_quantization"]"#)
                    && !text.contains("extensionsRequired")
            );
            assert_eq!(again.positions(0).expect(name), positions);
            continue;
        }
        assert_eq!(written.unpacked, [""; 0], "{name}");
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

/// What follows the order of the vertices, and is not in the stream, would be torn from them.
#[wasm_bindgen_test(unsupported = test)]
fn compressed_primitives_with_companions_are_written_plain() {
    let mesh = mesh();
    let model = by_draco(&mesh, 7, 14);
    let mut json = text_of(&model);
    let length = json["bufferViews"][0]["byteLength"]
        .as_u64()
        .expect("a length") as usize;
    let start = 28 + u32::from_le_bytes(*model[12..].first_chunk().expect("a length")) as usize;
    let mut binary = model[start..start + length].to_vec();
    binary.resize(length.next_multiple_of(4), 0);
    let (offset, count) = (binary.len(), mesh.positions.len());
    binary.extend(vec![7; 4 * count]);
    json["buffers"][0]["byteLength"] = json!(binary.len());
    let views = json["bufferViews"].as_array_mut().expect("views");
    views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": 4 * count }));
    let accessors = json["accessors"].as_array_mut().expect("accessors");
    accessors
        .push(json!({ "bufferView": 1, "componentType": 5125, "count": count, "type": "SCALAR" }));
    json["meshes"][0]["primitives"][0]["attributes"]["_ID"] = json!(2);
    let model = packed(&json, binary);
    let mut document = Document::read(&model, &Files::new()).expect("a document");
    let mut positions = document.positions(0).expect("positions");
    positions[5][0] += 0.25;
    document.set_positions(0, &positions).expect("movable");
    let written = document.write().expect("a written document");
    assert_eq!(written.unpacked, ["KHR_draco_mesh_compression"]);
    let again = Document::read(&written.model, &Files::new()).expect("a document");
    assert_eq!(again.positions(0), Ok(positions));
}

/// A .gltf stays one, with its file.
#[wasm_bindgen_test(unsupported = test)]
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

#[wasm_bindgen_test(unsupported = test)]
fn compressed_models_are_marked() {
    let mesh = shapes::asteroid(60, 70);
    for (name, model, _) in all(&mesh) {
        let tag = Payload::from_tag("ADA-1").expect("a tag");
        let marked = embed(&model, tag, &key(1), &EmbedOptions::default()).expect(name);
        let found = detect(&marked.model, &key(1), None).expect(name);
        assert_eq!(found.verdict, Verdict::Found);
        let mut warnings = marked.report.warnings.iter();
        let says = warnings.any(|words| words.contains("compress it again"));
        assert_eq!(says, name == "exponents", "{name}");
        let ratio = marked.model.len() as f64 / model.len() as f64;
        println!("{name}: {ratio:.3}");
        assert!(says || ratio < 1.1, "{name}: {ratio}");
    }
}

/// Whatever is done to a stream, the answer is an error or a sound document.
#[wasm_bindgen_test(unsupported = test)]
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

#[wasm_bindgen_test(unsupported = test)]
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
