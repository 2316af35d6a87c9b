//! Reading with the original at hand: a module of its own, which is loaded when it is asked for.

use super::options::Options;
use super::{argument, encoded, files_from, thrown};
use crate::watermark::{self, Comparison, Error, RecordOptions};
use crate::{Key, Model, Surface};
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = include_str!("informed.d.ts");

/// Reads a suspect with the original.
#[wasm_bindgen(skip_typescript)]
pub fn compare(
    suspect: &[u8],
    original: &[u8],
    key: &[u8],
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let known = ["files", "originalFiles", "details", "onProgress"];
    let options = Options::new(options, &known)?;
    let is_for_owner = options.is_set("details")?;
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let of_original = files_from(&options.get("originalFiles"))?;
    let suspect = Model::new(suspect)
        .with_files(&files)
        .with_progress(&mut listener);
    let original = Model::new(original).with_files(&of_original);
    let comparison = watermark::compare(suspect, original, &key_from(key)?).map_err(thrown)?;
    told(comparison, is_for_owner)
}

/// Reads a suspect that is no glTF with the original.
#[wasm_bindgen(js_name = compareMesh, skip_typescript)]
pub fn compare_mesh(
    positions: &[f64],
    triangles: &[u32],
    original: &[u8],
    key: &[u8],
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let options = Options::new(options, &["originalFiles", "details", "onProgress"])?;
    let is_for_owner = options.is_set("details")?;
    let mut listener = options.listener()?;
    let of_original = files_from(&options.get("originalFiles"))?;
    let (positions, []) = positions.as_chunks() else {
        return Err(argument("positions have three numbers each"));
    };
    let (triangles, []) = triangles.as_chunks() else {
        return Err(argument("triangles have three numbers each"));
    };
    let suspect = Surface::new(positions, triangles).with_progress(&mut listener);
    let original = Model::new(original).with_files(&of_original);
    let comparison = watermark::compare(suspect, original, &key_from(key)?).map_err(thrown)?;
    told(comparison, is_for_owner)
}

/// Reads a suspect with the record of marking it.
#[wasm_bindgen(js_name = compareWithRecord, skip_typescript)]
pub fn compare_with_record(
    suspect: &[u8],
    record: &str,
    key: &[u8],
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let options = Options::new(options, &["files", "details", "onProgress"])?;
    let is_for_owner = options.is_set("details")?;
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let suspect = Model::new(suspect)
        .with_files(&files)
        .with_progress(&mut listener);
    let comparison = watermark::compare_with_record(suspect, record, &key_from(key)?);
    told(comparison.map_err(thrown)?, is_for_owner)
}

/// The record of an embedding.
#[wasm_bindgen(skip_typescript)]
pub fn record(
    original: &[u8],
    report: JsValue,
    key: &[u8],
    options: JsValue,
) -> Result<String, JsValue> {
    let options = Options::new(options, &["originalFiles", "owner", "date"])?;
    let files = files_from(&options.get("originalFiles"))?;
    let marking = serde_wasm_bindgen::from_value(report)
        .map_err(|_| argument("report is what `embed` gave"))?;
    let text = |name: &str| options.get(name).as_string().unwrap_or_default();
    let named = RecordOptions::default()
        .with_owner(text("owner"))
        .with_date(text("date"));
    let model = Model::new(original).with_files(&files);
    watermark::record_of(&model, &marking, &key_from(key)?, &named).map_err(thrown)
}

fn key_from(bytes: &[u8]) -> Result<Key, JsValue> {
    Key::from_bytes(bytes).map_err(Error::from).map_err(thrown)
}

/// A comparison, with what follows the key where it is for the key's owner.
fn told(comparison: Comparison, is_for_owner: bool) -> Result<JsValue, JsValue> {
    encoded(&match is_for_owner {
        true => comparison.with_details(),
        false => comparison,
    })
}
