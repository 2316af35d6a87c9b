//! Reading with the original or with a record.

use super::marks::{expected_from, key_from, surface_from};
use super::options::Options;
use super::statement::stated;
use super::{argument, encoded, files_from, set, thrown};
use crate::watermark::{self, Comparison, Error, Illustration, Overlay, RecordOptions, Sheet};
use crate::{Finding, Key, Model, Payload, Surface};
use js_sys::{Float32Array, Object, Uint32Array};
use wasm_bindgen::prelude::*;

/// Reads a suspect with the original.
#[wasm_bindgen(skip_typescript)]
pub fn compare(
    suspect: &[u8],
    original: &[u8],
    key: &[u8],
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let known = [
        "files",
        "originalFiles",
        "expected",
        "details",
        "overlay",
        "statement",
        "onProgress",
    ];
    let options = Options::new(options, &known)?;
    let (key, asked) = (key_from(key)?, Asked::of(&options)?);
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let of_original = files_from(&options.get("originalFiles"))?;
    let suspect = Model::new(suspect)
        .with_files(&files)
        .with_progress(&mut listener);
    let original = Model::new(original).with_files(&of_original);
    told(
        watermark::compare_overlaid(suspect, original, &key, asked.expected),
        &key,
        &asked,
    )
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
    let known = [
        "originalFiles",
        "expected",
        "details",
        "overlay",
        "statement",
        "onProgress",
    ];
    let options = Options::new(options, &known)?;
    let (key, asked) = (key_from(key)?, Asked::of(&options)?);
    let mut listener = options.listener()?;
    let of_original = files_from(&options.get("originalFiles"))?;
    let (positions, triangles) = surface_from(positions, triangles)?;
    let suspect = Surface::new(positions, triangles).with_progress(&mut listener);
    let original = Model::new(original).with_files(&of_original);
    told(
        watermark::compare_overlaid(suspect, original, &key, asked.expected),
        &key,
        &asked,
    )
}

/// Reads a suspect with the record of marking it.
#[wasm_bindgen(js_name = compareWithRecord, skip_typescript)]
pub fn compare_with_record(
    suspect: &[u8],
    record: &str,
    key: &[u8],
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let known = [
        "files",
        "expected",
        "details",
        "overlay",
        "statement",
        "onProgress",
    ];
    let options = Options::new(options, &known)?;
    let (key, asked) = (key_from(key)?, Asked::of(&options)?);
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let suspect = Model::new(suspect)
        .with_files(&files)
        .with_progress(&mut listener);
    let comparison = watermark::compare_overlaid_with_record(suspect, record, &key, asked.expected);
    told(comparison, &key, &asked)
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

/// What is looked for, and what is wanted beside the comparison.
struct Asked {
    expected: Option<Payload>,
    details: bool,
    overlay: bool,
    statement: JsValue,
}

impl Asked {
    fn of(options: &Options) -> Result<Asked, JsValue> {
        Ok(Asked {
            expected: expected_from(options)?,
            details: options.is_set("details")?,
            overlay: options.is_set("overlay")?,
            statement: options.get("statement"),
        })
    }
}

/// A comparison with what was asked for.
fn told(
    compared: Result<(Comparison, Option<Overlay>), Error>,
    key: &Key,
    asked: &Asked,
) -> Result<JsValue, JsValue> {
    let (comparison, overlay) = compared.map_err(thrown)?;
    let statement = match asked.statement.is_undefined() {
        true => None,
        false => {
            let picture = overlay.as_ref().map(Illustration::of);
            let finding = Finding::Comparison(&comparison, picture.as_ref());
            Some(stated(finding, key, &asked.statement)?)
        }
    };
    let result = encoded(&match asked.details {
        true => comparison.with_details(),
        false => comparison,
    })?;
    let object = result.unchecked_ref::<Object>();
    if let Some(html) = statement {
        set(object, "statement", &html.into())?;
    }
    if asked.overlay {
        let overlay = overlay.as_ref().map(laid).transpose()?;
        set(
            object,
            "overlay",
            &overlay.map_or(JsValue::NULL, Into::into),
        )?;
    }
    Ok(result)
}

pub(super) fn laid(overlay: &Overlay) -> Result<Object, JsValue> {
    let floats = |values: &[f32]| JsValue::from(Float32Array::from(values));
    let evidence = overlay.evidence.as_deref().map_or(JsValue::NULL, floats);
    let object = Object::new();
    for (name, value) in [
        ("isRecorded", overlay.is_recorded.into()),
        ("original", sheet(&overlay.original)?.into()),
        ("suspect", sheet(&overlay.suspect)?.into()),
        ("differences", floats(&overlay.differences)),
        ("additions", floats(&overlay.additions)),
        ("mostDifference", overlay.most_difference.into()),
        ("evidence", evidence),
        ("mostEvidence", overlay.most_evidence.into()),
        ("diagonal", overlay.diagonal.into()),
        ("from", encoded(&overlay.from)?),
    ] {
        set(&object, name, &value)?;
    }
    Ok(object)
}

fn sheet(sheet: &Sheet) -> Result<Object, JsValue> {
    let object = Object::new();
    let positions = Float32Array::from(sheet.positions.as_flattened());
    set(&object, "positions", &positions)?;
    let triangles = Uint32Array::from(sheet.triangles.as_flattened());
    set(&object, "triangles", &triangles)?;
    Ok(object)
}
