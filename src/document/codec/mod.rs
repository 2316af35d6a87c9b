//! Compressed geometry, taken out of its codecs: `KHR_draco_mesh_compression`, `EXT_meshopt_compression`, `KHR_meshopt_compression`.
//!
//! [`unpacked`] makes of a compressed document a plain one, with all data in one buffer: text and bytes that the rest of the room reads
//! as any other. Nothing that a codec gives is trusted: its lengths are checked here, and the plain document is validated like one that
//! came so. [`Host::packed`] compresses what changed again, as it was. What the codecs may make of a small file is limited before it is made.

mod draco;
mod meshopt;
mod pack;
mod repack;
mod streams;

use serde_json::Value;

use super::container::{Container, Parts};
use super::{DocumentError, Files};
pub(super) use streams::Host;

use repack::{Repacked, Repacking};

/// The most bytes that all compressed data of a file may become: more than the largest scene that is read.
const MAX_BYTES: usize = if cfg!(target_pointer_width = "32") {
    1 << 28
} else {
    1 << 31
};

/// What a compressed document was made into.
pub(super) struct Unpacked {
    /// The plain document.
    pub parts: Parts,
    /// Its buffer, if that is a file of its own.
    pub files: Files,
    /// The extensions that are gone.
    pub extensions: Vec<&'static str>,
}

/// The plain document of a compressed one; `None` if nothing is compressed.
pub(super) fn unpacked(parts: &Parts, files: &Files) -> Result<Option<Unpacked>, DocumentError> {
    let names = draco::NAMES.iter().chain(meshopt::NAMES);
    let extensions: Vec<&'static str> = names
        .copied()
        .filter(|name| parts.text.contains(&format!("\"{name}\"")))
        .collect();
    if extensions.is_empty() {
        return Ok(None);
    }
    let text = parts.text.strip_prefix('\u{feff}').unwrap_or(&parts.text);
    let mut root: Value = serde_json::from_str(text).map_err(|error| DocumentError::BadJson {
        detail: error.to_string(),
        pointer: None,
    })?;
    if !draco::is_used(&root) && !meshopt::is_used(&root) {
        return Ok(None);
    }
    let mut repacking = Repacking::new(&root, parts, files)?;
    meshopt::decode(&mut root, &mut repacking)?;
    draco::decode(&mut root, &mut repacking)?;
    let Repacked { chunk, files } = repacking.finish(&mut root)?;
    for list in ["extensionsUsed", "extensionsRequired"] {
        forget(&mut root, list, &extensions);
    }
    let mut text = root.to_string();
    if parts.container == Container::Glb {
        super::container::pad(&mut text);
    }
    Ok(Some(Unpacked {
        parts: Parts {
            container: parts.container,
            text,
            binary: chunk,
            rest: parts.rest.clone(),
            tail: parts.tail.clone(),
        },
        files,
        extensions,
    }))
}

/// Takes names out of a list of the root; an empty list may not stand in a document.
fn forget(root: &mut Value, list: &str, names: &[&str]) {
    let Some(Value::Array(items)) = root.get_mut(list) else {
        return;
    };
    items.retain(|item| item.as_str().is_none_or(|name| !names.contains(&name)));
    if items.is_empty()
        && let Value::Object(members) = root
    {
        members.shift_remove(list);
    }
}

/// The items of a list of the root.
fn list<'a>(root: &'a Value, name: &str) -> &'a [Value] {
    root.get(name)
        .and_then(Value::as_array)
        .map_or(&[], Vec::as_slice)
}

/// A member that is a whole number that an address can hold.
fn whole(object: &Value, name: &str) -> Option<usize> {
    usize::try_from(object.get(name)?.as_u64()?).ok()
}

/// The error of compressed data that is not as it should be.
fn damaged(pointer: &str, detail: impl ToString) -> DocumentError {
    DocumentError::BadCompression {
        pointer: pointer.to_owned(),
        detail: detail.to_string(),
    }
}

/// Takes an extension out of an object, and the list of extensions with the last of them.
fn take_extension(object: &mut Value, name: &str) -> Option<Value> {
    let extensions = object.get_mut("extensions")?.as_object_mut()?;
    let taken = extensions.shift_remove(name);
    if extensions.is_empty() {
        object.as_object_mut()?.shift_remove("extensions");
    }
    taken
}
