//! The files that a document names, of whatever kind: buffers, images, sounds, what extensions name.

use std::collections::BTreeSet;

use serde_json::Value;

use super::DocumentError;
use super::data_uri::percent_decode;

/// The relative URIs of a JSON text, percent-decoded, each once: every member `uri`, wherever it stands. glTF and its extensions name
/// files by no other member.
pub(super) fn relative(text: &str) -> Result<Vec<String>, DocumentError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let root: Value = serde_json::from_str(text).map_err(|error| DocumentError::BadJson {
        detail: error.to_string(),
        pointer: None,
    })?;
    let mut names = BTreeSet::new();
    let mut open = vec![&root];
    while let Some(value) = open.pop() {
        match value {
            Value::Array(items) => open.extend(items),
            Value::Object(members) => {
                if let Some(Value::String(uri)) = members.get("uri")
                    && is_relative(uri)
                {
                    names.insert(percent_decode(uri));
                }
                open.extend(members.values());
            }
            _ => {}
        }
    }
    Ok(names.into_iter().collect())
}

/// Whether a URI names a file beside the document: it has neither a scheme nor a host (RFC 3986, section 4.2).
fn is_relative(uri: &str) -> bool {
    let scheme = uri.split_once(':').map(|(scheme, _)| scheme);
    let has_scheme = scheme.is_some_and(|scheme| {
        let mut letters = scheme.bytes();
        letters
            .next()
            .is_some_and(|first| first.is_ascii_alphabetic())
            && letters.all(|byte| byte.is_ascii_alphanumeric() || b"+-.".contains(&byte))
    });
    !uri.is_empty() && !has_scheme && !uri.starts_with("//")
}
