//! A mesh as a plain .glb: for generated models.

use crate::geometry::vertex_normals;
use crate::mesh::Mesh;
use glam::DVec3;

/// A binary glTF file with one node, one mesh with normals, and one material. Positions are rounded to f32.
pub fn to_glb(mesh: &Mesh) -> Vec<u8> {
    let floats = |vectors: &[DVec3]| -> Vec<u8> {
        vectors
            .iter()
            .flat_map(|v| v.as_vec3().to_array())
            .flat_map(f32::to_le_bytes)
            .collect()
    };
    let positions = floats(&mesh.positions);
    // A vertex whose triangles face both ways alike has no normal, and the file needs one.
    let mut normals = vertex_normals(mesh);
    for normal in &mut normals {
        if *normal == DVec3::ZERO {
            *normal = DVec3::Z;
        }
    }
    let normals = floats(&normals);
    let indices: Vec<u8> = mesh
        .triangles
        .iter()
        .flatten()
        .flat_map(|index| index.to_le_bytes())
        .collect();
    let first = mesh.positions.first().copied().unwrap_or_default();
    let low = mesh
        .positions
        .iter()
        .fold(first, |low, p| low.min(*p))
        .as_vec3()
        .to_array();
    let high = mesh
        .positions
        .iter()
        .fold(first, |high, p| high.max(*p))
        .as_vec3()
        .to_array();
    let (vector_bytes, index_bytes) = (positions.len(), indices.len());
    let (num_vertices, num_indices) = (mesh.positions.len(), 3 * mesh.triangles.len());
    let mut json = format!(
        concat!(
            r#"{{"asset":{{"version":"2.0","generator":"meshmark"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"#,
            r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1}},"indices":2,"material":0}}]}}],"#,
            r#""materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.83,0.55,0.38,1],"metallicFactor":0,"roughnessFactor":0.55}}}}],"#,
            r#""accessors":[{{"bufferView":0,"componentType":5126,"count":{v},"type":"VEC3","min":{low:?},"max":{high:?}}},"#,
            r#"{{"bufferView":1,"componentType":5126,"count":{v},"type":"VEC3"}},"#,
            r#"{{"bufferView":2,"componentType":5125,"count":{i},"type":"SCALAR"}}],"#,
            r#""bufferViews":[{{"buffer":0,"byteLength":{vb},"target":34962}},"#,
            r#"{{"buffer":0,"byteOffset":{vb},"byteLength":{vb},"target":34962}},"#,
            r#"{{"buffer":0,"byteOffset":{io},"byteLength":{ib},"target":34963}}],"buffers":[{{"byteLength":{total}}}]}}"#
        ),
        v = num_vertices,
        i = num_indices,
        vb = vector_bytes,
        io = 2 * vector_bytes,
        ib = index_bytes,
        total = 2 * vector_bytes + index_bytes,
        low = low,
        high = high,
    )
    .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let binary = [positions, normals, indices].concat();
    let length = |bytes: usize| (bytes as u32).to_le_bytes();
    [
        b"glTF",
        2u32.to_le_bytes().as_slice(),
        &length(12 + 8 + json.len() + 8 + binary.len()),
        &length(json.len()),
        b"JSON",
        &json,
        &length(binary.len()),
        b"BIN\0",
        &binary,
    ]
    .concat()
}
