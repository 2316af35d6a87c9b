//! Copies for buyers, and tracing: for who sells.

use super::informed::laid;
use super::marks::{embed_options_from, evidence_from, key_from, model_to, surface_from};
use super::options::Options;
use super::statement::stated;
use super::{argument, encoded, set, thrown};
use crate::watermark::{self, Error};
use crate::{
    Extraction, Finding, Illustration, Key, Ledger, Model, Overlay, Payload, Plan, Surface,
    Suspect, Tracing,
};
use js_sys::{Object, Reflect, Uint8Array};
use std::cell::RefCell;
use wasm_bindgen::prelude::*;

thread_local! {
    /// The plan that was stamped last: to look at its host again takes longer than a stamp.
    static LAST: RefCell<Option<(Vec<u8>, Plan)>> = const { RefCell::new(None) };
}

/// Looks at a model once for all its copies.
#[wasm_bindgen(skip_typescript)]
pub fn prepare(model: &[u8], key: &[u8], options: JsValue) -> Result<Object, JsValue> {
    let known = ["files", "strength", "carriers", "maxMovement", "onProgress"];
    let options = Options::new(options, &known)?;
    let key = key_from(key)?;
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let options = embed_options_from(&options)?;
    let model = Model::new(model)
        .with_files(&files)
        .with_progress(&mut listener);
    let (plan, report) = watermark::prepare(model, &key, &options).map_err(thrown)?;
    let bytes = plan.to_bytes();
    let result = Object::new();
    set(&result, "plan", &Uint8Array::from(bytes.as_slice()))?;
    set(&result, "report", &encoded(&report)?)?;
    LAST.set(Some((bytes, plan)));
    Ok(result)
}

/// A copy with a number.
#[wasm_bindgen(skip_typescript)]
pub fn stamp(plan: &[u8], number: f64) -> Result<Object, JsValue> {
    let number = number_from(number)?;
    let last = LAST.take().filter(|(bytes, _)| bytes == plan);
    let (bytes, plan) = match last {
        Some(last) => last,
        None => (plan.to_vec(), Plan::from_bytes(plan).map_err(thrown)?),
    };
    let stamped = plan.stamp(number);
    LAST.set(Some((bytes, plan)));
    let stamped = stamped.map_err(thrown)?;
    let result = model_to(&stamped.model, &stamped.files)?;
    set(&result, "report", &encoded(&stamped.report)?)?;
    Ok(result)
}

/// Says whose copies a model was made of.
#[wasm_bindgen(skip_typescript)]
pub fn trace(
    model: &[u8],
    key: &[u8],
    numbers: &[f64],
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let options = Options::new(options, &[&["files"], &TRACE_OPTIONS[..]].concat())?;
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let model = Model::new(model)
        .with_files(&files)
        .with_progress(&mut listener);
    traced(model.into(), key, numbers, &options)
}

/// The same of a suspect that is no glTF.
#[wasm_bindgen(js_name = traceMesh, skip_typescript)]
pub fn trace_mesh(
    positions: &[f64],
    triangles: &[u32],
    key: &[u8],
    numbers: &[f64],
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let options = Options::new(options, &TRACE_OPTIONS)?;
    let mut listener = options.listener()?;
    let (positions, triangles) = surface_from(positions, triangles)?;
    let surface = Surface::new(positions, triangles).with_progress(&mut listener);
    traced(surface.into(), key, numbers, &options)
}

/// Options of every suspect that is traced, but of evidence.
const TRACE_OPTIONS: [&str; 6] = [
    "original",
    "originalFiles",
    "record",
    "overlay",
    "statement",
    "onProgress",
];

