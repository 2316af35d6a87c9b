//! Buffer views that meshoptimizer's codecs hold.

use meshoptimizer_rs::codec::{
    ExpMode, Filter, Mode, VertexEncoding, decode_filter_color, decode_filter_exp,
    decode_filter_oct, decode_filter_quat, decode_index_buffer, decode_index_sequence,
    decode_vertex_buffer, decode_vertex_version, encode_filter_exp, encode_vertex_buffer,
};
use meshoptimizer_rs::{Limits, Workspace};
use serde_json::Value;
use serde_json::value::RawValue;

use super::super::DocumentError;
use super::repack::Repacking;
use super::streams::{Host, Plain, Segment, Streams};
use super::{damaged, list, take_extension, whole};

/// The extension under the names that it has had.
pub(super) const NAMES: &[&str] = &[
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "MESHOPT_compression",
];

/// Whether any view is compressed.
pub(super) fn is_used(root: &Value) -> bool {
    list(root, "bufferViews")
        .iter()
        .any(|view| extension(view).is_some())
}

fn extension(object: &Value) -> Option<(&'static str, &Value)> {
    let extensions = object.get("extensions")?;
    NAMES
        .iter()
        .find_map(|name| Some((*name, extensions.get(name)?)))
}

/// Decodes every compressed view.
pub(super) fn decode(root: &mut Value, repacking: &mut Repacking) -> Result<(), DocumentError> {
    let Some(Value::Array(views)) = root.get_mut("bufferViews") else {
        return Ok(());
    };
    for (index, view) in views.iter_mut().enumerate() {
        let Some(name) = extension(view).map(|(name, _)| name) else {
            continue;
        };
        let pointer = format!("/bufferViews/{index}/extensions/{name}");
        let Some(stream) = take_extension(view, name) else {
            continue;
        };
        let bytes = decoded(&stream, repacking, &pointer)?;
        if whole(view, "byteLength") != Some(bytes.len()) {
            return Err(damaged(
                &pointer,
                "the view has another length than its compressed data",
            ));
        }
        repacking.replace(index, bytes);
    }
    Ok(())
}

/// The bytes that a stream holds.
fn decoded(
    stream: &Value,
    repacking: &mut Repacking,
    pointer: &str,
) -> Result<Vec<u8>, DocumentError> {
    let member = |name: &str| {
        whole(stream, name)
            .ok_or_else(|| damaged(pointer, format!("\"{name}\" is no whole number")))
    };
    let (count, stride) = (member("count")?, member("byteStride")?);
    repacking.reserve(count.checked_mul(stride), pointer)?;
    let source = repacking.range(stream, pointer)?;
    let mut workspace = Workspace::new(Limits {
        max_bytes: super::MAX_BYTES,
        ..Limits::default()
    });
    let word = |name: &str| stream.get(name).and_then(Value::as_str);
    let mode = Mode::parse(word("mode").unwrap_or_default())
        .map_err(|_| damaged(pointer, "its mode is unknown"))?;
    let decode = match mode {
        Mode::Attributes => decode_vertex_buffer,
        Mode::Triangles => decode_index_buffer,
        Mode::Indices => decode_index_sequence,
    };
    let failed = |error: meshoptimizer_rs::Error| damaged(pointer, format!("{error:?}"));
    let mut bytes = decode(count, stride, source, &mut workspace).map_err(failed)?;
    let filter = match word("filter").unwrap_or("NONE") {
        "COLOR" => decode_filter_color,
        name => match Filter::parse(name).map_err(|_| damaged(pointer, "its filter is unknown"))? {
            Filter::None => return Ok(bytes),
            Filter::Octahedral => decode_filter_oct,
            Filter::Quaternion => decode_filter_quat,
            Filter::Exponential => decode_filter_exp,
        },
    };
    filter(&mut bytes, count, stride, &mut workspace).map_err(failed)?;
    Ok(bytes)
}

/// How hard the encoder tries: the original's default.
const LEVEL: u8 = 2;

/// Whether a view is compressed.
pub(super) fn is_packed(view: &Value) -> bool {
    extension(view).is_some()
}

