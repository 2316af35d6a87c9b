//! Models as encoders compress them: for tests, and for benchmarks.

use super::glb::glb;
use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, MeshEncoder,
    PointAttribute,
};
use meshmark::internals::mesh::Mesh;
use meshoptimizer_rs::codec::{
    ExpMode, IndexEncoding, VertexEncoding, encode_filter_exp, encode_index_buffer,
    encode_vertex_buffer,
};
use meshoptimizer_rs::{Limits, Workspace};
use serde_json::{Value, json};

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

/// The component type of the least indices that do, and its bytes.
fn index_type(mesh: &Mesh) -> (u32, usize) {
    if mesh.positions.len() < 65_535 {
        (5123, 2)
    } else {
        (5125, 4)
    }
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
            { "componentType": index_type(mesh).0, "count": 3 * mesh.triangles.len(), "type": "SCALAR" },
        ],
    })
}

pub fn packed(json: &Value, binary: Vec<u8>) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = binary;
    binary.resize(binary.len().next_multiple_of(4), 0);
    glb(&[(*b"JSON", text), (*b"BIN\0", binary)])
}

/// The mesh by Draco, its positions in so many bits.
pub fn by_draco(mesh: &Mesh, speed: i32, bits: i32) -> Vec<u8> {
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
pub fn by_meshopt(mesh: &Mesh, name: &str, version: u8, exponents: Option<ExpMode>) -> Vec<u8> {
    let mut workspace = Workspace::new(Limits::default());
    let (count, indices) = (mesh.positions.len(), mesh.triangles.as_flattened());
    let bytes_of_index = index_type(mesh).1;
    let plain = match exponents {
        None => bytes_of(&floats(mesh)),
        Some(mode) => {
            encode_filter_exp(count, 12, 15, &floats(mesh), mode, &mut workspace).expect("filtered")
        }
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
    let mut of_positions = json!({
        "buffer": 0, "byteOffset": 0, "byteLength": vertices.len(), "byteStride": 12, "count": count, "mode": "ATTRIBUTES",
    });
    if exponents.is_some() {
        of_positions["filter"] = json!("EXPONENTIAL");
    }
    let of_indices = json!({
        "buffer": 0, "byteOffset": start, "byteLength": corners.len(), "byteStride": bytes_of_index, "count": indices.len(), "mode": "TRIANGLES",
    });
    json["bufferViews"] = json!([
        { "buffer": 1, "byteLength": 12 * count, "byteStride": 12, "extensions": { name: of_positions } },
        { "buffer": 1, "byteOffset": 12 * count, "byteLength": bytes_of_index * indices.len(), "extensions": { name: of_indices } },
    ]);
    json["buffers"] = json!([
        { "byteLength": binary.len() },
        { "byteLength": 12 * count + bytes_of_index * indices.len(), "extensions": { name: { "fallback": true } } },
    ]);
    packed(&json, binary)
}
