//! The command line with little memory: files that ask for more than they are worth, and geometry that is no shape at all. Each
//! ends with a report or with an error that has a code.
#![cfg(all(unix, not(target_arch = "wasm32")))]
#![allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should

#[path = "../../tests/suite/support"]
mod support {
    pub mod glb;
    #[allow(dead_code)] // a part of it is enough here
    pub mod gltf_builder;
}

use glam::DVec3;
use meshmark::internals::document::MAX_UNBACKED;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::to_glb;
use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use support::gltf_builder::{Component, GltfBuilder, Layout, Packing, primitive};

/// Address space of a run, in KiB: 1 GiB. Without limits the files below take from 2 to 10 GiB.
const MEMORY: u32 = 1 << 20;

/// All that can be done to a model.
const ENTRIES: [&str; 7] = [
    "inspect model.glb",
    "measure model.glb evidence.mmev",
    "extract model.glb --key-file key",
    "verify model.glb --key-file key --tag A",
    "embed model.glb marked.glb --key-file key --tag A",
    "note read model.glb --key-file key",
    "note embed model.glb -o noted.glb --key-file key --text A",
];

/// A folder of its own for one test, gone with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let name = format!("meshmark-limits-{name}-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        fs::write(path.join("key"), [5; 32]).unwrap();
        Folder(path)
    }

    fn with(name: &str, model: &[u8]) -> Folder {
        let folder = Folder::new(name);
        fs::write(folder.0.join("model.glb"), model).unwrap();
        folder
    }

    /// Runs `meshmark` here with little memory. Whatever it is given, it answers: the report.
    fn run(&self, arguments: &str) -> Value {
        let mut command = Command::new("sh");
        command
            .args(["-c", &format!("ulimit -v {MEMORY}; exec \"$0\" \"$@\"")])
            .arg(env!("CARGO_BIN_EXE_meshmark"))
            .args(arguments.split_whitespace())
            .current_dir(&self.0)
            .stdin(Stdio::null());
        let output = command.output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        let code = output.status.code();
        assert!(
            matches!(code, Some(0..=2)),
            "{arguments}: {:?} {said}",
            output.status
        );
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        let error = &report["error"];
        let is_typed = error["code"].as_str().is_some_and(|code| code != "io");
        assert!(error.is_null() || is_typed, "{arguments}: {report}");
        report
    }

    /// Every entry refuses the model with this code.
    fn refuses(&self, code: &str) {
        for entry in ENTRIES {
            let report = self.run(entry);
            assert_eq!(report["error"]["code"], code, "{entry}: {report}");
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).unwrap();
    }
}

