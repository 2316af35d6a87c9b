//! Single properties of documents, one each.

use crate::portable_test;
use meshmark::internals::document::{
    Container, Document, DocumentError, Files, Mode, Node, PositionGrid, Transform,
};

use super::oracle::Oracle;
use crate::support::glb::glb;
use crate::support::gltf_builder::{Built, Component, GltfBuilder, Layout, Packing, primitive};

const TRIANGLE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn read(builder: &GltfBuilder) -> Document {
    read_model(&builder.build())
}

fn read_model(model: &Built) -> Document {
    Document::read(&model.bytes, &model.files).expect("a readable document")
}

/// A document of one triangle, whose position accessor is 0.
fn triangle(packing: Packing) -> GltfBuilder {
    let mut builder = GltfBuilder::new(packing);
    let position = builder.positions(0, Layout::F32, &TRIANGLE);
    builder.mesh(&[primitive(position, None, 4)]);
    builder
}

fn move_first(
    document: &mut Document,
    accessor: usize,
    position: [f64; 3],
) -> Result<(), DocumentError> {
    let mut positions = document.positions(accessor).expect("positions");
    positions[0] = position;
    document.set_positions(accessor, &positions)
}

fn text(document: &Document) -> String {
    String::from_utf8(document.write().expect("a written document").model).expect("UTF-8")
}

// Positions.

fn stored_as(component: Component, normalized: bool, raw: &[[f64; 3]]) -> Document {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let layout = Layout {
        component,
        normalized,
        ..Layout::F32
    };
    let position = builder.positions(0, layout, raw);
    builder.mesh(&[primitive(position, None, 4)]);
    read(&builder)
}

#[portable_test]
fn normalized_integers_are_decoded_by_the_equations_of_the_specification() {
    let decoded = |component, raw| {
        stored_as(component, true, &[raw])
            .positions(0)
            .expect("positions")[0]
    };
    assert_eq!(
        decoded(Component::I8, [-128.0, -127.0, 127.0]),
        [-1.0, -1.0, 1.0]
    );
    assert_eq!(
        decoded(Component::I8, [0.0, 64.0, -1.0]),
        [0.0, 64.0 / 127.0, -1.0 / 127.0]
    );
    assert_eq!(
        decoded(Component::U8, [0.0, 128.0, 255.0]),
        [0.0, 128.0 / 255.0, 1.0]
    );
    assert_eq!(
        decoded(Component::I16, [-32768.0, -32767.0, 16384.0]),
        [-1.0, -1.0, 16384.0 / 32767.0]
    );
    assert_eq!(
        decoded(Component::U16, [1.0, 32768.0, 65535.0]),
        [1.0 / 65535.0, 32768.0 / 65535.0, 1.0]
    );
}

#[portable_test]
fn new_positions_go_to_the_nearest_value_of_the_grid_within_its_range() {
    let stored = |component, normalized, position| {
        let mut document = stored_as(component, normalized, &[[5.0; 3]]);
        document
            .set_positions(0, &[position])
            .expect("a movable position");
        document.positions(0).expect("positions")[0]
    };
    assert_eq!(
        stored(Component::U8, false, [254.6, -0.4, 1e300]),
        [255.0, 0.0, 255.0]
    );
    assert_eq!(
        stored(Component::I8, false, [-127.6, 126.4, -1e9]),
        [-128.0, 126.0, -128.0]
    );
    assert_eq!(
        stored(Component::I8, true, [0.51, -7.0, 2.0]),
        [65.0 / 127.0, -1.0, 1.0]
    );
    assert_eq!(
        stored(Component::U16, true, [0.50001, -0.1, 1.1]),
        [32768.0 / 65535.0, 0.0, 1.0]
    );
    assert_eq!(
        stored(Component::I16, false, [1e9, -1e9, 0.49]),
        [32767.0, -32768.0, 0.0]
    );
    assert_eq!(
        stored(Component::F32, false, [0.1, 1e-50, 1e300]),
        [f64::from(0.1_f32), 0.0, f64::from(f32::MAX)]
    );
}

