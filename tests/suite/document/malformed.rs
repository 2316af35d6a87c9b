//! Malformed and unsupported files: each is refused with its code and the place.

use crate::portable_test;
use meshmark::internals::document::{Document, DocumentError, Files, MAX_UNBACKED};

use crate::support::glb::glb;
use crate::support::gltf_builder::{Built, Component, GltfBuilder, Layout, Packing, primitive};

const POINTS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Dense positions (accessor 0), indices (1), sparse positions (2) and two nodes, with external buffers.
fn sound() -> GltfBuilder {
    let mut builder = GltfBuilder::new(Packing::External);
    let dense = builder.positions(0, Layout::F32, &POINTS);
    let indices = builder.indices(0, Component::U16, &[0, 1, 2]);
    let sparse = builder.sparse_positions(0, Layout::F32, &POINTS, &[1, 3], true);
    builder.mesh(&[
        primitive(dense, Some(indices), 4),
        primitive(sparse, None, 4),
    ]);
    builder.node(r#"{"mesh":0,"children":[1]}"#);
    builder.node(r#"{"name":"child"}"#);
    builder
        .members
        .push(r#""scenes":[{"nodes":[0]}],"skins":[]"#.into());
    builder
}

/// Reads all there is to read.
fn read(bytes: &[u8], files: &Files) -> Result<(), DocumentError> {
    let document = Document::read(bytes, files)?;
    for (mesh, content) in document.meshes().iter().enumerate() {
        for (part, primitive) in content.primitives.iter().enumerate() {
            document.triangles(mesh, part)?;
            if let Some(accessor) = primitive.position {
                document.positions(accessor)?;
            }
        }
    }
    Ok(())
}

fn assert_refused(name: &str, bytes: &[u8], files: &Files, code: &str, pointer: Option<&str>) {
    let error = read(bytes, files).expect_err(name);
    assert_eq!(
        (error.code(), error.pointer()),
        (code, pointer),
        "{name}: {error}"
    );
    let message = error.to_string();
    assert!(
        message.len() > 20 && !message.contains("  "),
        "{name}: {message}"
    );
}

#[portable_test]
fn the_sound_file_is_read() {
    let Built { bytes, files } = sound().build();
    assert_eq!(read(&bytes, &files), Ok(()));
}

/// A text to look for in the sound file's JSON, what to put in its place, and the refusal.
type Replacement<'a> = (&'a str, &'a str, &'a str, Option<&'a str>);

#[portable_test]
fn malformed_json_is_refused() {
    let replacements: &[Replacement] = &[
        // Text and types.
        (r#"{"asset""#, r#"{"asset"#, "document.bad-json", None),
        (
            r#"{"asset":{"version":"2.0"},"#,
            "{",
            "document.bad-json",
            Some(""),
        ),
        (
            r#""version":"2.0""#,
            r#""version":"1.0""#,
            "document.version-unsupported",
            Some("/asset/version"),
        ),
        (
            r#""skins":[]"#,
            r#""skins":{}"#,
            "document.bad-json",
            Some("/skins"),
        ),
        (
            r#""count":4"#,
            r#""count":-4"#,
            "document.bad-json",
            Some("/accessors/0/count"),
        ),
        (
            r#""count":4"#,
            r#""count":4.5"#,
            "document.bad-json",
            Some("/accessors/0/count"),
        ),
        (
            r#""count":4,"#,
            "",
            "document.bad-json",
            Some("/accessors/0"),
        ),
        (
            r#""children":[1]"#,
            r#""children":[1],"matrix":[1,2]"#,
            "document.bad-json",
            Some("/nodes/0/matrix"),
        ),
        (
            r#""children":[1]"#,
            r#""children":[1],"scale":[1,1e999,1]"#,
            "document.bad-json",
            Some("/nodes/0/scale/1"),
        ),
        (
            r#""mode":4"#,
            r#""mode":9"#,
            "document.bad-json",
            Some("/meshes/0/primitives/0/mode"),
        ),
        // Accessors.
        (
            r#""componentType":5126"#,
            r#""componentType":5124"#,
            "document.bad-json",
            Some("/accessors/0/componentType"),
        ),
        (
            r#""componentType":5126"#,
            r#""componentType":5125"#,
            "document.bad-accessor",
            Some("/accessors/0"),
        ),
        (
            r#""type":"VEC3""#,
            r#""type":"VEC5""#,
            "document.bad-json",
            Some("/accessors/0/type"),
        ),
        (
            r#""type":"VEC3""#,
            r#""type":"VEC2""#,
            "document.bad-accessor",
            Some("/accessors/0"),
        ),
        (
            r#""componentType":5123,"count":3"#,
            r#""componentType":5122,"count":3"#,
            "document.bad-accessor",
            Some("/accessors/1"),
        ),
        (
            r#""count":4"#,
            r#""count":5"#,
            "document.out-of-bounds",
            Some("/accessors/0"),
        ),
        (
            r#""count":4"#,
            r#""count":18446744073709551615"#,
            "document.out-of-bounds",
            Some("/accessors/0"),
        ),
        (
            r#""byteOffset":0,"componentType""#,
            r#""byteOffset":4,"componentType""#,
            "document.out-of-bounds",
            Some("/accessors/0"),
        ),
        (
            r#""byteOffset":0,"componentType""#,
            r#""byteOffset":18446744073709551615,"componentType""#,
            "document.out-of-bounds",
            Some("/accessors/0"),
        ),
        (r#""bufferView":0,"#, "", "document.out-of-bounds", None),
        (
            r#""bufferView":0,"#,
            r#""bufferView":99,"#,
            "document.bad-index",
            Some("/accessors/0/bufferView"),
        ),
        (
            r#""bufferView":0,"#,
            r#""bufferView":4294967296,"#,
            "document.bad-index",
            Some("/accessors/0/bufferView"),
        ),
        // Sparse accessors.
        (
            r#""sparse":{"count":2"#,
            r#""sparse":{"count":5"#,
            "document.bad-accessor",
            Some("/accessors/2/sparse/count"),
        ),
        (
            r#""sparse":{"count":2"#,
            r#""sparse":{"count":3"#,
            "document.out-of-bounds",
            Some("/accessors/2/sparse/indices"),
        ),
        (
            r#""indices":{"bufferView":3,"componentType":5123"#,
            r#""indices":{"bufferView":3,"componentType":5126"#,
            "document.bad-accessor",
            Some("/accessors/2/sparse/indices/componentType"),
        ),
        (
            r#""indices":{"bufferView":3,"#,
            r#""indices":{"bufferView":0,"#,
            "document.bad-accessor",
            Some("/accessors/2/sparse/indices"),
        ),
        (
            r#""values":{"bufferView":4"#,
            r#""values":{"bufferView":9"#,
            "document.bad-index",
            Some("/accessors/2/sparse/values/bufferView"),
        ),
        (
            r#""byteLength":24}"#,
            r#""byteLength":24,"byteStride":16}"#,
            "document.bad-accessor",
            Some("/accessors/2/sparse/values"),
        ),
        // Buffer views and buffers.
        (
            r#""buffer":0,"byteOffset":0"#,
            r#""buffer":1,"byteOffset":0"#,
            "document.bad-index",
            Some("/bufferViews/0/buffer"),
        ),
        (
            r#""byteOffset":0,"byteLength":48"#,
            r#""byteOffset":0,"byteLength":4800"#,
            "document.out-of-bounds",
            Some("/bufferViews/0"),
        ),
        (
            r#""byteOffset":0,"byteLength":48"#,
            r#""byteOffset":18446744073709551615,"byteLength":48"#,
            "document.out-of-bounds",
            Some("/bufferViews/0"),
        ),
        (
            r#""byteLength":48}"#,
            r#""byteLength":48,"byteStride":8}"#,
            "document.bad-accessor",
            Some("/accessors/0"),
        ),
        (
            r#""byteLength":48}"#,
            r#""byteLength":48,"byteStride":0}"#,
            "document.bad-accessor",
            Some("/accessors/0"),
        ),
        (
            r#""byteLength":48}"#,
            r#""byteLength":48,"byteStride":16}"#,
            "document.out-of-bounds",
            Some("/accessors/0"),
        ),
        (
            r#"[{"byteLength":"#,
            r#"[{"byteLength":9"#,
            "document.truncated",
            Some("/buffers/0/byteLength"),
        ),
        (
            "part%200.bin",
            "other.bin",
            "document.missing-file",
            Some("/buffers/0/uri"),
        ),
        (
            r#""uri":"part%200.bin""#,
            r#""name":"gone""#,
            "document.missing-data",
            Some("/buffers/0"),
        ),
        (
            r#""uri":"part%200.bin""#,
            r#""uri":7"#,
            "document.bad-json",
            Some("/buffers/0/uri"),
        ),
        (
            "part%200.bin",
            "data:text/plain,hello",
            "document.bad-data-uri",
            Some("/buffers/0/uri"),
        ),
        (
            "part%200.bin",
            "data:;base64",
            "document.bad-data-uri",
            Some("/buffers/0/uri"),
        ),
        (
            "part%200.bin",
            "data:;base64,AA*A",
            "document.bad-data-uri",
            Some("/buffers/0/uri"),
        ),
        (
            "part%200.bin",
            "data:;base64,AA%4",
            "document.bad-data-uri",
            Some("/buffers/0/uri"),
        ),
        (
            "part%200.bin",
            r"data:;base64,AA\n",
            "document.bad-data-uri",
            Some("/buffers/0/uri"),
        ),
        (
            "part%200.bin",
            "data:;base64,é",
            "document.bad-data-uri",
            Some("/buffers/0/uri"),
        ),
        (
            "part%200.bin",
            "data:;base64,AAAA",
            "document.truncated",
            Some("/buffers/0/byteLength"),
        ),
        (
            r#""uri":"part%200.bin""#,
            r#""uri":null"#,
            "document.missing-data",
            Some("/buffers/0"),
        ),
        // References.
        (
            r#""POSITION":0"#,
            r#""POSITION":3"#,
            "document.bad-index",
            Some("/meshes/0/primitives/0/attributes/POSITION"),
        ),
        (
            r#""POSITION":0"#,
            r#""POSITION":0,"NORMAL":3"#,
            "document.bad-index",
            Some("/meshes/0/primitives/0/attributes/NORMAL"),
        ),
        (
            r#""POSITION":0"#,
            r#""POSITION":0,"_A/B~":3"#,
            "document.bad-index",
            Some("/meshes/0/primitives/0/attributes/_A~1B~0"),
        ),
        (
            r#""POSITION":0"#,
            r#""POSITION":0,"_A/B~":"3""#,
            "document.bad-json",
            Some("/meshes/0/primitives/0/attributes/_A~1B~0"),
        ),
        (
            r#""POSITION":0"#,
            r#""POSITION":1"#,
            "document.bad-accessor",
            Some("/accessors/1"),
        ),
        (
            r#""indices":1"#,
            r#""indices":0"#,
            "document.bad-accessor",
            Some("/accessors/0"),
        ),
        (
            r#""indices":1"#,
            r#""indices":8"#,
            "document.bad-index",
            Some("/meshes/0/primitives/0/indices"),
        ),
        (
            r#""indices":1"#,
            r#""indices":1,"targets":[{},{"POSITION":8}]"#,
            "document.bad-index",
            Some("/meshes/0/primitives/0/targets/1/POSITION"),
        ),
        (
            r#""mesh":0"#,
            r#""mesh":1"#,
            "document.bad-index",
            Some("/nodes/0/mesh"),
        ),
        (
            r#""mesh":0"#,
            r#""mesh":0,"skin":0"#,
            "document.bad-index",
            Some("/nodes/0/skin"),
        ),
        (
            r#""skins":[]"#,
            r#""images":[{"bufferView":9}]"#,
            "document.bad-index",
            Some("/images/0/bufferView"),
        ),
        (
            r#""skins":[]"#,
            r#""animations":[{"samplers":[{"input":0,"output":9}]}]"#,
            "document.bad-index",
            Some("/animations/0/samplers/0/output"),
        ),
        // The scene graph.
        (
            r#""children":[1]"#,
            r#""children":[2]"#,
            "document.bad-index",
            Some("/nodes/0/children/0"),
        ),
        (
            r#""children":[1]"#,
            r#""children":[0]"#,
            "document.cyclic-nodes",
            Some("/nodes/0"),
        ),
        (
            r#""name":"child""#,
            r#""children":[0]"#,
            "document.cyclic-nodes",
            Some("/nodes/0"),
        ),
        (
            r#""nodes":[0]"#,
            r#""nodes":[2]"#,
            "document.bad-index",
            Some("/scenes/0/nodes/0"),
        ),
        // Extensions.
        (
            r#""skins":[]"#,
            r#""extensionsRequired":["KHR_texture_transform","KHR_gaussian_splatting"]"#,
            "document.extension-unsupported",
            Some("/extensionsRequired/1"),
        ),
        (
            r#""skins":[]"#,
            r#""extensionsRequired":["KHR_draco_mesh_compression"]"#,
            "document.compression-unsupported",
            Some("/extensionsRequired/0"),
        ),
        (
            r#""mode":4"#,
            r#""mode":4,"extensions":{"KHR_draco_mesh_compression":{}}"#,
            "document.bad-compression",
            Some("/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression"),
        ),
        (
            r#""byteLength":48}"#,
            r#""byteLength":48,"extensions":{"EXT_meshopt_compression":{}}}"#,
            "document.bad-compression",
            Some("/bufferViews/0/extensions/EXT_meshopt_compression"),
        ),
        (
            r#""byteLength":48}"#,
            r#""byteLength":48,"extensions":{"KHR_meshopt_compression":{}}}"#,
            "document.bad-compression",
            Some("/bufferViews/0/extensions/KHR_meshopt_compression"),
        ),
    ];
    let Built { files, .. } = sound().build();
    let json = sound().json();
    for &(old, new, code, pointer) in replacements {
        assert!(json.contains(old), "{old} is not in {json}");
        // Without its view, accessor 0 is zeros and sound; its buffer view is then of unknown use.
        if old == r#""bufferView":0,"# && new.is_empty() {
            assert_eq!(read(json.replacen(old, new, 1).as_bytes(), &files), Ok(()));
            continue;
        }
        assert_refused(
            new,
            json.replacen(old, new, 1).as_bytes(),
            &files,
            code,
            pointer,
        );
    }
}

#[portable_test]
fn malformed_numbers_in_buffers_are_refused() {
    let change = |offset: usize, bytes: &[u8]| {
        let Built {
            bytes: json,
            mut files,
        } = sound().build();
        let buffer = files.get_mut("part 0.bin").expect("the buffer");
        buffer[offset..offset + bytes.len()].copy_from_slice(bytes);
        (json, files)
    };
    // Positions are the first 48 bytes; indices follow, then the sparse base (48), indices and values.
    let sparse_indices = 48 + 8 + 48;
    let indices = Some("/meshes/0/primitives/0/indices");
    let (json, files) = change(50, &4_u16.to_le_bytes());
    assert_refused(
        "vertex 4 of 4",
        &json,
        &files,
        "document.bad-vertex",
        indices,
    );
    let (json, files) = change(50, &u16::MAX.to_le_bytes());
    assert_refused(
        "restart",
        &json,
        &files,
        "document.primitive-restart",
        indices,
    );
    for (name, value) in [("descending", 3_u16), ("twice", 3), ("beyond", 4)] {
        let place = if name == "beyond" {
            sparse_indices + 2
        } else {
            sparse_indices
        };
        let (json, files) = change(place, &value.to_le_bytes());
        assert_refused(
            name,
            &json,
            &files,
            "document.bad-accessor",
            Some("/accessors/2/sparse/indices"),
        );
    }
}

#[portable_test]
fn sparse_positions_are_checked_before_anything_is_given_out() {
    let Built { bytes, mut files } = sound().build();
    let buffer = files.get_mut("part 0.bin").expect("the buffer");
    buffer[104..106].copy_from_slice(&9_u16.to_le_bytes());
    let error = Document::read(&bytes, &files).map(|_| ());
    assert_eq!(
        error.map_err(|error| error.code()),
        Err("document.bad-accessor")
    );
}

#[portable_test]
fn a_lying_count_without_data_allocates_nothing() {
    let mut builder = sound();
    builder.accessors[0] = r#"{"componentType":5126,"count":4000000000,"type":"VEC3"}"#.into();
    let Built { bytes, files } = builder.build();
    assert_refused(
        "zeros",
        &bytes,
        &files,
        "document.too-large",
        Some("/accessors/0/count"),
    );
}

/// What is stored nowhere is allowed for all accessors together.
#[portable_test]
fn many_counts_without_data_are_refused_together() {
    let with = |counts: &[u64]| {
        let mut builder = GltfBuilder::new(Packing::Glb);
        for count in counts {
            let position = builder.accessor(format!(
                r#"{{"componentType":5126,"count":{count},"type":"VEC3"}}"#
            ));
            // Twice, for an accessor that is used again takes no more.
            builder.mesh(&vec![primitive(position, None, 4); 2]);
        }
        builder.build()
    };
    let Built { bytes, files } = with(&[MAX_UNBACKED / 2, MAX_UNBACKED / 2]);
    assert_eq!(read(&bytes, &files), Ok(()));
    let Built { bytes, files } = with(&[MAX_UNBACKED / 2, MAX_UNBACKED / 2, 1]);
    assert_refused(
        "one more",
        &bytes,
        &files,
        "document.too-large",
        Some("/accessors/2/count"),
    );
}

/// Accessors of the same bytes, at `offset(i)` with `count(i)` elements of `stride(i)` bytes, each the positions of a primitive.
fn overlapping(num_accessors: usize, view: impl Fn(usize) -> (usize, usize)) -> Built {
    let mut builder = GltfBuilder::new(Packing::Glb);
    builder.push(0, &vec![0; 240_000]);
    builder.view(0, 0, 240_000, None);
    let mut primitives = Vec::new();
    for accessor in 0..num_accessors {
        let (offset, count) = view(accessor);
        let position = builder.accessor(format!(
            r#"{{"bufferView":0,"byteOffset":{offset},"componentType":5126,"count":{count},"type":"VEC3"}}"#
        ));
        primitives.push(primitive(position, None, 4));
    }
    builder.mesh(&primitives);
    builder.build()
}

/// Many accessors of the same bytes are legal, but not so many that reading them takes for ever.
#[portable_test]
fn positions_of_the_same_bytes_are_limited() {
    // Beginnings of one list, as levels of detail are: one use of their bytes.
    let Built { bytes, files } = overlapping(200, |number| (0, 20_000 - number));
    assert!(Document::read(&bytes, &files).is_ok());
    // 200 times 19 900 elements, each of which overlaps elements of all 200.
    let Built { bytes, files } = overlapping(200, |number| (4 * number, 19_900));
    assert_refused(
        "shifted",
        &bytes,
        &files,
        "document.too-large",
        Some("/accessors/134"),
    );
    // The same bytes 3400 times: 68 million vertices in 0.6 MB.
    let Built { bytes, files } = overlapping(3400, |_| (0, 20_000));
    assert_refused(
        "repeated",
        &bytes,
        &files,
        "document.too-large",
        Some("/accessors/3355/count"),
    );
}

#[portable_test]
fn too_many_nodes_are_refused() {
    let nodes = vec!["{}"; (1 << 20) + 1].join(",");
    let json = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}]}}"#);
    assert_refused(
        "nodes",
        json.as_bytes(),
        &Files::new(),
        "document.too-large",
        Some("/nodes"),
    );
}

