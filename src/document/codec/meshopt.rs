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
        "EXPONENTIAL" => {
            let filtered = decode_vertex_buffer(count, stride, old, &mut workspace).ok()?;
            exponential(filtered, (before, now), (count, stride), &mut workspace)?
        }
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

/// Floats through the filter as the host's went, which `filtered` is: what did not change stays as it is there; what did keeps its exponent, or the
/// least one above with which its mantissa is no larger than the host's largest. So few bits differ, and as many are there as the host has. The
/// filtered bytes, and what comes of them.
fn exponential(
    filtered: Vec<u8>,
    (host, new): (&[u8], &[u8]),
    (count, stride): (usize, usize),
    workspace: &mut Workspace,
) -> Option<(Vec<u8>, Vec<u8>)> {
    let parts = |word: &[u8; 4]| {
        let word = i32::from_le_bytes(*word);
        (
            word >> MANTISSA_BITS,
            (word << EXPONENT_BITS) >> EXPONENT_BITS,
        )
    };
    let mut words = filtered;
    let mantissas = words.as_chunks().0.iter().map(|word| parts(word).1);
    let largest = mantissas
        .map(i32::unsigned_abs)
        .max()?
        .clamp(1, MOST_MANTISSA);
    let numbers = host.as_chunks::<4>().0.iter().zip(new.as_chunks().0);
    for (word, (host, new)) in words.as_chunks_mut().0.iter_mut().zip(numbers) {
        if host == new {
            continue;
        }
        let number = f64::from(f32::from_le_bytes(*new));
        let (least, _) = parts(word);
        let (exponent, mantissa) = (least..=MOST_EXPONENT)
            .map(|exponent| {
                let scaled = libm::scalbn(number, exponent.saturating_neg());
                (exponent, libm::rint(scaled))
            })
            .find(|(_, mantissa)| mantissa.abs() <= f64::from(largest))?;
        let mantissa = mantissa as i32 & ((1 << MANTISSA_BITS) - 1);
        *word = (exponent << MANTISSA_BITS | mantissa).to_le_bytes();
    }
    let mut seen = words.clone();
    decode_filter_exp(&mut seen, count, stride, workspace).ok()?;
    Some((words, seen))
}

/// Of a filtered number (EXT_meshopt_compression, "EXPONENTIAL filter"): the low bits are the mantissa, the high ones the exponent of 2.
const MANTISSA_BITS: u32 = 24;
const EXPONENT_BITS: u32 = 8;
const MOST_MANTISSA: u32 = (1 << (MANTISSA_BITS - 1)) - 1; // one more would be read as negative
const MOST_EXPONENT: i32 = 100; // what the filter is specified for