/// The extension of a view as it stands in the text, and its content.
pub(super) fn raw_extension(view: &RawValue) -> Option<(&RawValue, Value)> {
    #[derive(serde::Deserialize)]
    struct View<'a> {
        #[serde(borrow)]
        extensions: std::collections::BTreeMap<String, &'a RawValue>,
    }
    let view: View = serde_json::from_str(view.get()).ok()?;
    let raw = NAMES.iter().find_map(|name| view.extensions.get(*name))?;
    Some((*raw, serde_json::from_str(raw.get()).ok()?))
}

/// Encodes the views that changed, each with the mode, the filter and the version that it had, and writes them into the plain copy that goes
/// with the streams, where there is one. Whether that could be done.
pub(super) fn encode(root: &Value, plain: &Plain, host: &Host, streams: &mut Streams) -> bool {
    let views = list(root, "bufferViews").iter().enumerate();
    let mut changed = views.filter_map(|(index, view)| {
        let (_, stream) = extension(view)?;
        Some((view, stream, plain.before(index)?, plain.changed(index)?))
    });
    changed.all(|(view, stream, before, now)| {
        encode_view(host, root, (view, stream), (before, now), streams).is_some()
    })
}

fn encode_view(
    host: &Host,
    root: &Value,
    (view, stream): (&Value, &Value),
    (before, now): (&[u8], &[u8]),
    streams: &mut Streams,
) -> Option<()> {
    let word = |name: &str| stream.get(name).and_then(Value::as_str);
    if word("mode") != Some("ATTRIBUTES") {
        return None;
    }
    let segment = Segment::of(stream)?;
    let old = host.segment(root, segment)?;
    let (count, stride) = (whole(stream, "count")?, whole(stream, "byteStride")?);
    let mut workspace = Workspace::new(Limits::default());
    let (filtered, seen) = match word("filter").unwrap_or("NONE") {
        "NONE" => (now.to_vec(), now.to_vec()),
        "EXPONENTIAL" => exponential(before, now, count, stride, &mut workspace)?,
        // What the others hold are no positions.
        _ => return None,
    };
    let encoding = VertexEncoding::new(decode_vertex_version(old).ok()?, LEVEL).ok()?;
    let encoded = encode_vertex_buffer(&filtered, count, stride, encoding, &mut workspace).ok()?;
    let decoded = decode_vertex_buffer(count, stride, &encoded, &mut workspace).ok()?;
    (decoded == filtered).then_some(())?;
    streams.insert(segment, encoded);
    let copy = Segment::of(view)?;
    let buffer = list(root, "buffers").get(copy.buffer)?;
    if buffer.get("uri").is_some() {
        host.segment(root, copy)?;
        streams.insert(copy, seen);
    }
    Some(())
}

/// What the filter for floats may give an exponent to.
const EXPONENTS: [ExpMode; 4] = [
    ExpMode::SharedVector,
    ExpMode::Separate,
    ExpMode::SharedComponent,
    ExpMode::Clamped,
];

/// The most bits of a mantissa that the filter has.
const MOST_BITS: u32 = 24;

/// Floats through the filter as the host's went: its stream does not tell the bits and what has an exponent, so the first are taken with which
/// the host's come out as they went in. The filtered bytes, and what comes of them; `None` if vertices that did not change would.
fn exponential(
    host: &[u8],
    new: &[u8],
    count: usize,
    stride: usize,
    workspace: &mut Workspace,
) -> Option<(Vec<u8>, Vec<u8>)> {
    let mut through = |bytes: &[u8], mode: ExpMode, bits: u32| {
        let numbers = bytes.as_chunks().0.iter().copied().map(f32::from_le_bytes);
        let numbers: Vec<f32> = numbers.collect();
        let filtered = encode_filter_exp(count, stride, bits, &numbers, mode, workspace).ok()?;
        let mut seen = filtered.clone();
        decode_filter_exp(&mut seen, count, stride, workspace).ok()?;
        Some((filtered, seen))
    };
    let mut choices = (1..=MOST_BITS).flat_map(|bits| EXPONENTS.map(|mode| (mode, bits)));
    let (mode, bits) = choices
        .find(|&(mode, bits)| through(host, mode, bits).is_some_and(|(_, seen)| seen == host))?;
    let (filtered, seen) = through(new, mode, bits)?;
    let vertices = host.chunks(stride).zip(new.chunks(stride));
    let mut all = vertices.zip(seen.chunks(stride));
    all.all(|((host, new), seen)| host != new || seen == host)
        .then_some((filtered, seen))
}
