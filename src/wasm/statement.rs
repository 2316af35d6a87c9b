//! Statements: what a caller says of the files and the owner, and the HTML of it.

use super::argument;
use crate::{Finding, Key, StatedFile, Statement};
use js_sys::{Array, Object, Reflect};
use wasm_bindgen::prelude::*;

/// A statement as HTML.
pub fn stated(finding: Finding, key: &Key, asked: &JsValue) -> Result<String, JsValue> {
    let get = |object: &JsValue, name: &str| Reflect::get(object, &name.into());
    let words = |object: &JsValue, name: &str| -> Result<Option<String>, JsValue> {
        Ok(get(object, name)?.as_string())
    };
    let object = asked
        .dyn_ref::<Object>()
        .ok_or_else(|| argument("statement is an object"))?;
    let mut files = Vec::new();
    let given = get(object, "files")?;
    for file in given.dyn_ref::<Array>().unwrap_or(&Array::new()).iter() {
        files.push(StatedFile {
            role: words(&file, "role")?.unwrap_or_default(),
            name: words(&file, "name")?.unwrap_or_default(),
            bytes: get(&file, "bytes")?.as_f64().unwrap_or_default() as u64,
            sha256: words(&file, "sha256")?.unwrap_or_default(),
        });
    }
    let given = get(object, "commands")?;
    let mut commands = Vec::new();
    for line in given.dyn_ref::<Array>().unwrap_or(&Array::new()).iter() {
        commands.extend(line.as_string());
    }
    let (owner, date) = (words(object, "owner")?, words(object, "date")?);
    let statement = Statement {
        finding,
        owner: owner.as_deref(),
        commitment: &key.commitment(),
        files: &files,
        date: date.as_deref(),
        commands: &commands,
    };
    Ok(statement.html())
}
