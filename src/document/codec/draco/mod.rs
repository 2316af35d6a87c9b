//! Primitives that Draco holds.

mod again;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use draco_core::{
    DataType, DecodeLimits, DecoderBuffer, FaceIndex, Mesh, MeshDecoder, PointAttribute, PointIndex,
};
use serde_json::{Value, json};

use super::super::DocumentError;
use super::repack::Repacking;
use super::streams::{Host, Plain, Segment, Streams};
use super::{damaged, list, take_extension, whole};

const NAME: &str = "KHR_draco_mesh_compression";

pub(super) const NAMES: &[&str] = &[NAME];

/// Whether any primitive is compressed.
pub(super) fn is_used(root: &Value) -> bool {
    let primitives = list(root, "meshes")
        .iter()
        .flat_map(|mesh| list(mesh, "primitives"));
    let mut extensions = primitives.filter_map(|primitive| primitive.get("extensions")?.get(NAME));
    extensions.next().is_some()
}

/// What a primitive states of its stream.
struct Stated {
    pointer: String,
    view: usize,
    /// The accessor of each attribute, and its number in the stream.
    attributes: Vec<(String, usize, u32)>,
    indices: Option<usize>,
}

/// Decodes every compressed primitive.
pub(super) fn decode(root: &mut Value, repacking: &mut Repacking) -> Result<(), DocumentError> {
    let mut known: BTreeMap<usize, Mesh> = BTreeMap::new();
    // Which stream filled each accessor.
    let mut filled: BTreeMap<usize, usize> = BTreeMap::new();
    let num_meshes = list(root, "meshes").len();
    for mesh in 0..num_meshes {
        let num_primitives = list(root, "meshes")
            .get(mesh)
            .map_or(0, |mesh| list(mesh, "primitives").len());
        for part in 0..num_primitives {
            let place = format!("/meshes/{mesh}/primitives/{part}");
            let Some(stated) = stated(root, &place)? else {
                continue;
            };
            let mesh = match known.entry(stated.view) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(slot) => slot.insert(decoded(root, &stated, repacking)?),
            };
            place_primitive(root, &place, &stated, mesh, &mut filled, repacking)?;
        }
    }
    Ok(())
}

/// Takes the extension out of a primitive.
fn stated(root: &mut Value, place: &str) -> Result<Option<Stated>, DocumentError> {
    let Some(primitive) = root.pointer_mut(place) else {
        return Ok(None);
    };
    let Some(extension) = take_extension(primitive, NAME) else {
        return Ok(None);
    };
    let pointer = format!("{place}/extensions/{NAME}");
    let view = whole(&extension, "bufferView")
        .ok_or_else(|| damaged(&pointer, "it names no buffer view"))?;
    let mut attributes = Vec::new();
    for (name, number) in extension
        .get("attributes")
        .and_then(Value::as_object)
        .into_iter()
        .flatten()
    {
        let number = number
            .as_u64()
            .and_then(|number| u32::try_from(number).ok());
        let number =
            number.ok_or_else(|| damaged(&pointer, format!("the number of {name} is none")))?;
        let accessor = primitive
            .get("attributes")
            .and_then(|attributes| whole(attributes, name));
        let accessor =
            accessor.ok_or_else(|| damaged(&pointer, format!("the primitive has no {name}")))?;
        attributes.push((name.clone(), accessor, number));
    }
    Ok(Some(Stated {
        pointer,
        view,
        attributes,
        indices: whole(primitive, "indices"),
    }))
}

fn decoded(
    root: &Value,
    stated: &Stated,
    repacking: &mut Repacking,
) -> Result<Mesh, DocumentError> {
    let view = list(root, "bufferViews").get(stated.view);
    let view = view.ok_or_else(|| damaged(&stated.pointer, "its buffer view is not there"))?;
    let bytes = repacking.range(view, &stated.pointer)?;
    let most = repacking.left() as u64;
    let limits = DecodeLimits::default()
        .with_max_points(most / 4)
        .with_max_faces(most / 12)
        .with_max_decoded_bytes(most);
    let mut mesh = Mesh::new();
    let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
    let status = MeshDecoder::new().decode(&mut buffer, &mut mesh);
    status.map_err(|error| damaged(&stated.pointer, error))?;
    if mesh.num_faces() == 0 {
        return Err(damaged(&stated.pointer, "it holds no triangles"));
    }
    Ok(mesh)
}

