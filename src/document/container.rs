//! The two containers of glTF 2.0: plain JSON text (`.gltf`) and GLB (specification section 4.4).

use super::DocumentError;

const MAGIC: &[u8; 4] = b"glTF";
const JSON: &[u8; 4] = b"JSON";
const BIN: &[u8; 4] = b"BIN\0";
const HEADER_BYTES: usize = 12;

/// How a glTF document is packed into a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Container {
    /// Binary glTF, `.glb`.
    Glb,
    /// JSON text, `.gltf`.
    Gltf,
}

/// A model file taken apart. [`join`](Self::join) puts it together again.
pub(super) struct Parts {
    pub container: Container,
    /// The JSON text with everything around it: byte order mark, white space, padding.
    pub text: String,
    /// The content of the GLB binary chunk, padding included.
    pub binary: Option<Vec<u8>>,
    /// The GLB chunks that glTF 2.0 does not define, headers included.
    pub rest: Vec<u8>,
    /// The bytes after the end that the GLB header states: no part of the document.
    pub tail: Vec<u8>,
}

/// Takes a model file apart. A file that starts with the GLB magic number is GLB, any other is JSON.
pub(super) fn split(model: &[u8]) -> Result<Parts, DocumentError> {
    if !model.starts_with(MAGIC) {
        let text = model.strip_prefix("\u{feff}".as_bytes()).unwrap_or(model);
        if !text.trim_ascii_start().starts_with(b"{") {
            return Err(DocumentError::BadContainer {
                detail: "it starts neither like a .glb nor like a .gltf file".into(),
            });
        }
        return Ok(Parts {
            container: Container::Gltf,
            text: utf8(model)?,
            binary: None,
            rest: Vec::new(),
            tail: Vec::new(),
        });
    }
    let (header, body) = model
        .split_at_checked(HEADER_BYTES)
        .ok_or_else(|| truncated("the GLB header", HEADER_BYTES as u64, model.len()))?;
    let version = word(header, 4);
    if version != 2 {
        return Err(DocumentError::VersionUnsupported {
            version: version.to_string(),
        });
    }
    let stated = word(header, 8);
    if u64::from(stated) > model.len() as u64 {
        return Err(truncated("the GLB file", u64::from(stated), model.len()));
    }
    let length = usize::try_from(stated)
        .unwrap_or(model.len())
        .saturating_sub(HEADER_BYTES);
    let (body, tail) = body.split_at_checked(length).unwrap_or((body, &[]));

    let [kind, json, mut body] = chunk(body)?;
    if kind != JSON {
        return Err(DocumentError::BadContainer {
            detail: "its first chunk is not JSON".into(),
        });
    }
    let mut binary = None;
    if !body.is_empty() {
        let [kind, data, rest] = chunk(body)?;
        if kind == BIN {
            binary = Some(data.to_vec());
            body = rest;
        }
    }
    let mut unread = body;
    while !unread.is_empty() {
        [_, _, unread] = chunk(unread)?;
    }
    Ok(Parts {
        container: Container::Glb,
        text: utf8(json)?,
        binary,
        rest: body.to_vec(),
        tail: tail.to_vec(),
    })
}

/// Puts a model file together, the inverse of [`split`].
///
/// # Errors
///
/// [`DocumentError::TooLarge`] if the GLB file would exceed its format's 4 GiB.
pub(super) fn join(
    container: Container,
    text: &str,
    binary: Option<&[u8]>,
    rest: &[u8],
    tail: &[u8],
) -> Result<Vec<u8>, DocumentError> {
    let mut file = Vec::new();
    if container == Container::Gltf {
        file.extend_from_slice(text.as_bytes());
        return Ok(file);
    }
    let chunks = [
        Some((JSON, text.as_bytes())),
        binary.map(|data| (BIN, data)),
    ];
    let length = chunks
        .iter()
        .flatten()
        .map(|(_, data)| (data.len() as u64).saturating_add(8))
        .fold(HEADER_BYTES as u64, u64::saturating_add)
        .saturating_add(rest.len() as u64);
    let stated = u32::try_from(length).map_err(|_| DocumentError::TooLarge {
        what: "the GLB file's length in bytes",
        value: length,
        limit: u64::from(u32::MAX),
        pointer: None,
    })?;
    file.extend_from_slice(MAGIC);
    file.extend_from_slice(&2_u32.to_le_bytes());
    file.extend_from_slice(&stated.to_le_bytes());
    for (kind, data) in chunks.into_iter().flatten() {
        // A part is no longer than the whole, whose length fits.
        let length = u32::try_from(data.len()).unwrap_or(stated);
        file.extend_from_slice(&length.to_le_bytes());
        file.extend_from_slice(kind);
        file.extend_from_slice(data);
    }
    file.extend_from_slice(rest);
    file.extend_from_slice(tail);
    Ok(file)
}

/// Pads the text of a GLB JSON chunk with spaces to a multiple of four bytes.
pub(super) fn pad(text: &mut String) {
    text.truncate(text.trim_end_matches(' ').len());
    while !text.len().is_multiple_of(4) {
        text.push(' ');
    }
}

/// The first chunk's type and content, and the bytes after it.
fn chunk(bytes: &[u8]) -> Result<[&[u8]; 3], DocumentError> {
    let (header, data) = bytes
        .split_at_checked(8)
        .ok_or_else(|| truncated("a GLB chunk's header", 8, bytes.len()))?;
    let length = word(header, 0);
    let (content, rest) = usize::try_from(length)
        .ok()
        .and_then(|length| data.split_at_checked(length))
        .ok_or_else(|| truncated("a GLB chunk", u64::from(length), data.len()))?;
    Ok([header.get(4..).unwrap_or_default(), content, rest])
}

/// The little-endian word at `offset`, or 0 if the bytes end before it.
fn word(bytes: &[u8], offset: usize) -> u32 {
    let word = bytes.get(offset..).and_then(<[u8]>::first_chunk);
    u32::from_le_bytes(word.copied().unwrap_or_default())
}

fn utf8(bytes: &[u8]) -> Result<String, DocumentError> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_owned()),
        Err(error) => Err(DocumentError::BadJson {
            detail: format!("it is not UTF-8 text ({error})"),
            pointer: None,
        }),
    }
}

fn truncated(part: &str, needed: u64, available: usize) -> DocumentError {
    DocumentError::Truncated {
        part: part.into(),
        needed,
        available: available as u64,
        pointer: None,
    }
}
