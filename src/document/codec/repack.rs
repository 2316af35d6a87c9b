//! All buffer views of a document in one buffer, some of them with other bytes than before.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::super::container::{Container, Parts};
use super::super::{DocumentError, Files, data_uri};
use super::{MAX_BYTES, damaged, list, whole};

/// Where vertex data and indices begin: a multiple of what any number needs.
const ALIGNMENT: usize = 8;

/// The buffers as they were, and what becomes of the views.
pub(super) struct Repacking<'a> {
    buffers: Vec<Option<Bytes<'a>>>,
    /// Whether the one buffer is to be a GLB's chunk.
    is_glb: bool,
    /// The URI of the first buffer that is a file.
    file: Option<String>,
    /// New bytes of views, by index: of those that were compressed, and of new ones at the end.
    views: Vec<Option<Vec<u8>>>,
    left: usize,
}

/// Bytes of the file, or decoded from its text.
enum Bytes<'a> {
    Of(&'a [u8]),
    Decoded(Vec<u8>),
}

impl Bytes<'_> {
    fn get(&self) -> &[u8] {
        match self {
            Self::Of(bytes) => bytes,
            Self::Decoded(bytes) => bytes,
        }
    }
}

/// The one buffer that is left.
pub(super) struct Repacked {
    /// As a GLB's chunk.
    pub chunk: Option<Vec<u8>>,
    /// As a file.
    pub files: Files,
}

impl<'a> Repacking<'a> {
    pub fn new(root: &Value, parts: &'a Parts, files: &'a Files) -> Result<Self, DocumentError> {
        let mut file = None;
        let mut buffers = Vec::new();
        for (index, buffer) in list(root, "buffers").iter().enumerate() {
            let pointer = format!("/buffers/{index}");
            buffers.push(match buffer.get("uri").and_then(Value::as_str) {
                // What stands in a fallback is not needed here, and is mostly nowhere.
                _ if is_fallback(buffer) => None,
                None if index == 0 => parts.binary.as_deref().map(Bytes::Of),
                None => None,
                Some(uri) if is_data(uri) => {
                    let token = format!("\"{uri}\"");
                    let decoded =
                        data_uri::decode(&token).map_err(|detail| DocumentError::BadDataUri {
                            pointer: format!("{pointer}/uri"),
                            detail,
                        })?;
                    Some(Bytes::Decoded(decoded.1))
                }
                Some(uri) => {
                    let name = data_uri::percent_decode(uri);
                    let bytes = files.get(&name).or_else(|| files.get(uri));
                    let bytes = bytes.ok_or_else(|| DocumentError::MissingFile {
                        pointer: format!("{pointer}/uri"),
                        uri: name.clone(),
                    })?;
                    file.get_or_insert_with(|| uri.to_owned());
                    Some(Bytes::Of(bytes))
                }
            });
        }
        Ok(Self {
            buffers,
            is_glb: parts.container == Container::Glb,
            file,
            views: list(root, "bufferViews").iter().map(|_| None).collect(),
            left: MAX_BYTES,
        })
    }

    /// The bytes of a range of a buffer, as an object with `buffer`, `byteOffset` and `byteLength` states it.
    pub fn range(&self, object: &Value, pointer: &str) -> Result<&[u8], DocumentError> {
        let index =
            whole(object, "buffer").ok_or_else(|| damaged(pointer, "it names no buffer"))?;
        let buffer = self.buffers.get(index).and_then(Option::as_ref);
        let buffer = buffer.ok_or_else(|| DocumentError::MissingData {
            pointer: format!("/buffers/{index}"),
            length: whole(object, "byteLength").unwrap_or(0) as u64,
        })?;
        let start = whole(object, "byteOffset").unwrap_or(0);
        let length =
            whole(object, "byteLength").ok_or_else(|| damaged(pointer, "it states no length"))?;
        let bytes = buffer
            .get()
            .get(start..)
            .and_then(|rest| rest.get(..length));
        bytes.ok_or_else(|| DocumentError::OutOfBounds {
            pointer: pointer.to_owned(),
            needed: start.saturating_add(length) as u64,
            available: buffer.get().len() as u64,
        })
    }