/// A tracing with what there is beside the suspect.
fn traced(
    suspect: Suspect,
    key: &[u8],
    numbers: &[f64],
    options: &Options,
) -> Result<JsValue, JsValue> {
    let (key, numbers) = (key_from(key)?, numbers_from(numbers)?);
    let (original, record) = (options.get("original"), options.get("record"));
    let is_overlay = options.is_set("overlay")?;
    let (tracing, overlay) = match (original.is_undefined(), record.is_undefined()) {
        (true, true) => watermark::trace(suspect, &key, &numbers).map(|tracing| (tracing, None)),
        (false, true) => {
            let original = original.dyn_ref::<Uint8Array>();
            let original = original.ok_or_else(|| argument("original is a byte array"))?;
            let (bytes, files) = (original.to_vec(), options.files("originalFiles")?);
            let original = Model::new(&bytes).with_files(&files);
            watermark::trace_overlaid(suspect, original, &key, &numbers)
        }
        (true, false) => {
            let record = record.as_string();
            let record = record.ok_or_else(|| argument("record is a text"))?;
            watermark::trace_overlaid_with_record(suspect, &record, &key, &numbers)
        }
        (false, false) => return Err(argument("there is an original or a record, not both")),
    }
    .map_err(thrown)?;
    let result = told(&tracing, overlay.as_ref(), &key, options)?;
    if is_overlay {
        let overlay = overlay.as_ref().map(laid).transpose()?;
        let overlay = overlay.map_or(JsValue::NULL, Into::into);
        set(result.unchecked_ref::<Object>(), "overlay", &overlay)?;
    }
    Ok(result)
}

/// The same of evidence.
#[wasm_bindgen(js_name = traceEvidence, skip_typescript)]
pub fn trace_evidence(
    evidence: &[u8],
    key: &[u8],
    numbers: &[f64],
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let options = Options::new(options, &["statement"])?;
    let (key, numbers) = (key_from(key)?, numbers_from(numbers)?);
    let tracing = watermark::trace_evidence(&evidence_from(evidence)?, &key, &numbers);
    told(&tracing.map_err(thrown)?, None, &key, &options)
}

/// Reads a model with the key alone, and states what was found.
#[wasm_bindgen(js_name = stateReading, skip_typescript)]
pub fn state_reading(model: &[u8], key: &[u8], options: JsValue) -> Result<String, JsValue> {
    let options = Options::new(options, &["files", "statement", "onProgress"])?;
    let key = key_from(key)?;
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let model = Model::new(model)
        .with_files(&files)
        .with_progress(&mut listener);
    let found: Extraction = watermark::detect(model, &key, None).map_err(thrown)?;
    stated(Finding::Reading(&found), &key, &options.get("statement"))
}

/// The number of the copy that has a payload.
#[wasm_bindgen(js_name = copyNumber, skip_typescript)]
pub fn copy_number(payload: f64, key: &[u8]) -> Result<f64, JsValue> {
    let payload = Payload::from_number(number_from(payload)?).map_err(Error::from);
    Ok(payload.map_err(thrown)?.copy_number(&key_from(key)?) as f64)
}

/// A tracing, and its statement where one was asked for.
fn told(
    tracing: &Tracing,
    overlay: Option<&Overlay>,
    key: &Key,
    options: &Options,
) -> Result<JsValue, JsValue> {
    let result = encoded(tracing)?;
    let asked = options.get("statement");
    if let Some(object) = asked.dyn_ref::<Object>() {
        let triangles = Reflect::get(object, &"triangles".into())?;
        let mut ledger = Ledger {
            triangles: triangles.as_f64().map(|triangles| triangles as u64),
            ..Ledger::default()
        };
        let names = Reflect::get(object, &"names".into())?;
        if let Some(names) = names.dyn_ref::<Object>() {
            for buyer in &tracing.buyers {
                let name = Reflect::get(names, &buyer.number.to_string().into())?;
                let name = name.as_string().unwrap_or_default();
                ledger.names.push((buyer.number, name));
            }
        }
        let picture = overlay.map(Illustration::of);
        let finding = Finding::Tracing(tracing, &ledger, picture.as_ref());
        let html = stated(finding, key, &asked)?;
        let object = result.unchecked_ref::<Object>();
        set(object, "statement", &html.into())?;
    }
    Ok(result)
}

fn numbers_from(numbers: &[f64]) -> Result<Vec<u64>, JsValue> {
    numbers.iter().copied().map(number_from).collect()
}

/// A whole number below 2^48.
fn number_from(number: f64) -> Result<u64, JsValue> {
    let is_number =
        number >= 0.0 && number.fract() == 0.0 && number < (1u64 << Payload::BITS) as f64;
    let number = if is_number { number as u64 } else { u64::MAX };
    let payload = Payload::from_number(number).map_err(Error::from);
    Ok(payload.map_err(thrown)?.number())
}