#[portable_test]
fn external_buffers_are_named_once() {
    let mut builder = sound();
    builder.buffers.push(vec![0; 4]);
    let json = builder.json().replace("part%201.bin", "part%200.bin");
    assert_eq!(
        Document::file_names(json.as_bytes()),
        Ok(vec!["part 0.bin".to_owned()])
    );
    let names = Document::file_names(builder.json().as_bytes());
    assert_eq!(names.map(|names| names.len()), Ok(2));
    let embedded = GltfBuilder::new(Packing::DataUri).build();
    assert_eq!(Document::file_names(&embedded.bytes), Ok(Vec::new()));
    assert!(Document::file_names(b"{").is_err());
}

#[portable_test]
fn linked_files_are_named_whatever_names_them() {
    let text = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"a%20b.bin"},{"uri":"data:;base64,AA"}],
        "images":[{"uri":"t/x.png"},{"uri":"https://example.org/y.png"},{"uri":"//example.org/z.png"},{"uri":"t/x.png"}],
        "extensions":{"KHR_audio_emitter":{"audio":[{"uri":"s:1.mp3"},{"uri":"1:s.mp3"}]}},"extras":{"uri":""}}"#;
    assert_eq!(
        Document::linked_files(text.as_bytes()),
        Ok(["1:s.mp3", "a b.bin", "t/x.png"]
            .map(str::to_owned)
            .to_vec())
    );
}