    /// Takes room for decoded bytes from what all of them may have.
    pub fn reserve(&mut self, bytes: Option<usize>, pointer: &str) -> Result<(), DocumentError> {
        let left = bytes.and_then(|bytes| self.left.checked_sub(bytes));
        self.left = left.ok_or_else(|| DocumentError::TooLarge {
            what: "the decompressed geometry, in bytes,",
            value: bytes.unwrap_or(usize::MAX) as u64,
            limit: MAX_BYTES as u64,
            pointer: Some(pointer.to_owned()),
        })?;
        Ok(())
    }

    /// The most bytes that may still be decoded.
    pub fn left(&self) -> usize {
        self.left
    }

    /// Gives a view other bytes.
    pub fn replace(&mut self, view: usize, bytes: Vec<u8>) {
        if let Some(slot) = self.views.get_mut(view) {
            *slot = Some(bytes);
        }
    }

    /// Whether a view has other bytes by now.
    pub fn is_replaced(&self, view: usize) -> bool {
        self.views.get(view).is_none_or(Option::is_some)
    }

    /// Adds a view, and gives its index.
    pub fn add(&mut self, bytes: Vec<u8>) -> usize {
        self.views.push(Some(bytes));
        self.views.len().saturating_sub(1)
    }

    /// Lays all views behind each other, and states where they are.
    pub fn finish(self, root: &mut Value) -> Result<Repacked, DocumentError> {
        let mut binary = Vec::new();
        let mut stated = list(root, "bufferViews").to_vec();
        stated.resize_with(self.views.len(), || json!({}));
        for (index, (view, bytes)) in stated.iter_mut().zip(&self.views).enumerate() {
            let bytes = match bytes {
                Some(bytes) => bytes,
                None => self.range(view, &format!("/bufferViews/{index}"))?,
            };
            binary.resize(binary.len().next_multiple_of(ALIGNMENT), 0);
            let (start, length) = (binary.len(), bytes.len());
            binary.extend_from_slice(bytes);
            if let Value::Object(members) = view {
                members.insert("buffer".into(), json!(0));
                members.insert("byteOffset".into(), json!(start));
                members.insert("byteLength".into(), json!(length));
            }
        }
        binary.resize(binary.len().next_multiple_of(4), 0);
        let mut buffer = json!({ "byteLength": binary.len() });
        let uri = match self.file {
            _ if self.is_glb => None,
            Some(uri) => Some(uri),
            None => Some(format!(
                "data:application/octet-stream;base64,{}",
                STANDARD.encode(&binary)
            )),
        };
        let name = uri
            .as_deref()
            .filter(|uri| !is_data(uri))
            .map(data_uri::percent_decode);
        if let (Some(uri), Value::Object(members)) = (uri, &mut buffer) {
            members.insert("uri".into(), json!(uri));
        }
        if let Value::Object(members) = root {
            members.insert("bufferViews".into(), Value::Array(stated));
            members.insert("buffers".into(), json!([buffer]));
        }
        let mut repacked = Repacked {
            chunk: None,
            files: Files::new(),
        };
        match name {
            Some(name) => _ = repacked.files.insert(name, binary),
            None if self.is_glb => repacked.chunk = Some(binary),
            None => {}
        }
        Ok(repacked)
    }
}

/// Whether a buffer stands in for decoded data, where no decoder is: meshopt's extension says so of it.
fn is_fallback(buffer: &Value) -> bool {
    let extensions = buffer.get("extensions").and_then(Value::as_object);
    let mut flags = extensions
        .into_iter()
        .flatten()
        .map(|(_, extension)| extension.get("fallback"));
    flags.any(|flag| flag.and_then(Value::as_bool) == Some(true))
}

fn is_data(uri: &str) -> bool {
    uri.get(..5)
        .is_some_and(|start| start.eq_ignore_ascii_case("data:"))
}
