//! A changed document compressed again, as its host was: the host's text and bytes, with other streams where positions changed.

use std::collections::BTreeMap;

use serde_json::Value;
use serde_json::value::RawValue;

use super::super::buffer::Storage;
use super::super::container::Container;
use super::super::splice::Splice;
use super::super::{DocumentError, Files, data_uri, json};
use super::streams::{Host, Plain, Segment, Streams};
use super::{draco, list, meshopt, whole};

/// A packed document.
pub(in super::super) struct Packed<'h> {
    /// The host's text with the edits that streams of other lengths ask for.
    pub splice: Splice<'h>,
    /// The buffers that changed.
    pub chunk: Option<Vec<u8>>,
    pub files: Files,
}

impl Host {
    /// The document with the plain bytes compressed as they were; `None` where that cannot be done.
    pub fn packed(
        &self,
        plain_text: &str,
        storage: &Storage,
    ) -> Result<Option<Packed<'_>>, DocumentError> {
        let value = |text: &str| -> Result<Value, DocumentError> {
            let text = text.strip_prefix('\u{feff}').unwrap_or(text);
            serde_json::from_str(text).map_err(|error| DocumentError::BadJson {
                detail: error.to_string(),
                pointer: None,
            })
        };
        let (host, plain) = (value(&self.parts.text)?, value(plain_text)?);
        let views = list(&plain, "bufferViews").iter().filter_map(Segment::of);
        let plain_bytes = Plain {
            views: views.map(|view| view.start..view.end()).collect(),
            now: storage.bytes(),
            before: &storage.original,
        };
        let mut streams = Streams::new();
        let is_packed = self.is_plain_elsewhere(&host, &plain_bytes)
            && meshopt::encode(&host, &plain_bytes, self, &mut streams)
            && draco::encode(&host, &plain, &plain_bytes, self, &mut streams);
        if !is_packed {
            return Ok(None);
        }
        Ok(self.laid_out(&host, streams))
    }

    /// Whether nothing changed beside what was compressed: what was not would have to be written where it was.
    fn is_plain_elsewhere(&self, host: &Value, plain: &Plain) -> bool {
        let packed =
            |view: &Value, index: usize| meshopt::is_packed(view) || draco::is_packed(host, index);
        let views = list(host, "bufferViews").iter().enumerate();
        let mut others = views.filter(|(index, view)| !packed(view, *index));
        others.all(|(index, _)| plain.changed(index).is_none())
    }

    /// Lays the new streams where the old ones were, and what is behind them behind them.
    fn laid_out(&self, host: &Value, streams: Streams) -> Option<Packed<'_>> {
        let text = self.parts.text.as_str();
        let root = text.strip_prefix('\u{feff}').unwrap_or(text);
        let members: BTreeMap<String, &RawValue> = serde_json::from_str(root).ok()?;
        let items = |name: &str| -> Option<Vec<&RawValue>> {
            serde_json::from_str(members.get(name)?.get()).ok()
        };
        let (views, buffers) = (items("bufferViews")?, items("buffers")?);
        let mut packed = Packed {
            splice: Splice::new(text),
            chunk: None,
            files: Files::new(),
        };
        let mut objects: Vec<(&RawValue, Segment)> = Vec::new();
        for (raw, view) in views.iter().zip(list(host, "bufferViews")) {
            objects.extend(Segment::of(view).map(|segment| (*raw, segment)));
            if let Some((raw, stream)) = meshopt::raw_extension(raw) {
                objects.extend(Segment::of(&stream).map(|segment| (raw, segment)));
            }
        }
        for (index, raw) in buffers.iter().enumerate() {
            let old = self.buffer(host, index);
            let Some(old) = old.filter(|_| streams.keys().any(|segment| segment.buffer == index))
            else {
                continue;
            };
            let here = objects
                .iter()
                .map(|(_, segment)| *segment)
                .filter(|segment| segment.buffer == index);
            let layout = Layout::new(old, here.collect(), &streams, index)?;
            for (raw, segment) in objects
                .iter()
                .filter(|(_, segment)| segment.buffer == index)
            {
                let moved = layout.moved(*segment)?;
                number(
                    &mut packed.splice,
                    raw,
                    "byteOffset",
                    segment.start,
                    moved.start,
                )?;
                number(
                    &mut packed.splice,
                    raw,
                    "byteLength",
                    segment.length,
                    moved.length,
                )?;
            }
            let stated = whole(list(host, "buffers").get(index)?, "byteLength")?;
            let grown = layout.bytes.len();
            number(&mut packed.splice, raw, "byteLength", stated, grown)?;
            match list(host, "buffers")
                .get(index)?
                .get("uri")
                .and_then(Value::as_str)
            {
                Some(uri) => {
                    _ = packed
                        .files
                        .insert(data_uri::percent_decode(uri), layout.bytes)
                }
                None => packed.chunk = Some(layout.bytes),
            }
        }
        if self.parts.container == Container::Glb && packed.chunk.is_none() {
            packed.chunk.clone_from(&self.parts.binary);
        }
        if let Some(chunk) = &mut packed.chunk {
            chunk.resize(chunk.len().next_multiple_of(4), 0);
        }
        Some(packed)
    }
}