/// Gives a primitive's accessors what was decoded.
fn place_primitive(
    root: &mut Value,
    place: &str,
    stated: &Stated,
    mesh: &Mesh,
    filled: &mut BTreeMap<usize, usize>,
    repacking: &mut Repacking,
) -> Result<(), DocumentError> {
    for (name, accessor, number) in &stated.attributes {
        let attribute = mesh.attribute_by_unique_id(*number);
        let attribute =
            attribute.ok_or_else(|| damaged(&stated.pointer, format!("it holds no {name}")))?;
        let accessor = own(root, *accessor, stated.view, filled);
        let Some(accessor) = accessor else { continue };
        let values = values(
            root,
            accessor,
            attribute,
            mesh.num_points(),
            repacking,
            &stated.pointer,
        )?;
        let vertices = Content {
            bytes: values.bytes,
            count: mesh.num_points(),
            stride: Some(values.stride),
        };
        fill(root, accessor, vertices, stated.view, repacking);
        set(root, &format!("{place}/attributes"), name, json!(accessor));
    }
    let accessor = match stated.indices {
        Some(accessor) => own(root, accessor, stated.view, filled),
        None => Some(add_accessor(
            root,
            json!({ "componentType": 5125, "type": "SCALAR" }),
        )),
    };
    if let Some(accessor) = accessor {
        let bytes = indices(root, accessor, mesh, repacking, &stated.pointer)?;
        let corners = Content {
            bytes,
            count: mesh.num_faces().saturating_mul(3),
            stride: None,
        };
        fill(root, accessor, corners, stated.view, repacking);
        set(root, place, "indices", json!(accessor));
    }
    // The stream has triangles, whatever they were once.
    set(root, place, "mode", json!(4));
    Ok(())
}

/// The accessor to fill for a stream: this one, or a copy if another stream has filled it; `None` if this one did.
fn own(
    root: &mut Value,
    accessor: usize,
    view: usize,
    filled: &mut BTreeMap<usize, usize>,
) -> Option<usize> {
    match filled.get(&accessor) {
        None => {
            filled.insert(accessor, view);
            Some(accessor)
        }
        Some(&by) if by == view => None,
        Some(_) => {
            let copy = list(root, "accessors")
                .get(accessor)
                .cloned()
                .unwrap_or_default();
            Some(add_accessor(root, copy))
        }
    }
}

fn add_accessor(root: &mut Value, accessor: Value) -> usize {
    let Some(accessors) = root.get_mut("accessors").and_then(Value::as_array_mut) else {
        return usize::MAX;
    };
    accessors.push(accessor);
    accessors.len().saturating_sub(1)
}

fn set(root: &mut Value, place: &str, name: &str, value: Value) {
    if let Some(Value::Object(members)) = root.pointer_mut(place) {
        members.insert(name.to_owned(), value);
    }
}

/// What an accessor is filled with.
struct Content {
    bytes: Vec<u8>,
    count: usize,
    /// Of vertices.
    stride: Option<usize>,
}

/// Gives an accessor a view with its content: the stream's own for the first.
fn fill(
    root: &mut Value,
    accessor: usize,
    content: Content,
    view: usize,
    repacking: &mut Repacking,
) {
    let view = if repacking.is_replaced(view) {
        repacking.add(content.bytes)
    } else {
        repacking.replace(view, content.bytes);
        view
    };
    if let Some(Value::Array(views)) = root.get_mut("bufferViews") {
        if views.len() <= view {
            views.resize_with(view.saturating_add(1), || json!({}));
        }
        if let Some(Value::Object(members)) = views.get_mut(view) {
            let target = if content.stride.is_some() {
                34962
            } else {
                34963
            };
            members.insert("target".into(), json!(target));
            if let Some(stride) = content.stride {
                members.insert("byteStride".into(), json!(stride));
            }
        }
    }
    let place = format!("/accessors/{accessor}");
    if let Some(Value::Object(members)) = root.pointer_mut(&place) {
        members.shift_remove("byteOffset");
        members.shift_remove("sparse");
    }
    set(root, &place, "bufferView", json!(view));
    set(root, &place, "count", json!(content.count));
}

struct Values {
    bytes: Vec<u8>,
    stride: usize,
}

