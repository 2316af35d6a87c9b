//! Which bytes of a compressed document are streams, and which of them hold other data now.

use std::collections::BTreeMap;
use std::ops::Range;

use serde_json::Value;

use super::super::container::Parts;
use super::super::{Files, data_uri};
use super::{list, whole};

/// A compressed document as it was read.
pub(in super::super) struct Host {
    pub parts: Parts,
    pub files: Files,
}

impl Host {
    /// The bytes of a buffer of the host.
    pub(super) fn buffer(&self, host: &Value, index: usize) -> Option<&[u8]> {
        let buffer = list(host, "buffers").get(index)?;
        match buffer.get("uri").and_then(Value::as_str) {
            None if index == 0 => self.parts.binary.as_deref(),
            None => None,
            Some(uri) => {
                let name = data_uri::percent_decode(uri);
                self.files
                    .get(&name)
                    .or_else(|| self.files.get(uri))
                    .map(Vec::as_slice)
            }
        }
    }

    /// The bytes of a segment.
    pub(super) fn segment(&self, host: &Value, segment: Segment) -> Option<&[u8]> {
        self.buffer(host, segment.buffer)?
            .get(segment.start..segment.end())
    }
}

/// A range of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Segment {
    pub buffer: usize,
    pub start: usize,
    pub length: usize,
}

impl Segment {
    /// As an object with `buffer`, `byteOffset` and `byteLength` states it.
    pub fn of(object: &Value) -> Option<Self> {
        Some(Self {
            buffer: whole(object, "buffer")?,
            start: whole(object, "byteOffset").unwrap_or(0),
            length: whole(object, "byteLength")?,
        })
    }

    pub fn end(self) -> usize {
        self.start.saturating_add(self.length)
    }
}

/// Where the plain views of a document are, and what is there now and was there before.
pub(super) struct Plain<'a> {
    pub views: Vec<Range<usize>>,
    pub now: &'a [u8],
    pub before: &'a [u8],
}

impl Plain<'_> {
    /// The bytes of a view before.
    pub fn before(&self, view: usize) -> Option<&[u8]> {
        self.before.get(self.views.get(view)?.clone())
    }

    /// The bytes of a view now, if they are others than before.
    pub fn changed(&self, view: usize) -> Option<&[u8]> {
        let now = self.now.get(self.views.get(view)?.clone())?;
        (now != self.before(view)?).then_some(now)
    }
}

/// The streams that hold other bytes now; `None` where one cannot be made as it was.
pub(super) type Streams = BTreeMap<Segment, Vec<u8>>;