/// Makes a number of an object another one, or states it if it was left out.
fn number(
    splice: &mut Splice,
    object: &RawValue,
    name: &str,
    old: usize,
    new: usize,
) -> Option<()> {
    if old == new {
        return Some(());
    }
    let members: BTreeMap<String, &RawValue> = serde_json::from_str(object.get()).ok()?;
    match members.get(name) {
        Some(raw) => {
            let span = json::span(splice.text, raw.get())?;
            splice.replace(span, new.to_string());
        }
        None => {
            let span = json::span(splice.text, object.get())?;
            let end = span.end.checked_sub(1)?;
            splice.replace(end..end, format!(",\"{name}\":{new}"));
        }
    }
    Some(())
}

/// A buffer with other streams.
struct Layout<'a> {
    bytes: Vec<u8>,
    /// Where what was behind a place begins now: ascending.
    shifts: Vec<(usize, usize)>,
    streams: &'a Streams,
}

impl<'a> Layout<'a> {
    /// `None` if a new stream's place overlaps another one.
    fn new(
        old: &[u8],
        mut places: Vec<Segment>,
        streams: &'a Streams,
        buffer: usize,
    ) -> Option<Self> {
        places.sort_unstable();
        places.dedup();
        let mut layout = Self {
            bytes: Vec::with_capacity(old.len()),
            shifts: vec![(0, 0)],
            streams,
        };
        let mut read = 0;
        for (segment, stream) in streams
            .iter()
            .filter(|(segment, _)| segment.buffer == buffer)
        {
            let clashes = |other: &&Segment| {
                *other != segment && other.start < segment.end() && segment.start < other.end()
            };
            if places.iter().any(|other| clashes(&other)) {
                return None;
            }
            let next = places
                .iter()
                .map(|other| other.start)
                .find(|&start| start >= segment.end());
            let next = next.unwrap_or(old.len());
            layout
                .bytes
                .extend_from_slice(old.get(read..segment.start)?);
            let start = layout.bytes.len();
            layout.bytes.extend_from_slice(stream);
            read = next;
            if next < old.len() {
                // What is behind keeps its alignment, whatever that is.
                let phase = next.checked_rem(8)?;
                while layout.bytes.len().checked_rem(8)? != phase {
                    layout.bytes.push(0);
                }
            }
            layout.shifts.push((segment.start, start));
            layout.shifts.push((next, layout.bytes.len()));
        }
        layout.bytes.extend_from_slice(old.get(read..)?);
        Some(layout)
    }

    fn moved(&self, segment: Segment) -> Option<Segment> {
        let after = self
            .shifts
            .partition_point(|&(from, _)| from <= segment.start);
        let &(from, to) = self.shifts.get(after.checked_sub(1)?)?;
        Some(Segment {
            start: segment.start.checked_sub(from)?.checked_add(to)?,
            length: self.streams.get(&segment).map_or(segment.length, Vec::len),
            ..segment
        })
    }
}
