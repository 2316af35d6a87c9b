//! Generated models, keys and payloads.

use super::gltf_builder::{Built, Component, GltfBuilder, Layout, Packing, primitive};
use glam::DVec3;
use meshmark::internals::geometry::{Bounds, Leeway, Parts};
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::{EmbedOptions, Embedding, Error, Key, Payload, embed};

/// A key by number: 32 bytes without the cost of a passphrase.
pub fn key(number: u8) -> Key {
    Key::from_bytes(&[number; Key::BYTES]).unwrap()
}

pub fn payload() -> Payload {
    Payload::from_tag("ADA-1").unwrap()
}

/// Marks a `.glb` with the defaults.
pub fn marked(model: &[u8], key: &Key) -> Result<Embedding, Error> {
    embed(model, payload(), key, &EmbedOptions::default())
}

/// How far a mesh's vertices may move at the strong strength.
pub fn strong(mesh: &Mesh) -> Leeway<'_> {
    Leeway::new(mesh, &Parts::new(mesh), Bounds::STRONG)
}

pub fn asteroid() -> Mesh {
    shapes::asteroid(40, 60)
}

/// A scene of many kinds of geometry: a mesh shown twice, cut open along a texture seam; normalized 16-bit positions
/// under a scaled node, strided; a skinned mesh with morph targets; a sparse one; a line strip; unknown extras.
pub fn gallery(packing: Packing) -> Built {
    let mut builder = GltfBuilder::new(packing);
    let knot = shapes::torus_knot(60, 20);
    let textured = seamed(&mut builder, &knot);
    let quantized = quantized(&mut builder, &shapes::asteroid(20, 30));
    let (skinned, skin) = skinned(&mut builder, &shapes::asteroid(14, 22));
    let sparse = sparse(&mut builder, &shapes::terrain(20));
    let line = line(&mut builder);
    builder.node(&format!(
        r#"{{"mesh":{textured},"name":"<img src=x onerror=alert(1)>"}}"#
    ));
    builder.node(&format!(r#"{{"mesh":{textured},"translation":[4,0,0.5],"rotation":[0,0,0.6,0.8],"scale":[1.5,1.5,1.5]}}"#));
    builder.node(&format!(r#"{{"mesh":{quantized},"translation":[0,4,0],"scale":[1.2,1.2,1.2],"extras":{{"kept":1.0e0}}}}"#));
    builder.node(&format!(
        r#"{{"mesh":{skinned},"skin":{skin},"translation":[9,9,9]}}"#
    ));
    builder.node(&format!(
        r#"{{"mesh":{sparse},"matrix":[2,0,0,0,0,2,0,0,0,0,2,0,-4,0,0,1]}}"#
    ));
    builder.node(&format!(r#"{{"mesh":{line}}}"#));
    builder.node(r#"{"name":"joint"}"#);
    builder
        .members
        .push(r#""scene":0,"scenes":[{"nodes":[0,1,2,3,4,5,6]}]"#.to_owned());
    builder.members.push(r#""extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"]"#.to_owned());
    builder.build()
}

fn arrays(mesh: &Mesh) -> Vec<[f64; 3]> {
    mesh.positions
        .iter()
        .map(|p| p.as_vec3().as_dvec3().to_array())
        .collect()
}

fn corners(mesh: &Mesh) -> Vec<u32> {
    mesh.triangles.iter().flatten().copied().collect()
}

/// The first 200 triangles have vertices of their own, so that positions along the cut are stored twice.
fn seamed(builder: &mut GltfBuilder, mesh: &Mesh) -> usize {
    let mut points = arrays(mesh);
    let mut indices = corners(mesh);
    for index in &mut indices[..600] {
        points.push(points[*index as usize]);
        *index = points.len() as u32 - 1;
    }
    let position = builder.positions(
        0,
        Layout {
            gap: 8,
            ..Layout::F32
        },
        &points,
    );
    let indices = builder.indices(0, Component::U16, &indices);
    builder.mesh(&[primitive(position, Some(indices), 4)])
}

fn quantized(builder: &mut GltfBuilder, mesh: &Mesh) -> usize {
    let layout = Layout {
        component: Component::I16,
        normalized: true,
        gap: 2,
        bounds: true,
    };
    let points: Vec<[f64; 3]> = mesh
        .positions
        .iter()
        .map(|p| (*p * 28_000.0).round().to_array())
        .collect();
    let position = builder.positions(0, layout, &points);
    let indices = builder.indices(0, Component::U32, &corners(mesh));
    builder.mesh(&[primitive(position, Some(indices), 4)])
}

fn skinned(builder: &mut GltfBuilder, mesh: &Mesh) -> (usize, usize) {
    let position = builder.positions(0, Layout::F32, &arrays(mesh));
    let deltas = builder.positions(
        0,
        Layout::F32,
        &vec![[0.25, 0.0, 0.0]; mesh.positions.len()],
    );
    let joints: Vec<u8> = vec![0; 4 * mesh.positions.len()];
    let offset = builder.push(0, &joints);
    let view = builder.view(0, offset, joints.len(), None);
    let count = mesh.positions.len();
    let joints = builder.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5121,"count":{count},"type":"VEC4"}}"#
    ));
    let weights: Vec<u8> = (0..count)
        .flat_map(|_| [1f32, 0.0, 0.0, 0.0])
        .flat_map(f32::to_le_bytes)
        .collect();
    let offset = builder.push(0, &weights);
    let view = builder.view(0, offset, weights.len(), None);
    let weights = builder.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5126,"count":{count},"type":"VEC4"}}"#
    ));
    let indices = builder.indices(0, Component::U16, &corners(mesh));
    let mesh = builder.mesh(&[format!(
        r#"{{"attributes":{{"POSITION":{position},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}},"indices":{indices},"targets":[{{"POSITION":{deltas}}}]}}"#
    )]);
    builder
        .members
        .push(r#""skins":[{"joints":[6]}]"#.to_owned());
    (mesh, 0)
}

fn sparse(builder: &mut GltfBuilder, mesh: &Mesh) -> usize {
    let replaced: Vec<usize> = (0..mesh.positions.len()).step_by(3).collect();
    let position = builder.sparse_positions(0, Layout::F32, &arrays(mesh), &replaced, true);
    let indices = builder.indices(0, Component::U16, &corners(mesh));
    builder.mesh(&[primitive(position, Some(indices), 4)])
}

fn line(builder: &mut GltfBuilder) -> usize {
    let position = builder.positions(0, Layout::F32, &[[0.0; 3], [1.0; 3], [2.0, 0.0, 1.0]]);
    builder.mesh(&[primitive(position, None, 3)])
}

/// Uniform in [0, 1).
pub fn random(address: u64) -> f64 {
    key(7).prf("test").at(address).0 as f64 / 18_446_744_073_709_551_616.0
}

/// A box of twelve triangles, from the origin on.
pub fn cuboid(sides: DVec3) -> Mesh {
    let corner = |v: u32| {
        let side = |axis: usize| f64::from(v >> axis & 1) * sides[axis];
        DVec3::new(side(0), side(1), side(2))
    };
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect(),
    }
}