#[portable_test]
fn the_grid_is_told() {
    let grid = |component, normalized| {
        stored_as(component, normalized, &[[0.0; 3]])
            .position_grid(0)
            .expect("a grid")
    };
    let integer = |step, min, max| PositionGrid::Integer { step, min, max };
    assert_eq!(grid(Component::F32, true), PositionGrid::Float32);
    assert_eq!(grid(Component::I8, true), integer(1.0 / 127.0, -1.0, 1.0));
    assert_eq!(grid(Component::U16, false), integer(1.0, 0.0, 65535.0));
}

#[portable_test]
fn values_that_are_equal_keep_their_bytes() {
    // Both -128 and -127 are -1 when normalized; zero has two signs.
    let mut document = stored_as(Component::I8, true, &[[-128.0, -127.0, 0.0]]);
    let before = document.write().expect("a written document");
    document
        .set_positions(0, &[[-1.0, -1.001, 0.003]])
        .expect("equal positions");
    assert_eq!(document.write().expect("a written document"), before);

    document
        .set_positions(0, &[[-1.0, 0.51, 0.0]])
        .expect("a movable position");
    let written = document.write().expect("a written document").model;
    let raw = Oracle::read_parts(&written, &Files::new()).raw(0);
    assert_eq!(raw, [[-128.0, 65.0, 0.0]]);

    let mut document = stored_as(Component::F32, false, &[[-0.0, 1.0, 2.0]]);
    let before = document.write().expect("a written document");
    document
        .set_positions(0, &[[0.0, 1.0 + 1e-12, 2.0]])
        .expect("equal positions");
    assert_eq!(document.write().expect("a written document"), before);
}

