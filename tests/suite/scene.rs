//! From documents to meshes and back.

use crate::portable_test;
use crate::support::fixtures::gallery;
use crate::support::gltf_builder::{Built, Component, GltfBuilder, Layout, Packing, primitive};
use glam::DVec3;
use meshmark::internals::document::{Document, Files, MAX_UNBACKED};
use meshmark::internals::mesh::{Edges, Mesh, shapes};
use meshmark::internals::scene::{
    Count, MAX_ELEMENTS, MAX_PARTS, MAX_TRIANGLES, Scene, SceneError, to_glb,
};

fn read(model: &Built) -> Document {
    Document::read(&model.bytes, &model.files).unwrap()
}

/// A document of one triangle mesh, shown by the given nodes (JSON text behind `"mesh":0`).
fn shown(points: &[[f64; 3]], indices: &[u32], nodes: &[&str]) -> Document {
    shown_as(Layout::F32, points, indices, nodes)
}

fn shown_as(layout: Layout, points: &[[f64; 3]], indices: &[u32], nodes: &[&str]) -> Document {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.positions(0, layout, points);
    let indices = builder.indices(0, Component::U16, indices);
    let mesh = builder.mesh(&[primitive(position, Some(indices), 4)]);
    for node in nodes {
        builder.node(&format!(r#"{{"mesh":{mesh}{node}}}"#));
    }
    read(&builder.build())
}

const TRIANGLE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

#[portable_test]
fn scene_copies_at_a_seam_are_one_vertex() {
    let points = [
        TRIANGLE[0],
        TRIANGLE[1],
        TRIANGLE[2],
        TRIANGLE[1],
        [1.0, 1.0, 0.0],
        [-0.0, 1.0, 0.0],
    ];
    let mut document = shown(&points, &[0, 1, 2, 3, 4, 5], &[""]);
    let scene = Scene::gather(&document).unwrap();
    assert_eq!(
        (scene.mesh.positions.len(), scene.mesh.triangles.len()),
        (4, 2)
    );
    assert_eq!(
        Edges::new(&scene.mesh).num_boundary(),
        4,
        "the seam is closed; -0 is 0"
    );
    let displacement: Vec<DVec3> = (0..4).map(|v| DVec3::Z * f64::from(v) * 0.125).collect();
    scene.scatter(&mut document, &displacement).unwrap();
    let moved = document.positions(0).unwrap();
    assert_eq!(moved[1], moved[3]);
    assert_eq!(moved[2], moved[5]);
}

#[portable_test]
fn scene_places_nodes_in_world_space() {
    let mut builder = GltfBuilder::new(Packing::DataUri);
    let position = builder.positions(0, Layout::F32, &TRIANGLE);
    let mesh = builder.mesh(&[primitive(position, None, 4)]);
    builder.node(r#"{"children":[1],"translation":[10,0,0],"scale":[2,2,2]}"#);
    builder.node(&format!(
        r#"{{"mesh":{mesh},"rotation":[0,0,0.7071067811865476,0.7071067811865476]}}"#
    ));
    let scene = Scene::gather(&read(&builder.build())).unwrap();
    let expected = [[10.0, 0.0, 0.0], [10.0, 2.0, 0.0], [8.0, 0.0, 0.0]].map(DVec3::from_array);
    assert!(
        scene
            .mesh
            .positions
            .iter()
            .zip(expected)
            .all(|(p, e)| p.distance(e) < 1e-6),
        "{:?}",
        scene.mesh.positions
    );
}

#[portable_test]
fn scene_mirrored_nodes_keep_their_outside() {
    let plain = Scene::gather(&shown(&TRIANGLE, &[0, 1, 2], &[""])).unwrap();
    let mirrored = Scene::gather(&shown(&TRIANGLE, &[0, 1, 2], &[r#","scale":[-1,1,1]"#])).unwrap();
    let normal = |mesh: &Mesh| {
        let [a, b, c] = mesh.corners(mesh.triangles[0]);
        (b - a).cross(c - a)
    };
    assert_eq!(normal(&plain.mesh), normal(&mirrored.mesh));
}

#[portable_test]
fn scene_instances_share_one_displacement() {
    let mut document = shown(
        &TRIANGLE,
        &[0, 1, 2],
        &["", r#","translation":[5,0,0],"scale":[3,3,3]"#],
    );
    let scene = Scene::gather(&document).unwrap();
    assert_eq!(scene.mesh.positions.len(), 6);
    assert_eq!(scene.admissible.orbits.len(), 3);
    let mut displacement = vec![DVec3::ZERO; 6];
    displacement[0] = DVec3::new(0.0, 0.0, 1.0);
    scene.admissible.project(&mut displacement);
    scene.scatter(&mut document, &displacement).unwrap();
    let after = Scene::gather(&document).unwrap().mesh.positions;
    let change: Vec<f64> = after
        .iter()
        .zip(&scene.mesh.positions)
        .map(|(a, b)| (*a - *b).z)
        .collect();
    assert!(
        (change[0] - 0.1).abs() < 1e-6 && (change[3] - 0.3).abs() < 1e-6,
        "{change:?}"
    );
    assert!([1, 2, 4, 5].iter().all(|&v| change[v] == 0.0));
}

/// A half and its mirror image touch along x = 0: vertices there may not leave the plane, and are fixed.
#[portable_test]
fn scene_instances_that_contradict_each_other_are_fixed() {
    let document = shown(&TRIANGLE, &[0, 1, 2], &["", r#","scale":[-1,1,1]"#]);
    let scene = Scene::gather(&document).unwrap();
    assert_eq!(scene.mesh.positions.len(), 4);
    assert_eq!(scene.admissible.fixed, [0, 2]);
    assert_eq!(scene.admissible.orbits.len(), 1);
}

#[portable_test]
fn scene_flattened_node_cannot_be_written() {
    let scene = Scene::gather(&shown(&TRIANGLE, &[0, 1, 2], &[r#","scale":[1,1,0]"#])).unwrap();
    assert_eq!(scene.admissible.fixed, [0, 1, 2]);
}

#[portable_test]
fn scene_two_accessors_of_the_same_bytes_are_the_same_vertices() {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.positions(0, Layout::F32, &TRIANGLE);
    let again = builder.positions_at(0, 0, Layout::F32, &TRIANGLE);
    let meshes = [position, again].map(|position| builder.mesh(&[primitive(position, None, 4)]));
    builder.node(&format!(r#"{{"mesh":{}}}"#, meshes[0]));
    builder.node(&format!(
        r#"{{"mesh":{},"translation":[0,0,4]}}"#,
        meshes[1]
    ));
    let mut document = read(&builder.build());
    let scene = Scene::gather(&document).unwrap();
    assert_eq!(scene.admissible.orbits.len(), 3);
    let displacement = vec![DVec3::X * 0.25; 6];
    scene.scatter(&mut document, &displacement).unwrap();
    let after = scene.positions_in(&document).unwrap();
    assert!(
        after
            .iter()
            .zip(&scene.mesh.positions)
            .all(|(a, b)| *a - *b == DVec3::X * 0.25)
    );
}

#[portable_test]
fn scene_degenerate_triangles_and_unused_vertices_are_no_part_of_it() {
    let points = [
        TRIANGLE[0],
        TRIANGLE[1],
        TRIANGLE[2],
        [7.0, 7.0, 7.0],
        TRIANGLE[0],
    ];
    let scene = Scene::gather(&shown(&points, &[0, 1, 2, 0, 4, 1, 1, 1, 2], &[""])).unwrap();
    assert_eq!(
        (scene.mesh.positions.len(), scene.mesh.triangles.len()),
        (3, 1)
    );
}

/// What is no number cannot be stated in JSON.
const UNBOUNDED: Layout = Layout {
    bounds: false,
    ..Layout::F32
};

#[portable_test]
fn scene_numbers_that_are_none_matter_where_a_triangle_looks() {
    for (value, code) in [(f64::NAN, 0x7fc0_0000_u32), (f64::INFINITY, 0x7f80_0000)] {
        let points = [TRIANGLE[0], TRIANGLE[1], TRIANGLE[2], [7.0, value, 7.0]];
        let mut document = shown_as(UNBOUNDED, &points, &[0, 1, 2], &[""]);
        let scene = Scene::gather(&document).unwrap();
        assert_eq!(scene.mesh.positions.len(), 3);
        let moved = [DVec3::new(0.0, 0.0, 0.5); 3];
        scene.scatter(&mut document, &moved).unwrap();
        let model = document.write().unwrap().model;
        let kept = code.to_le_bytes();
        assert!(model.windows(4).any(|bytes| bytes == kept));
        let scene = Scene::gather(&Document::read(&model, &Files::new()).unwrap()).unwrap();
        assert!(
            scene
                .mesh
                .positions
                .iter()
                .all(|position| position.z == 0.5)
        );

        let error = Scene::gather(&shown_as(UNBOUNDED, &points, &[0, 1, 3], &[""])).unwrap_err();
        assert_eq!(error.code(), "document.non-finite-position");
        assert!(error.to_string().contains("vertex 3"), "{error}");
    }
}

/// Where the first vertices of what each node shows are.
fn places(builder: &GltfBuilder) -> Vec<[f64; 3]> {
    let pieces = Scene::pieces(&read(&builder.build())).unwrap();
    pieces
        .iter()
        .map(|(_, piece)| piece.positions[0].to_array())
        .collect()
}

/// A triangle as mesh 0, and the JSON text of nodes and scenes.
fn with_nodes(nodes: &[&str], scenes: &str) -> GltfBuilder {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.positions(0, Layout::F32, &TRIANGLE);
    builder.mesh(&[primitive(position, None, 4)]);
    nodes.iter().for_each(|node| _ = builder.node(node));
    builder.members.push(format!(r#""scenes":{scenes}"#));
    builder
}

#[portable_test]
fn scene_shows_a_shared_node_once_each_way() {
    let nodes = [
        r#"{"mesh":0}"#,
        r#"{"children":[0,0],"translation":[10,0,0]}"#,
        r#"{"children":[0],"translation":[20,0,0]}"#,
        r#"{"children":[2,1],"translation":[0,9,0]}"#,
    ];
    let shared = with_nodes(&nodes, r#"[{"nodes":[1,2]}]"#);
    assert_eq!(places(&shared), [[10.0, 0.0, 0.0], [20.0, 0.0, 0.0]]);
    let all = with_nodes(&nodes, r#"[{"nodes":[3,1,0]}]"#);
    let expected = [
        [0.0, 0.0, 0.0],
        [10.0, 0.0, 0.0],
        [20.0, 9.0, 0.0],
        [10.0, 9.0, 0.0],
    ];
    assert_eq!(places(&all), expected);
    // Copies are the same bytes: they move as one.
    let mut document = read(&all.build());
    let scene = Scene::gather(&document).unwrap();
    assert_eq!(scene.admissible.orbits.len(), 3);
    let moved = vec![DVec3::new(0.0, 0.0, 0.5); scene.mesh.positions.len()];
    scene.scatter(&mut document, &moved).unwrap();
    let positions = scene.positions_in(&document).unwrap();
    assert!(positions.iter().all(|position| position.z == 0.5));
}

/// Some exporters list every node of a scene in it, under parents that move nothing.
#[portable_test]
fn scene_shows_a_child_that_it_lists_too_once_at_each_place() {
    let nodes = [r#"{"mesh":0,"translation":[5,0,0]}"#, r#"{"children":[0]}"#];
    assert_eq!(
        places(&with_nodes(&nodes, r#"[{"nodes":[0,1]}]"#)),
        [[5.0, 0.0, 0.0]]
    );
    assert_eq!(
        places(&with_nodes(&nodes, r#"[{"nodes":[0]}]"#)),
        [[5.0, 0.0, 0.0]]
    );
}

#[portable_test]
fn scene_of_more_ways_than_nodes_may_be_is_refused() {
    let mut nodes = vec![r#"{"mesh":0}"#.to_owned()];
    for level in 0..40 {
        let below = nodes.len() - 1;
        let below = if level == 0 {
            vec![below]
        } else {
            vec![below - 1, below]
        };
        nodes.extend([
            format!(r#"{{"children":{below:?}}}"#),
            format!(r#"{{"children":{below:?},"translation":[0,0,{level}]}}"#),
        ]);
    }
    let nodes: Vec<&str> = nodes.iter().map(String::as_str).collect();
    let built = with_nodes(&nodes, r#"[{"nodes":[79,80]}]"#).build();
    let error = Document::read(&built.bytes, &built.files).err().unwrap();
    assert_eq!(error.code(), "document.too-large");
}

/// A triangle that instances place, with these accessors of floats as attributes.
fn instanced(attributes: &[(&str, &str, &[f32])]) -> GltfBuilder {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.positions(0, Layout::F32, &TRIANGLE);
    builder.mesh(&[primitive(position, None, 4)]);
    let mut named = Vec::new();
    for (name, kind, numbers) in attributes {
        let bytes: Vec<u8> = numbers
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect();
        let offset = builder.push(0, &bytes);
        let view = builder.view(0, offset, bytes.len(), None);
        let count = numbers.len() / if *kind == "VEC4" { 4 } else { 3 };
        let accessor = builder.accessor(format!(
            r#"{{"bufferView":{view},"componentType":5126,"count":{count},"type":"{kind}"}}"#
        ));
        named.push(format!(r#""{name}":{accessor}"#));
    }
    builder.node(&format!(
        r#"{{"mesh":0,"translation":[0,0,1],"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{{}}}}}}}}}"#,
        named.join(",")
    ));
    builder
}

#[portable_test]
fn scene_counts_instances() {
    let moved: &[f32] = &[10.0, 0.0, 0.0, 20.0, 0.0, 0.0, 10.0, 0.0, 0.0];
    let builder = instanced(&[("TRANSLATION", "VEC3", moved)]);
    // The third instance is where the first one is.
    assert_eq!(places(&builder), [[10.0, 0.0, 1.0], [20.0, 0.0, 1.0]]);
    let document = read(&builder.build());
    assert_eq!(
        (document.num_stated_nodes(), document.nodes().len()),
        (1, 3)
    );
    assert_eq!(Scene::gather(&document).unwrap().admissible.orbits.len(), 3);
    let turned: &[f32] = &[0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let scaled: &[f32] = &[2.0, 2.0, 2.0, 1.0, 1.0, 1.0];
    let builder = instanced(&[
        ("ROTATION", "VEC4", turned),
        ("SCALE", "VEC3", scaled),
        ("_ID", "VEC3", &[]),
    ]);
    let pieces = Scene::pieces(&read(&builder.build())).unwrap();
    assert_eq!(pieces[0].1.positions[1], DVec3::new(-2.0, 0.0, 1.0));
    assert_eq!(pieces[1].1.positions[1], DVec3::new(1.0, 0.0, 1.0));
    // What places nothing leaves the mesh where it is.
    assert_eq!(
        places(&instanced(&[("_ID", "VEC3", moved)])),
        [[0.0, 0.0, 1.0]]
    );
}

#[portable_test]
fn scene_with_wrong_instances_is_refused() {
    let two: &[f32] = &[1.0; 6];
    for attributes in [
        [("TRANSLATION", "VEC3", two), ("SCALE", "VEC3", &two[..3])],
        [("TRANSLATION", "VEC3", two), ("ROTATION", "VEC3", two)],
    ] {
        let built = instanced(&attributes).build();
        let error = Document::read(&built.bytes, &built.files).err().unwrap();
        assert_eq!(error.code(), "document.bad-accessor");
    }
    let mut builder = instanced(&[("TRANSLATION", "VEC3", two)]);
    builder.accessors[1] = r#"{"componentType":5126,"count":4000000000,"type":"VEC3"}"#.to_owned();
    let built = builder.build();
    let error = Document::read(&built.bytes, &built.files).err().unwrap();
    assert_eq!(error.code(), "document.too-large");
}

#[portable_test]
fn scene_without_triangles_is_refused() {
    for nodes in [&[][..], &[r#","scale":[0,0,0]"#][..]] {
        let error = Scene::gather(&shown(&TRIANGLE, &[0, 1, 2], nodes)).unwrap_err();
        assert_eq!(error.code(), "scene.no-triangles");
    }
}

#[portable_test]
fn scene_overflowing_transform_is_refused() {
    let error = Scene::gather(&shown(
        &TRIANGLE,
        &[0, 1, 2],
        &[r#","scale":[1e308,1e308,1e308],"translation":[1e308,0,0]"#],
    ));
    assert!(
        error.is_err_and(|error| ["scene.not-finite", "document.bad-json"].contains(&error.code()))
    );
}

/// A small file may show the same bytes so often that the scene would fill the memory.
#[portable_test]
fn scene_too_large_to_hold_is_refused() {
    let points = vec![[0.5; 3]; 60_000];
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.positions(0, Layout::F32, &points);
    let indices = builder.indices(0, Component::U16, &[0, 1, 2]);
    let mesh = builder.mesh(&[primitive(position, Some(indices), 4)]);
    for _ in 0..MAX_ELEMENTS as usize / points.len() + 1 {
        builder.node(&format!(r#"{{"mesh":{mesh}}}"#));
    }
    assert_too_large(&builder, "vertices");
}

/// The scene is refused, for so many of what there are.
fn assert_too_large(builder: &GltfBuilder, expected: &str) {
    let error = Scene::gather(&read(&builder.build())).unwrap_err();
    assert_eq!(error.code(), "scene.too-large");
    let SceneError::TooLarge {
        what, value, limit, ..
    } = error
    else {
        panic!("{error}")
    };
    assert_eq!(what, expected);
    assert!(value > limit);
    let message = error.to_string();
    for word in [what, &value.to_string(), &limit.to_string()] {
        assert!(message.contains(word), "{message}");
    }
}

/// A mesh of three vertices, `num_primitives` times, each with as many of their indices.
fn amplified(num_primitives: usize, num_indices: usize) -> GltfBuilder {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.positions(0, Layout::F32, &TRIANGLE);
    let indices: Vec<u32> = (0..num_indices as u32).map(|place| place % 3).collect();
    let indices = builder.indices(0, Component::U8, &indices);
    builder.mesh(&vec![primitive(position, Some(indices), 4); num_primitives]);
    builder
}

#[portable_test]
fn scene_with_too_many_triangles_is_refused() {
    let times = MAX_TRIANGLES as usize / 10_000 + 1;
    let mut by_nodes = amplified(1, 30_000);
    by_nodes.nodes = vec![r#"{"mesh":0}"#.to_owned(); times];
    assert_too_large(&by_nodes, "triangles");
    let mut by_primitives = amplified(times, 30_000);
    by_primitives.node(r#"{"mesh":0}"#);
    assert_too_large(&by_primitives, "triangles");
    let mut by_both = amplified(100, 30_000);
    by_both.nodes = vec![r#"{"mesh":0}"#.to_owned(); times / 100 + 1];
    assert_too_large(&by_both, "triangles");
}

#[portable_test]
fn scene_with_too_many_parts_is_refused() {
    let mut builder = amplified(1024, 3);
    builder.nodes = vec![r#"{"mesh":0}"#.to_owned(); MAX_PARTS as usize / 1024 + 1];
    assert_too_large(&builder, "mesh parts");
}

/// What is stored nowhere is allowed once, not once for each that shows it.
#[portable_test]
fn scene_with_too_much_that_is_stored_nowhere_is_refused() {
    let count = MAX_UNBACKED / 2;
    let positions = format!(r#"{{"componentType":5126,"count":{count},"type":"VEC3"}}"#);
    let indices = format!(r#"{{"componentType":5125,"count":{count},"type":"SCALAR"}}"#);
    let shown = |accessor: &str, as_indices: bool, num_nodes: usize| {
        let mut builder = GltfBuilder::new(Packing::Glb);
        let points = builder.positions(0, Layout::F32, &TRIANGLE);
        let nothing = builder.accessor(accessor.to_owned());
        let (position, indices) = if as_indices {
            (points, Some(nothing))
        } else {
            (nothing, None)
        };
        builder.mesh(&[primitive(position, indices, 4)]);
        builder.nodes = vec![r#"{"mesh":0}"#.to_owned(); num_nodes];
        builder
    };
    for (accessor, as_indices) in [(&positions, false), (&indices, true)] {
        let twice = shown(accessor, as_indices, 2).build();
        assert_eq!(
            Scene::gather(&read(&twice)).unwrap_err(),
            SceneError::NoTriangles
        );
        let thrice = shown(accessor, as_indices, 3);
        assert_too_large(&thrice, "vertices and indices without data");
    }
}

/// A sparse accessor over nothing is legal, and what it lists is stored.
#[portable_test]
fn scene_of_sparse_positions_over_nothing_is_gathered() {
    let points = [[0.0; 3], TRIANGLE[1], TRIANGLE[2]];
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.sparse_positions(0, Layout::F32, &points, &[1, 2], false);
    let mesh = builder.mesh(&[primitive(position, None, 4)]);
    builder.node(&format!(r#"{{"mesh":{mesh}}}"#));
    let document = read(&builder.build());
    assert_eq!(document.num_unbacked(position), 1);
    let scene = Scene::gather(&document).unwrap();
    assert_eq!(scene.mesh.triangles.len(), 1);
    assert_eq!(scene.admissible.fixed, [0], "what is stored nowhere stays");
}

#[portable_test]
fn scene_counts_are_those_of_the_scene() {
    let document = read(&gallery(Packing::Glb));
    let nodes = document.nodes().iter();
    let count = Count::new(&document, nodes.filter_map(|node| node.mesh)).unwrap();
    let (mut triangles, mut elements, mut parts) = (0, 0, 0);
    for mesh in document.nodes().iter().filter_map(|node| node.mesh) {
        let mut accessors = Vec::new();
        for (index, primitive) in document.meshes()[mesh].primitives.iter().enumerate() {
            let here = document.triangles(mesh, index).unwrap().len();
            assert_eq!(document.num_triangles(mesh, index), here);
            triangles += here as u64;
            if let Some(accessor) = primitive.position.filter(|_| here > 0) {
                parts += 1;
                if !accessors.contains(&accessor) {
                    elements += document.positions(accessor).unwrap().len() as u64;
                    accessors.push(accessor);
                }
            }
        }
    }
    let expected = Count {
        parts,
        elements,
        triangles,
        unbacked: 0,
    };
    assert_eq!(count, expected);
    assert!(parts > 0 && elements > parts && triangles > parts);
}

#[portable_test]
fn scene_counts_are_accepted_up_to_their_limits() {
    let most = Count {
        parts: MAX_PARTS,
        elements: MAX_ELEMENTS,
        triangles: MAX_TRIANGLES,
        unbacked: MAX_UNBACKED,
    };
    assert_eq!(most.check(), Ok(()));
    let beyond = [
        Count {
            parts: MAX_PARTS + 1,
            ..most
        },
        Count {
            elements: MAX_ELEMENTS + 1,
            ..most
        },
        Count {
            triangles: MAX_TRIANGLES + 1,
            ..most
        },
        Count {
            unbacked: MAX_UNBACKED + 1,
            ..most
        },
        Count {
            triangles: u64::MAX,
            ..most
        },
    ];
    for count in beyond {
        assert_eq!(count.check().unwrap_err().code(), "scene.too-large");
    }
}

#[portable_test]
fn scene_gallery_is_gathered_whole() {
    for packing in [Packing::Glb, Packing::DataUri, Packing::External] {
        let scene = Scene::gather(&read(&gallery(packing))).unwrap();
        let (knot, asteroid, skinned, terrain) = (60 * 20, 20 * 30 + 2, 14 * 22 + 2, 21 * 21);
        assert_eq!(
            scene.mesh.positions.len(),
            2 * knot + asteroid + skinned + terrain
        );
        assert_eq!(Edges::new(&scene.mesh).num_components(), 5);
        assert_eq!(scene.admissible.orbits.len(), knot);
        let far = scene.mesh.positions.iter().any(|p| p.length() > 12.0);
        assert!(!far, "a skinned mesh stays where it was modelled");
    }
}

#[portable_test]
fn scene_plain_glb_comes_back() {
    let knot = shapes::torus_knot(12, 6);
    let document = Document::read(&to_glb(&knot), &Default::default()).unwrap();
    let scene = Scene::gather(&document).unwrap();
    assert_eq!(scene.mesh.triangles.len(), knot.triangles.len());
    let Some(low) = scene.mesh.positions.iter().copied().reduce(DVec3::min) else {
        panic!("no positions")
    };
    let expected = knot.positions.iter().copied().reduce(DVec3::min).unwrap();
    assert!(low.distance(expected) < 1e-6);
}