/// 250 vertices and 30 000 triangles, by as many primitives and nodes.
fn amplified(num_primitives: usize, num_nodes: usize) -> Vec<u8> {
    let points: Vec<[f64; 3]> = (0..250)
        .map(|i| [f64::from(i % 7), f64::from(i % 11), f64::from(i)])
        .collect();
    let corners: Vec<u32> = (0..30_000_u32)
        .flat_map(|i| [i % 250, (i + 1 + i / 250) % 250, (i + 127) % 250])
        .collect();
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.positions(0, Layout::F32, &points);
    let indices = builder.indices(0, Component::U8, &corners);
    builder.mesh(&vec![primitive(position, Some(indices), 4); num_primitives]);
    builder.nodes = vec![r#"{"mesh":0}"#.to_owned(); num_nodes];
    builder.build().bytes
}

#[test]
fn triangles_shown_many_times_are_refused() {
    Folder::with("nodes", &amplified(1, 2000)).refuses("scene.too-large");
    Folder::with("primitives", &amplified(2000, 1)).refuses("scene.too-large");
    Folder::with("both", &amplified(1000, 100_000)).refuses("scene.too-large");
}

#[test]
fn elements_without_data_are_refused() {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.positions(0, Layout::F32, &[[0.0; 3]; 250]);
    let indices = builder.accessor(format!(
        r#"{{"componentType":5125,"count":{MAX_UNBACKED},"type":"SCALAR"}}"#
    ));
    builder.mesh(&vec![primitive(position, Some(indices), 4); 1000]);
    builder.node(r#"{"mesh":0}"#);
    Folder::with("indices", &builder.build().bytes).refuses("scene.too-large");

    let mut builder = GltfBuilder::new(Packing::Glb);
    let accessor = format!(r#"{{"componentType":5126,"count":{MAX_UNBACKED},"type":"VEC3"}}"#);
    let positions = (0..1000).map(|_| builder.accessor(accessor.clone()));
    let primitives: Vec<String> = positions
        .map(|position| primitive(position, None, 4))
        .collect();
    builder.mesh(&primitives);
    builder.node(r#"{"mesh":0}"#);
    Folder::with("vertices", &builder.build().bytes).refuses("document.too-large");
}

/// The same bytes, as positions of a thousand accessors that no two share: each would be compared with all others.
#[test]
fn positions_of_the_same_bytes_are_refused() {
    let mut builder = GltfBuilder::new(Packing::Glb);
    builder.push(0, &vec![0; 1_000_000]);
    builder.view(0, 0, 1_000_000, None);
    let accessor = |number: usize| {
        let offset = 4 * number;
        format!(
            r#"{{"bufferView":0,"byteOffset":{offset},"componentType":5126,"count":60000,"type":"VEC3"}}"#
        )
    };
    let positions = (0..1000).map(|number| builder.accessor(accessor(number)));
    let primitives: Vec<String> = positions
        .map(|position| primitive(position, None, 4))
        .collect();
    builder.mesh(&primitives);
    builder.node(r#"{"mesh":0}"#);
    Folder::with("shared", &builder.build().bytes).refuses("document.too-large");
}

/// A mesh with no triangles in any of its parts costs nothing, however often it is shown.
#[test]
fn parts_without_triangles_are_passed_over() {
    let mut builder = GltfBuilder::new(Packing::Glb);
    let position = builder.positions(0, Layout::F32, &[[0.0; 3], [1.0; 3]]);
    builder.mesh(&vec![primitive(position, None, 4); 20_000]);
    builder.nodes = vec![r#"{"mesh":0}"#.to_owned(); 100_000];
    let folder = Folder::with("empty", &builder.build().bytes);
    let report = folder.run("inspect model.glb");
    assert_eq!(report["error"]["code"], "scene.no-triangles");
}

/// Of one file there is one copy, whatever it is called.
#[test]
fn a_buffer_is_loaded_once() {
    let folder = Folder::new("buffers");
    fs::write(folder.0.join("a.bin"), vec![0; 4 << 20]).unwrap();
    let gltf = |names: &[String]| {
        let buffers: Vec<String> = names
            .iter()
            .map(|name| format!(r#"{{"byteLength":4,"uri":"{name}"}}"#))
            .collect();
        let buffers = buffers.join(",");
        let json = format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{buffers}]}}"#);
        fs::write(folder.0.join("model.gltf"), json).unwrap();
    };
    let escaped = ["a.bin", "%61.bin", "a%2Ebin"].map(str::to_owned);
    let escaped: Vec<String> = escaped.into_iter().cycle().take(1000).collect();
    gltf(&escaped);
    let report = folder.run("inspect model.gltf");
    assert_eq!(report["error"]["code"], "scene.no-triangles");
    let dotted: Vec<String> = (0..1000).map(|dots| "./".repeat(dots) + "a.bin").collect();
    gltf(&dotted);
    let output = Command::new(env!("CARGO_BIN_EXE_meshmark"))
        .args(["inspect", "model.gltf"])
        .current_dir(&folder.0)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("the same file"), "{said}");
}

/// A model as people have it.
fn pebble() -> Mesh {
    shapes::asteroid(40, 60)
}

/// Triangles that share no vertex.
fn loose(triangles: impl Iterator<Item = [[f32; 3]; 3]>) -> Mesh {
    let positions: Vec<_> = triangles
        .flatten()
        .map(|point| DVec3::from_array(point.map(f64::from)))
        .collect();
    let corners: Vec<u32> = (0..positions.len() as u32).collect();
    Mesh {
        triangles: corners.as_chunks().0.to_vec(),
        positions,
    }
}

/// Every entry answers, of the mesh and of the mesh beside a model.
fn answers(name: &str, mesh: Mesh, entries: &[&str]) {
    let beside = Mesh::joined([pebble(), mesh.clone()]);
    for (kind, mesh) in [("alone", mesh), ("beside", beside)] {
        let folder = Folder::with(&format!("{name}-{kind}"), &to_glb(&mesh));
        for entry in entries {
            folder.run(entry);
        }
    }
}

#[test]
fn vertices_at_one_point_are_answered() {
    let point = [[0.5, 0.25, -0.5]; 3];
    answers(
        "point",
        loose(std::iter::repeat_n(point, 1 << 16)),
        &ENTRIES,
    );
}

#[test]
fn a_triangle_far_beyond_the_model_is_answered() {
    let needle = [[0.0; 3], [1e6, 0.0, 0.0], [0.0, 1.0, 0.0]];
    answers("needle", loose([needle].into_iter()), &ENTRIES);
}

#[test]
fn the_smallest_and_the_largest_numbers_are_answered() {
    for (name, scale) in [("small", 1e-42), ("large", 1e38)] {
        let positions = pebble().positions.iter().map(|p| *p * scale).collect();
        let folder = Folder::with(name, &to_glb(&pebble().with_positions(positions)));
        ENTRIES.iter().for_each(|entry| {
            folder.run(entry);
        });
    }
}

/// Points on a circle.
fn rim(count: u32, height: fn(u32) -> f64) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |k| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(count);
        DVec3::new(libm::cos(angle), libm::sin(angle), height(k))
    })
}

#[test]
#[ignore = "takes a minute: cargo xtask test --all"]
fn triangles_about_one_vertex_are_answered() {
    // More than simplification goes through at each change of the vertex.
    let count = 65_000;
    let rough = |k| f64::from(k * 37 % 101) / 1e4;
    let fan = Mesh {
        positions: [DVec3::Z * 0.3]
            .into_iter()
            .chain(rim(count, rough))
            .collect(),
        triangles: (0..count)
            .map(|k| [0, 1 + k, 1 + (k + 1) % count])
            .collect(),
    };
    answers("fan", fan, &ENTRIES);
}

#[test]
fn triangles_on_one_edge_are_answered() {
    let edge = Mesh {
        positions: [DVec3::ZERO, DVec3::Z]
            .into_iter()
            .chain(rim(1000, |_| 0.5))
            .collect(),
        triangles: (0..1000).map(|k| [0, 1, 2 + k]).collect(),
    };
    answers("edge", edge, &ENTRIES);
}

#[test]
fn triangles_without_neighbours_are_answered() {
    let tiny = |k: u32| {
        let [x, y, z] = [k % 31, k / 31 % 29, k / 899].map(|n| n as f32 / 30.0);
        [[x, y, z], [x + 1e-3, y, z], [x, y + 1e-3, z + 1e-3]]
    };
    answers("tiny", loose((0..8000).map(tiny)), &ENTRIES);
}

/// Balls at some places, and a speck at each corner of a cube around them.
fn balls_and_specks(radius: f64, places: &[[f64; 3]], corner: f64) -> Mesh {
    let put = |part: &Mesh, size: f64, place: DVec3| {
        part.with_positions(part.positions.iter().map(|p| *p * size + place).collect())
    };
    let (ball, speck) = (
        shapes::icosphere(2),
        shapes::cuboid(DVec3::splat(0.01), [1; 3]),
    );
    let balls = places.iter().map(|&place| put(&ball, radius, place.into()));
    let corners = (0..8).map(|k| [0, 1, 2].map(|axis| f64::from(k >> axis & 1) * 2.0 - 1.0));
    let specks = corners.map(|place| put(&speck, 1.0, DVec3::from_array(place) * corner));
    Mesh::joined(balls.chain(specks))
}

const TETRAHEDRON: [[f64; 3]; 4] = [
    [1.0, 1.0, 1.0],
    [1.0, -1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
];

/// The same on a ball of radius 1.
fn within_a_ball(corners: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let place = |corner: &[f64; 3]| corner.map(|x| x * 0.5774);
    corners.iter().map(place).collect()
}

fn check_finds_nothing(name: &str, mesh: &Mesh) {
    let folder = Folder::with(name, &to_glb(mesh));
    let report = folder.run("extract model.glb --key-file key");
    assert_eq!(report["verdict"], "none", "{report}");
}

/// The tables of a scan once covered all that lies between the specks.
#[test]
fn specks_far_from_what_is_read_are_answered() {
    let balls = balls_and_specks(0.25, &within_a_ball(&TETRAHEDRON), 3.5);
    check_finds_nothing("tetrahedron", &balls);
}

#[test]
#[ignore = "takes a minute: cargo xtask test --all"]
fn specks_far_from_eight_balls_are_answered() {
    let corner = |k: usize| [0, 1, 2].map(|axis| (k >> axis & 1) as f64 * 2.0 - 1.0);
    let cube: Vec<[f64; 3]> = (0..8).map(corner).collect();
    let balls = balls_and_specks(0.19, &within_a_ball(&cube), 3.5);
    check_finds_nothing("cube", &balls);
}

/// Needles without an area meet clusters everywhere between balls whose frame has no axes: of all that was tried, what makes a check work
/// most.
#[test]
#[ignore = "takes a minute: cargo xtask test --all"]
fn needles_among_balls_are_answered() {
    // Multiples of irrational numbers fill a cube evenly.
    let point = |k: u32| {
        let within = |turns: f64| (f64::from(k) * turns).fract() * 2.4 - 1.2;
        [within(0.8192), within(0.6710), within(0.5497)].map(|x| x as f32)
    };
    let needles = loose((0..500).map(|k| {
        let [a, b] = [2 * k, 2 * k + 1].map(point);
        [a, b, [b[0] + 1e-4, b[1], b[2] + 1e-4]]
    }));
    let balls = balls_and_specks(0.27, &within_a_ball(&TETRAHEDRON), 1.2);
    check_finds_nothing("needles", &Mesh::joined([balls, needles]));
}
