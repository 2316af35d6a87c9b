//! Buffer views that meshoptimizer's codecs hold.

use meshoptimizer_rs::codec::{
    Filter, Mode, VertexEncoding, decode_filter_color, decode_filter_exp, decode_filter_oct,
    decode_filter_quat, decode_index_buffer, decode_index_sequence, decode_vertex_buffer,
    decode_vertex_version, encode_vertex_buffer,
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

/// Encodes the views that changed, each with the mode, the filter and the version that it had. Whether that could be done: not of a filtered
/// view, for filters round, and not if a plain copy goes with the streams.
pub(super) fn encode(root: &Value, plain: &Plain, host: &Host, streams: &mut Streams) -> bool {
    let views = list(root, "bufferViews").iter().enumerate();
    let changed =
        views.filter_map(|(index, view)| Some((extension(view)?.1, plain.changed(index)?)));
    let has_copy = list(root, "buffers")
        .iter()
        .any(|buffer| extension(buffer).is_some() && buffer.get("uri").is_some());
    changed.into_iter().all(|(stream, bytes)| {
        !has_copy && encode_view(root, stream, bytes, host, streams).is_some()
    })
}

fn encode_view(
    root: &Value,
    stream: &Value,
    bytes: &[u8],
    host: &Host,
    streams: &mut Streams,
) -> Option<()> {
    let word = |name: &str| stream.get(name).and_then(Value::as_str);
    if word("mode") != Some("ATTRIBUTES") || word("filter").is_some_and(|filter| filter != "NONE") {
        return None;
    }
    let segment = Segment::of(stream)?;
    let version = decode_vertex_version(host.segment(root, segment)?).ok()?;
    let (count, stride) = (whole(stream, "count")?, whole(stream, "byteStride")?);
    let encoding = VertexEncoding::new(version, LEVEL).ok()?;
    let mut workspace = Workspace::new(Limits::default());
    let encoded = encode_vertex_buffer(bytes, count, stride, encoding, &mut workspace).ok()?;
    let decoded = decode_vertex_buffer(count, stride, &encoded, &mut workspace).ok()?;
    (decoded == bytes).then_some(())?;
    streams.insert(segment, encoded);
    Some(())
}
