//! The bytes behind the buffers of a document: read from wherever they are, patched in place.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use serde_json::value::RawValue;

use super::json::{self, FromJson, Place};
use super::schema::Root;
use super::{DocumentError, Files, data_uri};

/// Where the bytes come from and go back to.
pub(super) enum Origin {
    /// The GLB binary chunk.
    Chunk,
    /// A data URI whose payload stands here in the JSON text.
    DataUri(Range<usize>),
    /// An external file, by its key in [`Files`].
    File(String),
}

/// One run of bytes. Buffers that name the same file share one.
pub(super) struct Storage {
    pub origin: Origin,
    pub original: Vec<u8>,
    patched: Option<Vec<u8>>,
}

impl Storage {
    fn new(origin: Origin, original: Vec<u8>) -> Self {
        Self {
            origin,
            original,
            patched: None,
        }
    }

    /// The current bytes.
    pub fn bytes(&self) -> &[u8] {
        self.patched.as_deref().unwrap_or(&self.original)
    }

    /// The current bytes if they are not the original ones.
    pub fn changed(&self) -> Option<&[u8]> {
        self.patched
            .as_deref()
            .filter(|patched| *patched != self.original)
    }

    /// Whether any of the `size` bytes at `offset` is not the original one.
    pub fn has_changed(&self, offset: usize, size: usize) -> bool {
        let range = offset..offset.saturating_add(size);
        self.bytes().get(range.clone()) != self.original.get(range)
    }

    /// Overwrites the bytes at `offset`; nothing happens beyond the end.
    pub fn patch(&mut self, offset: usize, bytes: &[u8]) {
        let patched = self.patched.get_or_insert_with(|| self.original.clone());
        let target = patched
            .get_mut(offset..)
            .and_then(|tail| tail.get_mut(..bytes.len()));
        if let Some(target) = target {
            target.copy_from_slice(bytes);
        }
    }
}

/// A buffer of the JSON text: its storage, and how much of it the buffer is.
pub(super) struct Buffer {
    pub storage: usize,
    pub length: u64,
}

/// The URI of a buffer that is an external file, as the JSON text states it.
fn file_uri(uri: &RawValue, buffer: usize) -> Result<String, DocumentError> {
    let buffers = Place::Field(&Place::Root, "buffers");
    String::from_json(uri, Place::Field(&Place::Item(&buffers, buffer), "uri"))
}

/// The names of the external files, percent-decoded, each once.
pub(super) fn file_names(root: &Root) -> Result<Vec<String>, DocumentError> {
    let mut names = BTreeSet::new();
    for (index, buffer) in root.buffers.iter().enumerate() {
        if let Some(uri) = buffer.uri.filter(|uri| !data_uri::is_data_uri(uri.get())) {
            names.insert(data_uri::percent_decode(&file_uri(uri, index)?));
        }
    }
    Ok(names.into_iter().collect())
}

/// Finds the bytes of all buffers.
pub(super) fn resolve(
    root: &Root,
    text: &str,
    binary: Option<Vec<u8>>,
    files: &Files,
) -> Result<(Vec<Storage>, Vec<Buffer>), DocumentError> {
    let mut storages: Vec<Storage> = Vec::new();
    let has_chunk = binary.is_some();
    storages.extend(binary.map(|bytes| Storage::new(Origin::Chunk, bytes)));

    let mut by_name: BTreeMap<&str, usize> = BTreeMap::new();
    let mut buffers = Vec::with_capacity(root.buffers.len());
    for (index, buffer) in root.buffers.iter().enumerate() {
        let pointer = || format!("/buffers/{index}/uri");
        let storage = match buffer.uri {
            // The chunk is the first storage (specification section 3.6.1.2).
            None if index == 0 && has_chunk => 0,
            None => {
                return Err(DocumentError::MissingData {
                    pointer: format!("/buffers/{index}"),
                    length: buffer.byte_length,
                });
            }
            Some(uri) if data_uri::is_data_uri(uri.get()) => {
                let malformed = |detail: &str| DocumentError::BadDataUri {
                    pointer: pointer(),
                    detail: detail.to_owned(),
                };
                let (payload, bytes) =
                    data_uri::decode(uri.get()).map_err(|detail| malformed(&detail))?;
                let payload = uri
                    .get()
                    .get(payload)
                    .and_then(|payload| json::span(text, payload));
                let payload = payload.ok_or_else(|| malformed("its payload cannot be located"))?;
                storages.push(Storage::new(Origin::DataUri(payload), bytes));
                storages.len().saturating_sub(1)
            }
            Some(uri) => {
                let uri = file_uri(uri, index)?;
                let decoded = data_uri::percent_decode(&uri);
                let (key, bytes) = files
                    .get_key_value(&decoded)
                    .or_else(|| files.get_key_value(&uri))
                    .ok_or_else(|| DocumentError::MissingFile {
                        pointer: pointer(),
                        uri: decoded.clone(),
                    })?;
                *by_name.entry(key).or_insert_with(|| {
                    storages.push(Storage::new(Origin::File(key.clone()), bytes.clone()));
                    storages.len().saturating_sub(1)
                })
            }
        };
        let available = storages
            .get(storage)
            .map_or(0, |storage| storage.original.len() as u64);
        if buffer.byte_length > available {
            return Err(DocumentError::Truncated {
                part: format!("buffer {index}"),
                needed: buffer.byte_length,
                available,
                pointer: Some(format!("/buffers/{index}/byteLength")),
            });
        }
        buffers.push(Buffer {
            storage,
            length: buffer.byte_length,
        });
    }
    Ok((storages, buffers))
}