/// The values of an attribute at all points, as the accessor wants them: its number type, each at a multiple of four bytes.
fn values(
    root: &Value,
    accessor: usize,
    attribute: &PointAttribute,
    num_points: usize,
    repacking: &mut Repacking,
    pointer: &str,
) -> Result<Values, DocumentError> {
    let accessor = list(root, "accessors").get(accessor);
    let accessor = accessor.ok_or_else(|| damaged(pointer, "an accessor is not there"))?;
    let (kind, component) = (
        accessor.get("type").and_then(Value::as_str),
        whole(accessor, "componentType"),
    );
    let num_components: usize = match kind {
        Some("SCALAR") => 1,
        Some("VEC2") => 2,
        Some("VEC3") => 3,
        Some("VEC4") => 4,
        _ => return Err(damaged(pointer, "an attribute's type is none of vectors")),
    };
    if usize::from(attribute.num_components()) != num_components {
        return Err(damaged(
            pointer,
            "an attribute has another number of components than its accessor",
        ));
    }
    let size = component_size(component)
        .ok_or_else(|| damaged(pointer, "an attribute's number type is unknown"))?;
    let stride = size.saturating_mul(num_components).next_multiple_of(4);
    repacking.reserve(num_points.checked_mul(stride), pointer)?;
    let mut bytes = Vec::with_capacity(num_points.saturating_mul(stride));
    let data = attribute.buffer().data();
    let (from, from_size) = number_type(attribute.data_type())
        .ok_or_else(|| damaged(pointer, "an attribute's numbers are of an unknown type"))?;
    let step = from_size.saturating_mul(num_components);
    let is_same = component == Some(from);
    for point in 0..num_points {
        let index = u32::try_from(point).unwrap_or(u32::MAX);
        let place = attribute.mapped_index(PointIndex(index)).0 as usize;
        let value = data
            .get(place.saturating_mul(step)..)
            .and_then(|rest| rest.get(..step));
        let value = value.ok_or_else(|| damaged(pointer, "a point has no value"))?;
        if is_same {
            bytes.extend_from_slice(value);
        } else {
            for number in value.chunks(from_size) {
                put(
                    read(from, number).unwrap_or_default(),
                    component,
                    &mut bytes,
                );
            }
        }
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    Ok(Values { bytes, stride })
}

/// The corners of the triangles, in the accessor's number type, or a wider one if that is too narrow.
fn indices(
    root: &mut Value,
    accessor: usize,
    mesh: &Mesh,
    repacking: &mut Repacking,
    pointer: &str,
) -> Result<Vec<u8>, DocumentError> {
    let place = format!("/accessors/{accessor}");
    let stated = root
        .pointer(&place)
        .and_then(|accessor| whole(accessor, "componentType"));
    // The largest value of a type is no index.
    let component = match stated {
        Some(5121) if mesh.num_points() <= 255 => 5121,
        Some(5121 | 5123) if mesh.num_points() <= 65_535 => 5123,
        _ => 5125,
    };
    set(root, &place, "componentType", json!(component));
    let size = component_size(Some(component)).unwrap_or(4);
    let count = mesh.num_faces().saturating_mul(3);
    repacking.reserve(count.checked_mul(size), pointer)?;
    let mut bytes = Vec::with_capacity(count.saturating_mul(size));
    for face in 0..mesh.num_faces() {
        let face = FaceIndex(u32::try_from(face).unwrap_or(u32::MAX));
        for corner in mesh.face(face) {
            if corner.0 as usize >= mesh.num_points() {
                return Err(damaged(pointer, "a triangle's corner is no point"));
            }
            put(f64::from(corner.0), Some(component), &mut bytes);
        }
    }
    Ok(bytes)
}

fn component_size(component: Option<usize>) -> Option<usize> {
    Some(match component? {
        5120 | 5121 => 1,
        5122 | 5123 => 2,
        5125 | 5126 => 4,
        _ => return None,
    })
}

/// glTF's code of a number type, and its size in bytes.
fn number_type(data: DataType) -> Option<(usize, usize)> {
    Some(match data {
        DataType::Int8 => (5120, 1),
        DataType::Uint8 => (5121, 1),
        DataType::Int16 => (5122, 2),
        DataType::Uint16 => (5123, 2),
        DataType::Uint32 => (5125, 4),
        DataType::Float32 => (5126, 4),
        _ => return None,
    })
}

fn read(component: usize, bytes: &[u8]) -> Option<f64> {
    Some(match component {
        5120 => f64::from(i8::from_le_bytes(*bytes.first_chunk()?)),
        5121 => f64::from(*bytes.first()?),
        5122 => f64::from(i16::from_le_bytes(*bytes.first_chunk()?)),
        5123 => f64::from(u16::from_le_bytes(*bytes.first_chunk()?)),
        5125 => f64::from(u32::from_le_bytes(*bytes.first_chunk()?)),
        _ => f64::from(f32::from_le_bytes(*bytes.first_chunk()?)),
    })
}

/// Appends a number; casts saturate.
fn put(number: f64, component: Option<usize>, bytes: &mut Vec<u8>) {
    match component {
        Some(5120) => bytes.extend((number as i8).to_le_bytes()),
        Some(5121) => bytes.push(number as u8),
        Some(5122) => bytes.extend((number as i16).to_le_bytes()),
        Some(5123) => bytes.extend((number as u16).to_le_bytes()),
        Some(5125) => bytes.extend((number as u32).to_le_bytes()),
        _ => bytes.extend((number as f32).to_le_bytes()),
    }
}

/// Whether a view holds a stream.
pub(super) fn is_packed(root: &Value, view: usize) -> bool {
    primitives(root).any(|(_, extension)| whole(extension, "bufferView") == Some(view))
}

/// The compressed primitives, with their extensions.
fn primitives(root: &Value) -> impl Iterator<Item = (&Value, &Value)> {
    let primitives = list(root, "meshes")
        .iter()
        .flat_map(|mesh| list(mesh, "primitives"));
    primitives.filter_map(|primitive| Some((primitive, primitive.get("extensions")?.get(NAME)?)))
}

/// Encodes the primitives whose positions changed, with the method, the effort and the bits that they had; in sequence where something
/// uncompressed follows the order of their vertices. Whether that could be done: not where primitives share a stream or its accessors.
pub(super) fn encode(
    root: &Value,
    plain_root: &Value,
    plain: &Plain,
    host: &Host,
    streams: &mut Streams,
) -> bool {
    let mut todo: Vec<(Segment, &Value, &Value, &[u8])> = Vec::new();
    for (primitive, extension) in primitives(root) {
        let position = primitive
            .get("attributes")
            .and_then(|attributes| whole(attributes, "POSITION"));
        let accessor = position.and_then(|position| list(plain_root, "accessors").get(position));
        let view = accessor.and_then(|accessor| whole(accessor, "bufferView"));
        let Some(bytes) = view.and_then(|view| plain.changed(view)) else {
            continue;
        };
        let stream = whole(extension, "bufferView")
            .and_then(|view| Segment::of(list(root, "bufferViews").get(view)?));
        match stream {
            Some(stream) if is_alone(root, primitive, extension) => {
                todo.push((stream, primitive, extension, bytes))
            }
            _ => return false,
        }
    }
    let jobs: Option<Vec<again::Job>> = todo
        .iter()
        .map(|&(stream, primitive, extension, bytes)| {
            let job = again::Job::new(host.segment(root, stream)?, extension, bytes)?;
            Some(job.in_order(has_companions(primitive, extension)))
        })
        .collect();
    let Some(jobs) = jobs else { return false };
    // Few distinct values fit a coarse grid too: the bits of the finest one are what the file was made with.
    let bits = jobs.iter().map(|job| job.position_bits).max().unwrap_or(0);
    for (job, (stream, ..)) in jobs.into_iter().zip(&todo) {
        match job.encoded(bits) {
            Some(encoded) => _ = streams.insert(*stream, encoded),
            None => return false,
        }
    }
    true
}

/// Whether the order of a primitive's vertices is that of something beside its stream: of attributes, or of morph targets.
fn has_companions(primitive: &Value, extension: &Value) -> bool {
    let count = |object: &Value| {
        object
            .get("attributes")
            .and_then(Value::as_object)
            .map_or(0, serde_json::Map::len)
    };
    count(primitive) != count(extension) || primitive.get("targets").is_some()
}

/// Whether a stream and its accessors serve one primitive.
fn is_alone(root: &Value, primitive: &Value, extension: &Value) -> bool {
    let accessors = |primitive: &Value| -> Vec<u64> {
        let attributes = primitive.get("attributes").and_then(Value::as_object);
        let attributes = attributes
            .into_iter()
            .flat_map(serde_json::Map::values)
            .chain(primitive.get("indices"));
        attributes.filter_map(Value::as_u64).collect()
    };
    let own = accessors(primitive);
    let all = list(root, "meshes")
        .iter()
        .flat_map(|mesh| list(mesh, "primitives"));
    let uses = all
        .flat_map(accessors)
        .filter(|accessor| own.contains(accessor))
        .count();
    let view = extension.get("bufferView");
    let streams = primitives(root)
        .filter(|(_, other)| other.get("bufferView") == view)
        .count();
    uses == own.len() && streams == 1
}