#[portable_test]
fn the_columns_of_a_matrix_are_padded() {
    // The first buffer view has 48 bytes: 4 matrices of 3 columns of 3 bytes, 2 of 3 columns of 6 bytes.
    for (component, count) in [(Component::U8, 4), (Component::U16, 2)] {
        let matrices = |count: usize| {
            let mut builder = sound();
            let code = component.code();
            builder.accessor(format!(
                r#"{{"bufferView":0,"componentType":{code},"count":{count},"type":"MAT3"}}"#
            ));
            builder.build()
        };
        let Built { bytes, files } = matrices(count);
        assert_eq!(read(&bytes, &files), Ok(()));
        let Built { bytes, .. } = matrices(count + 1);
        assert_refused(
            "one more",
            &bytes,
            &files,
            "document.out-of-bounds",
            Some("/accessors/3"),
        );
    }
}

#[portable_test]
fn malformed_containers_are_refused() {
    let json = br#"{"asset":{"version":"2.0"}}     "#.to_vec();
    let sound = glb(&[
        (*b"JSON", json.clone()),
        (*b"BIN\0", vec![0; 8]),
        (*b"MORE", vec![1; 4]),
    ]);
    let none = Files::new();
    assert_eq!(read(&sound, &none), Ok(()));
    let refused =
        |name: &str, bytes: &[u8], code: &str| assert_refused(name, bytes, &none, code, None);

    refused("nothing", b"", "document.bad-container");
    refused(
        "another file",
        b"\x89PNG\r\n\x1a\n",
        "document.bad-container",
    );
    refused(
        "a JSON text of another kind",
        b"[]",
        "document.bad-container",
    );
    refused(
        "a torn JSON text",
        br#"{"asset":{"ver"#,
        "document.bad-json",
    );
    for length in 4..sound.len() {
        refused("truncated", &sound[..length], "document.truncated");
    }
    let change = |offset: usize, bytes: &[u8]| {
        let mut model = sound.clone();
        model[offset..offset + bytes.len()].copy_from_slice(bytes);
        model
    };
    refused(
        "a JSON chunk beyond the end",
        &change(12, &u32::MAX.to_le_bytes()),
        "document.truncated",
    );
    let binary = 20 + json.len();
    refused(
        "a binary chunk beyond the end",
        &change(binary, &100_u32.to_le_bytes()),
        "document.truncated",
    );
    refused(
        "another chunk beyond the end",
        &change(binary + 16, &5_u32.to_le_bytes()),
        "document.truncated",
    );
    refused("a header without chunks", &glb(&[]), "document.truncated");
    refused(
        "a binary chunk first",
        &glb(&[(*b"BIN\0", vec![0; 4])]),
        "document.bad-container",
    );
    refused("no UTF-8", &change(25, &[0xff]), "document.bad-json");
    assert_refused(
        "GLB 1",
        &change(4, &[1]),
        &none,
        "document.version-unsupported",
        Some("/asset/version"),
    );
}

#[portable_test]
fn a_chunk_length_is_not_the_buffer_length() {
    let json = br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":9}]}"#.to_vec();
    let model = glb(&[(*b"JSON", json.clone()), (*b"BIN\0", vec![0; 8])]);
    assert_refused(
        "short",
        &model,
        &Files::new(),
        "document.truncated",
        Some("/buffers/0/byteLength"),
    );
    let two = br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":8},{"byteLength":8}]}"#;
    let model = glb(&[(*b"JSON", two.to_vec()), (*b"BIN\0", vec![0; 8])]);
    assert_refused(
        "two",
        &model,
        &Files::new(),
        "document.missing-data",
        Some("/buffers/1"),
    );
    let model = glb(&[(*b"JSON", json)]);
    assert_refused(
        "absent",
        &model,
        &Files::new(),
        "document.missing-data",
        Some("/buffers/0"),
    );
}