#[portable_test]
fn positions_may_be_packed_without_alignment() {
    let document = stored_as(Component::U8, false, &[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!(
        document.positions(0).expect("positions"),
        [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
    );
}

#[portable_test]
fn wrong_new_positions_are_refused_and_nothing_is_stored() {
    let mut document = read(&triangle(Packing::Glb));
    let before = document.write().expect("a written document");
    let refused = |document: &mut Document, accessor, positions: &[[f64; 3]]| {
        document
            .set_positions(accessor, positions)
            .expect_err("wrong positions")
            .code()
    };
    assert_eq!(
        refused(&mut document, 0, &[[9.0; 3]; 2]),
        "document.wrong-length"
    );
    let infinite = [[9.0; 3], [0.0, f64::INFINITY, 0.0], [0.0; 3]];
    assert_eq!(
        refused(&mut document, 0, &infinite),
        "document.non-finite-position"
    );
    assert_eq!(
        refused(&mut document, 7, &[[9.0; 3]; 3]),
        "document.not-positions"
    );
    assert_eq!(document.write().expect("a written document"), before);
}

// Triangles.

fn triangles(
    mode: u32,
    num_points: usize,
    indices: Option<(Component, &[u32])>,
) -> Result<Vec<[u32; 3]>, DocumentError> {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.positions(0, Layout::F32, &vec![[1.0; 3]; num_points]);
    let indices = indices.map(|(component, indices)| builder.indices(0, component, indices));
    builder.mesh(&[primitive(position, indices, mode)]);
    read(&builder).triangles(0, 0)
}

#[portable_test]
fn triangles_wind_as_the_specification_says() {
    assert_eq!(triangles(4, 6, None), Ok(vec![[0, 1, 2], [3, 4, 5]]));
    assert_eq!(
        triangles(5, 5, None),
        Ok(vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]])
    );
    assert_eq!(
        triangles(6, 5, None),
        Ok(vec![[1, 2, 0], [2, 3, 0], [3, 4, 0]])
    );
    for component in [Component::U8, Component::U16, Component::U32] {
        let indices = Some((component, &[4, 0, 3, 1][..]));
        assert_eq!(triangles(4, 5, indices), Ok(vec![[4, 0, 3]]));
        assert_eq!(triangles(5, 5, indices), Ok(vec![[4, 0, 3], [0, 1, 3]]));
        assert_eq!(triangles(6, 5, indices), Ok(vec![[0, 3, 4], [3, 1, 4]]));
    }
}

#[portable_test]
fn vertices_left_over_form_no_triangle() {
    for mode in [4, 5, 6] {
        assert_eq!(triangles(mode, 2, None), Ok(vec![]));
    }
    assert_eq!(triangles(4, 5, None), Ok(vec![[0, 1, 2]]));
}

#[portable_test]
fn points_and_lines_have_no_triangles() {
    for mode in [0, 1, 2, 3] {
        assert_eq!(triangles(mode, 6, None), Ok(vec![]));
    }
}

#[portable_test]
fn a_corner_must_be_a_vertex() {
    let error = triangles(4, 3, Some((Component::U16, &[0, 1, 3]))).expect_err("no vertex 3");
    assert_eq!(
        (error.code(), error.pointer()),
        (
            "document.bad-vertex",
            Some("/meshes/0/primitives/0/indices")
        )
    );
    let restarts = [
        (Component::U8, 255),
        (Component::U16, 65535),
        (Component::U32, u32::MAX),
    ];
    for (component, value) in restarts {
        let error =
            triangles(5, 300, Some((component, &[0, 1, value]))).expect_err("a reserved value");
        assert_eq!(error.code(), "document.primitive-restart");
    }
}

/// Exporters before 2019 counted vertices up to the largest 16-bit number, and every loader reads what they meant.
#[portable_test]
fn the_reserved_value_is_a_vertex_of_a_list_that_has_it() {
    let of =
        |num_points, component, value| triangles(4, num_points, Some((component, &[0, 1, value])));
    assert_eq!(of(256, Component::U8, 255), Ok(vec![[0, 1, 255]]));
    assert_eq!(of(65_536, Component::U16, 65_535), Ok(vec![[0, 1, 65_535]]));
    for (num_points, component, value) in [(255, Component::U8, 255), (300, Component::U16, 65_535)]
    {
        let error = of(num_points, component, value).expect_err("no such vertex");
        assert_eq!(error.code(), "document.primitive-restart");
    }
    let strip = triangles(5, 256, Some((Component::U8, &[0, 1, 255])));
    assert_eq!(
        strip.expect_err("a strip").code(),
        "document.primitive-restart"
    );
}

// Bounds and padding.

#[portable_test]
fn bounds_keep_their_spelling_where_they_stay_true() {
    let mut builder = GltfBuilder::new(Packing::DataUri);
    let points = [[0.0; 3], [0.1, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let touched = builder.positions(0, Layout::F32, &points);
    builder.mesh(&[primitive(touched, None, 4)]);
    let untouched = builder.positions(0, Layout::F32, &TRIANGLE);
    builder.mesh(&[primitive(untouched, None, 4)]);
    builder.accessors[0] = builder.accessors[0]
        .replace(r#""min":[0,0,0]"#, r#""min" : [ 0.0, -0e5 ,0]"#)
        .replace(r#""max":[0.1,1,0]"#, r#""max":[1e-1,10e-1,-7]"#);
    builder.accessors[1] =
        builder.accessors[1].replace(r#""max":[1,1,0]"#, r#""max":["what",null]"#);
    let before = builder.json();
    let mut document = read(&builder);
    move_first(&mut document, 0, [0.0, -0.1, 0.0]).expect("a movable position");
    let after = text(&document);
    let expected = before
        .replace("[ 0.0, -0e5 ,0]", "[ 0.0, -0.1 ,0]")
        .replace("[1e-1,10e-1,-7]", "[1e-1,10e-1,0.0]");
    let cut = |text: &str| text[text.find(r#""bufferViews""#).expect("views")..].to_owned();
    assert_eq!(cut(&after), cut(&expected));
    assert!(after.contains(r#"["what",null]"#));
}

#[portable_test]
fn unusable_bounds_of_a_changed_accessor_are_written_anew() {
    let mut builder = triangle(Packing::External);
    builder.accessors[0] = builder.accessors[0].replace(r#""min":[0,0,0]"#, r#""min":[0,0]"#);
    let mut document = read(&builder);
    move_first(&mut document, 0, [-3.0, 0.0, 0.0]).expect("a movable position");
    assert!(text(&document).contains(r#""min":[-3.0,0.0,0.0],"max":[1,1,0]"#));
}

#[portable_test]
fn bounds_of_integers_are_the_stored_integers() {
    let mut builder = GltfBuilder::new(Packing::External);
    let layout = Layout {
        component: Component::I16,
        normalized: true,
        gap: 2,
        bounds: true,
    };
    let position = builder.positions(0, layout, &[[-32767.0, 5.0, 6.0], [32767.0, 0.0, 1.0]]);
    builder.mesh(&[primitive(position, None, 0)]);
    builder.accessors[0] = builder.accessors[0].replace("[32767,5,6]", "[32767.0,5,6]");
    let mut document = read(&builder);
    move_first(&mut document, 0, [-0.5, 1.0, 0.0]).expect("a movable position");
    assert!(text(&document).contains(r#""min":[-16384,0,0],"max":[32767.0,32767,1]"#));
}

#[portable_test]
fn bounds_of_data_that_is_not_finite_stay() {
    let mut builder = GltfBuilder::new(Packing::External);
    let points = [TRIANGLE[0], TRIANGLE[1], [0.0, f64::INFINITY, 0.0]];
    let all = builder.positions(0, Layout::F32, &points);
    let finite = builder.positions_at(0, 0, Layout::F32, &points[..2]);
    builder.mesh(&[primitive(all, None, 0), primitive(finite, None, 0)]);
    builder.accessors[all] = builder.accessors[all].replace("[1,inf,0]", "[1,9,0]");
    let mut document = read(&builder);
    move_first(&mut document, finite, [2.0, 2.0, -2.0]).expect("a movable position");
    let text = text(&document);
    assert!(text.contains(r#""min":[0,0,-2.0],"max":[1,9,0]"#), "{text}");
    assert!(
        text.contains(r#""min":[1.0,0,-2.0],"max":[2.0,2.0,0]"#),
        "{text}"
    );
}

#[portable_test]
fn padding_changes_only_with_the_length_of_the_text() {
    let padded = |builder: &GltfBuilder, padding: &str| {
        let json = builder.json() + padding;
        glb(&[
            (*b"JSON", json.into_bytes()),
            (*b"BIN\0", builder.buffers[0].clone()),
            (*b"OWN!", vec![9; 3]),
        ])
    };
    let builder = triangle(Packing::Glb);
    let odd = padded(&builder, "       ");
    let mut document = Document::read(&odd, &Files::new()).expect("a readable document");
    assert_eq!(document.write().expect("a written document").model, odd);

    // From "1,1,0" to "2.0,1,0": two characters more.
    let mut positions = document.positions(0).expect("positions");
    positions[1] = [2.0, 0.0, 0.0];
    document
        .set_positions(0, &positions)
        .expect("movable positions");
    let mut expected = builder.clone();
    expected.buffers[0][12..16].copy_from_slice(&2_f32.to_le_bytes());
    expected.accessors[0] = expected.accessors[0].replace(r#""max":[1,"#, r#""max":[2.0,"#);
    let spaces = " ".repeat(expected.json().len().next_multiple_of(4) - expected.json().len());
    assert_eq!(
        document.write().expect("a written document").model,
        padded(&expected, &spaces)
    );

    // A text of the same length keeps its padding.
    let mut builder = triangle(Packing::Glb);
    builder.accessors[0] = builder.accessors[0].replace(r#""max":[1,"#, r#""max":[1.0,"#);
    let mut document =
        Document::read(&padded(&builder, "       "), &Files::new()).expect("a readable document");
    document
        .set_positions(0, &positions)
        .expect("movable positions");
    assert_eq!(
        document.write().expect("a written document").model,
        padded(&expected, "       ")
    );
}

// Shared bytes.

/// Refuses to move the first position of accessor 0.
fn assert_fixed(builder: &GltfBuilder, what: &str) {
    let mut document = read(builder);
    assert!(document.fixed_elements(0).expect("elements")[0], "{what}");
    let before = document.write().expect("a written document");
    let error = move_first(&mut document, 0, [0.5; 3]).expect_err(what);
    assert_eq!(
        (error.code(), error.pointer()),
        ("document.fixed-element", Some("/accessors/0")),
        "{what}"
    );
    assert_eq!(
        document.write().expect("a written document"),
        before,
        "{what}"
    );
}

#[portable_test]
fn positions_that_serve_another_purpose_stay() {
    let with = |change: &dyn Fn(&mut GltfBuilder)| {
        let mut builder = triangle(Packing::Glb);
        change(&mut builder);
        builder
    };
    let accessor = |kind: &str, component: Component, count: usize| {
        format!(
            r#"{{"bufferView":0,"componentType":{},"count":{count},"type":"{kind}"}}"#,
            component.code()
        )
    };

    let same =
        with(&|builder| builder.meshes[0] = builder.meshes[0].replace("0}", r#"0,"NORMAL":0}"#));
    assert_fixed(&same, "the accessor is also normals");
    let custom =
        with(&|builder| builder.meshes[0] = builder.meshes[0].replace("0}", r#"0,"_OWN":0}"#));
    assert_fixed(&custom, "the accessor is also a custom attribute");
    let morph = with(&|builder| {
        builder.meshes[0] =
            builder.meshes[0].replace(r#""mode""#, r#""targets":[{"POSITION":0}],"mode""#)
    });
    assert_fixed(&morph, "the accessor is also a morph target");
    let sampler = with(&|builder| {
        builder
            .members
            .push(r#""animations":[{"samplers":[{"input":0,"output":0}]}]"#.into())
    });
    assert_fixed(&sampler, "the accessor is also an animation");
    let instances =
        r#"{"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}}"#;
    assert_fixed(
        &with(&|builder| _ = builder.node(instances)),
        "the accessor also places instances",
    );
    assert_fixed(
        &with(&|builder| _ = builder.accessor(accessor("SCALAR", Component::U8, 2))),
        "another accessor",
    );
    assert_fixed(
        &with(&|builder| _ = builder.view(0, 11, 3, None)),
        "a buffer view of unknown use",
    );
    let image = with(&|builder| {
        builder
            .members
            .push(r#""images":[{"bufferView":0}]"#.into())
    });
    assert_fixed(&image, "an image");
}

#[portable_test]
fn positions_fixed_in_part_can_move_elsewhere() {
    let mut builder = triangle(Packing::Glb);
    builder.accessor(
        r#"{"bufferView":0,"byteOffset":12,"componentType":5121,"count":1,"type":"SCALAR"}"#.into(),
    );
    let mut document = read(&builder);
    assert_eq!(document.fixed_elements(0), Ok(vec![false, true, false]));
    assert!(document.is_writable(0));
    move_first(&mut document, 0, [5.0; 3]).expect("a movable position");
    assert_eq!(
        document.positions(0).expect("positions"),
        [[5.0; 3], TRIANGLE[1], TRIANGLE[2]]
    );
}

#[portable_test]
fn strided_data_fixes_the_positions_it_touches() {
    let mut builder = triangle(Packing::Glb);
    // Bytes 4 to 7 and 20 to 23, where positions are 0 to 11, 12 to 23 and 24 to 35.
    let view = builder.view(0, 4, 20, Some(16));
    builder.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5126,"count":2,"type":"SCALAR"}}"#
    ));
    assert_eq!(
        read(&builder).fixed_elements(0),
        Ok(vec![true, true, false])
    );
}

#[portable_test]
fn long_data_fixes_positions_behind_shorter_data() {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let offset = builder.push(0, &[0; 100]);
    let before = builder.view(0, offset, 136, None);
    let position = builder.positions(0, Layout::F32, &TRIANGLE);
    builder.mesh(&[primitive(position, None, 4)]);
    builder.accessor(format!(
        r#"{{"bufferView":{before},"componentType":5121,"count":136,"type":"SCALAR"}}"#
    ));
    for start in 1..9 {
        builder.accessor(format!(
            r#"{{"bufferView":{before},"byteOffset":{start},"componentType":5121,"count":1,"type":"SCALAR"}}"#
        ));
    }
    assert!(!read(&builder).is_writable(position));
}

#[portable_test]
fn sparse_indices_are_not_positions() {
    let mut builder = triangle(Packing::Glb);
    let sparse = builder.accessor(
        r#"{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,
            "indices":{"bufferView":0,"componentType":5125},
            "values":{"bufferView":0,"byteOffset":24}}}"#
            .into(),
    );
    builder.mesh(&[primitive(sparse, None, 4)]);
    assert_eq!(
        read(&builder).fixed_elements(0),
        Ok(vec![true, false, false])
    );
}

#[portable_test]
fn positions_that_overlap_in_part_or_in_another_format_stay() {
    let mut builder = triangle(Packing::Glb);
    let shifted = builder.positions_at(0, 4, Layout::F32, &TRIANGLE[..2]);
    builder.mesh(&[primitive(shifted, None, 4)]);
    assert_fixed(&builder, "a shifted accessor");
    assert!(!read(&builder).is_writable(0) && !read(&builder).is_writable(1));

    let mut builder = triangle(Packing::Glb);
    let layout = Layout {
        component: Component::I16,
        ..Layout::F32
    };
    let other = builder.positions_at(0, 0, layout, &TRIANGLE);
    builder.mesh(&[primitive(other, None, 4)]);
    assert_fixed(&builder, "another number format");
}

#[portable_test]
fn positions_of_two_accessors_in_the_same_bytes_are_one() {
    let mut builder = triangle(Packing::External);
    let view = builder.view(0, 12, 24, None);
    let other = builder.positions_at(view, 0, Layout::F32, &TRIANGLE[1..]);
    builder.mesh(&[primitive(other, None, 4)]);
    let mut document = read(&builder);
    assert_eq!(
        document.slots(0).expect("slots")[1..],
        document.slots(other).expect("slots")[..]
    );
    move_first(&mut document, other, [1.5, 0.0, 0.0]).expect("a movable position");
    assert_eq!(
        document.positions(0).expect("positions")[1],
        [1.5, 0.0, 0.0]
    );
    assert_eq!(
        text(&document).matches("[1.5,1,0]").count(),
        2,
        "both bounds are true"
    );
}

#[portable_test]
fn elements_that_are_stored_nowhere_stay_zero() {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.sparse_positions(0, Layout::F32, &TRIANGLE, &[1], false);
    builder.mesh(&[primitive(position, None, 4)]);
    assert_fixed(&builder, "no storage");
    let mut document = read(&builder);
    assert_eq!(document.fixed_elements(0), Ok(vec![true, false, true]));
    assert_eq!(
        document.positions(0).expect("positions"),
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0; 3]]
    );
    document
        .set_positions(0, &[[0.0; 3], [2.0; 3], [0.0; 3]])
        .expect("the sparse value can move");
}

#[portable_test]
fn the_base_under_a_sparse_value_is_not_touched() {
    let mut builder = GltfBuilder::new(Packing::External);
    let position = builder.sparse_positions(0, Layout::F32, &TRIANGLE, &[1], true);
    builder.mesh(&[primitive(position, None, 4)]);
    let mut document = read(&builder);
    document
        .set_positions(0, &[[9.0; 3]; 3])
        .expect("movable positions");
    let changed = &document.write().expect("a written document").files["part 0.bin"];
    assert_eq!(changed[12..24], builder.buffers[0][12..24]);
    assert_eq!(document.positions(0).expect("positions"), [[9.0; 3]; 3]);
}

// Buffers.

#[portable_test]
fn data_uris_are_edited_in_place_however_they_are_spelled() {
    let mut builder = triangle(Packing::DataUri);
    builder.push(0, &[1]);
    let plain = builder.json();
    let respelled = |text: &str| {
        let (start, rest) = text.split_once(";base64,").expect("a payload");
        let (payload, end) = rest.split_once('"').expect("the string's end");
        // Escapes of both kinds, also beside symbols that will change; no padding; unused bits set.
        let payload = payload
            .trim_end_matches('=')
            .replace("D8A", r"\u00448%41")
            .replacen('A', "%41", 1);
        let payload = payload
            .strip_suffix('Q')
            .expect("the symbol of the last byte");
        format!(r#"{start};CHARSET=x;BASE64,{payload}R"{end}"#)
    };
    let model = respelled(&plain);
    let mut document =
        Document::read(model.as_bytes(), &Files::new()).expect("a readable document");
    assert_eq!(document.positions(0).expect("positions"), TRIANGLE);
    assert_eq!(text(&document), model);

    let mut moved = TRIANGLE;
    moved[2] = [0.0, 0.75, 0.0];
    document
        .set_positions(0, &moved)
        .expect("movable positions");
    let mut expected = builder.clone();
    expected.buffers[0][28..32].copy_from_slice(&0.75_f32.to_le_bytes());
    expected.accessors[0] = expected.accessors[0].replace("[1,1,0]", "[1,0.75,0]");
    assert_eq!(text(&document), respelled(&expected.json()));
}

#[portable_test]
fn external_files_are_found_by_decoded_name_and_given_out_if_changed() {
    let mut builder = triangle(Packing::External);
    builder.push(1, &[1, 2, 3]);
    builder.view(1, 0, 3, None);
    let mut document = read(&builder);
    move_first(&mut document, 0, [-1.0; 3]).expect("a movable position");
    let written = document.write().expect("a written document");
    assert_eq!(written.files.keys().collect::<Vec<_>>(), ["part 0.bin"]);
}

#[portable_test]
fn two_buffers_of_one_file_are_the_same_bytes() {
    let mut builder = triangle(Packing::External);
    builder.buffers.push(builder.buffers[0].clone());
    let view = builder.view(1, 0, 36, None);
    let other = builder.positions_at(view, 0, Layout::F32, &TRIANGLE);
    builder.mesh(&[primitive(other, None, 4)]);
    let model = Built {
        bytes: builder
            .json()
            .replace("part%201.bin", "part%200.bin")
            .into_bytes(),
        ..builder.build()
    };
    let mut document = read_model(&model);
    move_first(&mut document, other, [-1.0; 3]).expect("a movable position");
    assert_eq!(document.positions(0).expect("positions")[0], [-1.0; 3]);
    assert_eq!(document.write().expect("a written document").files.len(), 1);
}

#[portable_test]
fn bytes_after_a_buffer_are_kept() {
    let mut model = triangle(Packing::External).build();
    model
        .files
        .get_mut("part 0.bin")
        .expect("the buffer")
        .extend_from_slice(b"tail");
    let mut document = read_model(&model);
    move_first(&mut document, 0, [-1.0; 3]).expect("a movable position");
    assert!(document.write().expect("a written document").files["part 0.bin"].ends_with(b"tail"));
}

// JSON.

#[portable_test]
fn a_byte_order_mark_is_kept() {
    let model = Built {
        bytes: format!("\u{feff}{}", triangle(Packing::DataUri).json()).into_bytes(),
        files: Files::new(),
    };
    let mut document = read_model(&model);
    assert_eq!(
        document.write().expect("a written document").model,
        model.bytes
    );
    move_first(&mut document, 0, [-1.0; 3]).expect("a movable position");
    let written = document.write().expect("a written document").model;
    assert!(written.starts_with("\u{feff}{".as_bytes()));
    assert_eq!(
        Oracle::read_parts(&written, &Files::new()).raw(0)[0],
        [-1.0; 3]
    );
}

#[portable_test]
fn bytes_after_the_end_of_a_glb_are_kept() {
    let Built { mut bytes, files } = triangle(Packing::Glb).build();
    bytes.extend_from_slice(b"signed by nobody");
    let mut document = Document::read(&bytes, &files).expect("a document");
    assert_eq!(document.write().expect("a written document").model, bytes);
    move_first(&mut document, 0, [-2.0, 0.0, 0.0]).expect("a movable position");
    let written = document.write().expect("a written document").model;
    let length = u32::from_le_bytes(*written[8..].first_chunk().expect("a length"));
    assert_eq!(&written[length as usize..], b"signed by nobody");
}

#[portable_test]
fn what_is_null_is_not_there() {
    let mut builder = triangle(Packing::DataUri);
    builder.accessors[0] = builder.accessors[0]
        .replace(r#""min":[0,0,0],"#, r#""min":null,"#)
        .replace(r#""max":[1,1,0]"#, r#""max":[1,null,0]"#);
    builder.node(r#"{"mesh":0,"matrix":null,"children":null,"translation":[1,2,3]}"#);
    let mut document = read(&builder);
    let translated = |node: &Node| {
        matches!(
            node.transform,
            Transform::Decomposed {
                translation: [1.0, 2.0, 3.0],
                ..
            }
        )
    };
    assert!(document.nodes().iter().any(translated));
    let model = builder.build().bytes;
    assert_eq!(document.write().expect("a written document").model, model);
    move_first(&mut document, 0, [-2.0, 0.0, 0.0]).expect("a movable position");
    assert!(
        text(&document).contains(r#""min":null,"max":[1,1.0,0]"#),
        "{}",
        text(&document)
    );
}

#[portable_test]
fn unknown_data_may_be_anything() {
    let mut builder = triangle(Packing::DataUri);
    let deep = format!("{}{}", "[".repeat(20_000), "]".repeat(20_000));
    builder.members.push(format!(
        r#""extras":{{"deep":{deep},"huge":1e999,"name":"{}"}}"#,
        "x".repeat(1000)
    ));
    assert_eq!(text(&read(&builder)), builder.json());
}

#[portable_test]
fn the_scene_graph_is_given_out() {
    let mut builder = triangle(Packing::Glb);
    builder.node(r#"{"children":[2],"matrix":[1,0,0,0,0,2,0,0,0,0,3,0,4,5,6,1]}"#);
    builder.node(r#"{"mesh":0,"skin":0,"translation":[1,2,3]}"#);
    builder.node(r#"{"rotation":[0,1,0,0],"scale":[1,2,3],"mesh":0}"#);
    builder.members.push(r#""skins":[{"joints":[0]}]"#.into());
    let document = read(&builder);
    assert_eq!(document.container(), Container::Glb);
    assert_eq!(document.roots(), [0, 1]);
    let [parent, skinned, child] = document.nodes() else {
        panic!("three nodes")
    };
    let matrix = [
        1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 4.0, 5.0, 6.0, 1.0,
    ];
    assert_eq!(
        (parent.transform, &parent.children[..]),
        (Transform::Matrix(matrix), &[2][..])
    );
    assert_eq!((skinned.mesh, skinned.skin), (Some(0), Some(0)));
    let decomposed = |translation, rotation, scale| Transform::Decomposed {
        translation,
        rotation,
        scale,
    };
    assert_eq!(
        skinned.transform,
        decomposed([1.0, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0], [1.0; 3])
    );
    assert_eq!(
        child.transform,
        decomposed([0.0; 3], [0.0, 1.0, 0.0, 0.0], [1.0, 2.0, 3.0])
    );

    builder
        .members
        .push(r#""scenes":[{"nodes":[1]},{},{"nodes":[1]}],"extensionsUsed":["A"]"#.into());
    let document = read(&builder);
    assert_eq!(document.roots(), [1]);
    assert_eq!(document.extensions_used(), ["A"]);
}

#[portable_test]
fn primitives_are_given_out() {
    let mut builder = triangle(Packing::Glb);
    let indices = builder.indices(0, Component::U8, &[0, 1, 2]);
    let deltas = builder.positions(0, Layout::F32, &TRIANGLE);
    builder.meshes[0] = format!(
        r#"{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":{indices},"targets":[{{"POSITION":{deltas}}}]}},{{"attributes":{{}},"mode":5}}]}}"#
    );
    let document = read(&builder);
    let [morphing, empty] = &document.meshes()[0].primitives[..] else {
        panic!("two primitives")
    };
    assert_eq!(
        (morphing.position, morphing.indices, morphing.mode),
        (Some(0), Some(indices), Mode::Triangles)
    );
    assert!(morphing.has_morph_targets && !empty.has_morph_targets);
    assert_eq!((empty.position, empty.mode), (None, Mode::TriangleStrip));
    assert_eq!(document.triangles(0, 1), Ok(vec![]));
    let error = document.triangles(0, 2).expect_err("no such primitive");
    assert_eq!(
        (error.code(), error.pointer()),
        ("document.not-positions", Some("/meshes/0/primitives/2"))
    );
    assert_eq!(
        document
            .positions(deltas)
            .expect_err("deltas are no positions")
            .code(),
        "document.not-positions"
    );
}

#[portable_test]
fn harmless_extensions_may_be_required() {
    for name in [
        "KHR_mesh_quantization",
        "KHR_texture_transform",
        "KHR_materials_unlit",
        "KHR_texture_basisu",
        "MSFT_lod",
        "VRM",
        "VRMC_springBone",
        "KHR_audio_emitter",
        "KHR_physics_rigid_bodies",
        "KHR_interactivity",
        "OMI_seat",
        "AGI_articulations",
        "CESIUM_RTC",
    ] {
        let mut builder = triangle(Packing::Glb);
        builder.members.push(format!(
            r#""extensionsUsed":["{name}"],"extensionsRequired":["{name}"]"#
        ));
        assert!(read(&builder).is_writable(0), "{name}");
    }
    // A compression that is declared but nowhere in use.
    let mut builder = triangle(Packing::Glb);
    builder
        .members
        .push(r#""extensionsUsed":["KHR_draco_mesh_compression"]"#.into());
    assert!(read(&builder).is_writable(0));
}
