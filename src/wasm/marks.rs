//! Marking and checking: what the package is made of.

use super::options::Options;
use super::{argument, encoded, set, thrown};
use crate::watermark::{self, Error, Strength};
use crate::{Carrier, EmbedOptions, Evidence, Extraction, Files, Key, Model, Payload, Surface};
use js_sys::{Array, JsString, Object, Uint8Array};
use wasm_bindgen::prelude::*;
use zeroize::Zeroizing;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = include_str!("types.d.ts");

/// 32 bytes from an owner's name and passphrase, which the engine brings to Unicode NFKC on the way.
#[wasm_bindgen(js_name = deriveKey, skip_typescript)]
pub fn derive_key(owner: JsString, passphrase: JsString) -> Result<Vec<u8>, JsValue> {
    let nfkc = |text: JsString| Zeroizing::new(String::from(text.normalize("NFKC")));
    let key = Key::from_normalized(&nfkc(owner), &nfkc(passphrase))
        .map_err(Error::from)
        .map_err(thrown)?;
    Ok(key.to_bytes().to_vec())
}

/// The key of one work of an owner, 32 bytes.
#[wasm_bindgen(js_name = workKey, skip_typescript)]
pub fn work_key(key: &[u8], title: JsString) -> Result<Vec<u8>, JsValue> {
    let title = String::from(title.normalize("NFKC"));
    let work = key_from(key)?
        .for_normalized_work(&title)
        .map_err(Error::from)
        .map_err(thrown)?;
    Ok(work.to_bytes().to_vec())
}

/// Marks a model.
#[wasm_bindgen(skip_typescript)]
pub fn embed(
    model: &[u8],
    payload: JsValue,
    key: &[u8],
    options: JsValue,
) -> Result<Object, JsValue> {
    let known = ["files", "strength", "carriers", "maxMovement", "onProgress"];
    let options = Options::new(options, &known)?;
    let (payload, key) = (payload_from(&payload)?, key_from(key)?);
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let options = embed_options_from(&options)?;
    let model = Model::new(model)
        .with_files(&files)
        .with_progress(&mut listener);
    let embedding = watermark::embed(model, payload, &key, &options).map_err(thrown)?;
    let result = model_to(&embedding.model, &embedding.files)?;
    set(&result, "report", &encoded(&embedding.report)?)?;
    Ok(result)
}

/// A model without compression.
#[wasm_bindgen(skip_typescript)]
pub fn decompress(model: &[u8], options: JsValue) -> Result<Object, JsValue> {
    let files = Options::new(options, &["files"])?.files("files")?;
    let plain = watermark::decompress(Model::new(model).with_files(&files));
    let (model, files) = plain.map_err(thrown)?;
    model_to(&model, &files)
}

/// Measures a suspect.
#[wasm_bindgen(skip_typescript)]
pub fn measure(model: &[u8], options: JsValue) -> Result<Vec<u8>, JsValue> {
    let options = Options::new(options, &["files", "onProgress"])?;
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let model = Model::new(model)
        .with_files(&files)
        .with_progress(&mut listener);
    let evidence = watermark::measure(model).map_err(thrown)?;
    Ok(evidence.to_bytes())
}

/// Reads a suspect in one go.
#[wasm_bindgen(skip_typescript)]
pub fn detect(model: &[u8], key: &[u8], options: JsValue) -> Result<JsValue, JsValue> {
    let known = ["files", "expected", "details", "onProgress"];
    let options = Options::new(options, &known)?;
    let (key, expected) = (key_from(key)?, expected_from(&options)?);
    let is_for_owner = options.is_set("details")?;
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let model = Model::new(model)
        .with_files(&files)
        .with_progress(&mut listener);
    let extraction = watermark::detect(model, &key, expected).map_err(thrown)?;
    told(extraction, is_for_owner)
}

/// Measures a suspect that is no glTF.
#[wasm_bindgen(js_name = measureMesh, skip_typescript)]
pub fn measure_mesh(
    positions: &[f64],
    triangles: &[u32],
    options: JsValue,
) -> Result<Vec<u8>, JsValue> {
    let mut listener = Options::new(options, &["onProgress"])?.listener()?;
    let (positions, triangles) = surface_from(positions, triangles)?;
    let surface = Surface::new(positions, triangles).with_progress(&mut listener);
    Ok(watermark::measure(surface).map_err(thrown)?.to_bytes())
}

/// Reads a suspect that is no glTF.
#[wasm_bindgen(js_name = detectMesh, skip_typescript)]
pub fn detect_mesh(
    positions: &[f64],
    triangles: &[u32],
    key: &[u8],
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let options = Options::new(options, &["expected", "details", "onProgress"])?;
    let (key, expected) = (key_from(key)?, expected_from(&options)?);
    let is_for_owner = options.is_set("details")?;
    let mut listener = options.listener()?;
    let (positions, triangles) = surface_from(positions, triangles)?;
    let surface = Surface::new(positions, triangles).with_progress(&mut listener);
    let extraction = watermark::detect(surface, &key, expected).map_err(thrown)?;
    told(extraction, is_for_owner)
}

/// Reads a payload.
#[wasm_bindgen(skip_typescript)]
pub fn extract(evidence: &[u8], key: &[u8], options: JsValue) -> Result<JsValue, JsValue> {
    let is_for_owner = Options::new(options, &["details"])?.is_set("details")?;
    let extraction = watermark::extract(&evidence_from(evidence)?, &key_from(key)?);
    told(extraction, is_for_owner)
}

/// Reads a payload with every key of a list, and charges that there are many.
#[wasm_bindgen(js_name = extractMany, skip_typescript)]
pub fn extract_many(evidence: &[u8], keys: JsValue, options: JsValue) -> Result<Array, JsValue> {
    let is_for_owner = Options::new(options, &["details"])?.is_set("details")?;
    let key = |key: JsValue| {
        let bytes = key.dyn_into::<Uint8Array>();
        key_from(
            &bytes
                .map_err(|_| argument("keys are byte arrays"))?
                .to_vec(),
        )
    };
    let keys = keys
        .dyn_into::<Array>()
        .map_err(|_| argument("keys is an array of byte arrays"))?;
    let keys = keys.iter().map(key).collect::<Result<Vec<_>, _>>()?;
    let extractions = watermark::extract_many(&evidence_from(evidence)?, &keys);
    let one = |extraction| told(extraction, is_for_owner);
    extractions.into_iter().map(one).collect()
}

/// Tests an expected payload.
#[wasm_bindgen(skip_typescript)]
pub fn verify(
    evidence: &[u8],
    key: &[u8],
    expected: JsValue,
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let is_for_owner = Options::new(options, &["details"])?.is_set("details")?;
    let extraction = watermark::verify(
        &evidence_from(evidence)?,
        &key_from(key)?,
        payload_from(&expected)?,
    );
    told(extraction, is_for_owner)
}

/// Describes a model.
#[wasm_bindgen(skip_typescript)]
pub fn inspect(model: &[u8], options: JsValue) -> Result<JsValue, JsValue> {
    let files = Options::new(options, &["files"])?.files("files")?;
    let model = Model::new(model).with_files(&files);
    encoded(&watermark::inspect(model).map_err(thrown)?)
}

/// Tries what a model can hold.
#[wasm_bindgen(skip_typescript)]
pub fn capacity(model: &[u8], options: JsValue) -> Result<JsValue, JsValue> {
    let options = Options::new(options, &["files", "onProgress"])?;
    let (files, mut listener) = (options.files("files")?, options.listener()?);
    let model = Model::new(model)
        .with_files(&files)
        .with_progress(&mut listener);
    encoded(&watermark::capacity(model).map_err(thrown)?)
}

/// A generated model.
#[wasm_bindgen(js_name = demoModel, skip_typescript)]
pub fn demo_model() -> Vec<u8> {
    crate::demo_model()
}

/// The version of this module.
#[wasm_bindgen(skip_typescript)]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// A reading, with its details where they are for the key's owner.
fn told(extraction: Extraction, is_for_owner: bool) -> Result<JsValue, JsValue> {
    encoded(&match is_for_owner {
        true => extraction.with_details(),
        false => extraction,
    })
}

pub(super) fn key_from(bytes: &[u8]) -> Result<Key, JsValue> {
    Key::from_bytes(bytes).map_err(Error::from).map_err(thrown)
}

pub(super) fn evidence_from(bytes: &[u8]) -> Result<Evidence, JsValue> {
    Evidence::from_bytes(bytes)
        .map_err(Error::from)
        .map_err(thrown)
}

/// A string is a tag, a number a number.
fn payload_from(value: &JsValue) -> Result<Payload, JsValue> {
    let payload = match (value.as_string(), value.as_f64()) {
        (Some(tag), _) => Payload::from_tag(&tag),
        (None, Some(number))
            if number >= 0.0
                && number.fract() == 0.0
                && number < (1u64 << Payload::BITS) as f64 =>
        {
            Payload::from_number(number as u64)
        }
        _ => Payload::from_number(u64::MAX),
    };
    payload.map_err(Error::from).map_err(thrown)
}

/// The payload that is looked for, if one is.
pub(super) fn expected_from(options: &Options) -> Result<Option<Payload>, JsValue> {
    let expected = options.get("expected");
    match expected.is_undefined() {
        true => Ok(None),
        false => payload_from(&expected).map(Some),
    }
}

/// The positions of vertices, and the vertices of triangles.
type Triangles<'a> = (&'a [[f64; 3]], &'a [[u32; 3]]);

/// Numbers by threes; a rest is refused.
pub(super) fn surface_from<'a>(
    positions: &'a [f64],
    triangles: &'a [u32],
) -> Result<Triangles<'a>, JsValue> {
    match (positions.as_chunks(), triangles.as_chunks()) {
        ((positions, []), (triangles, [])) => Ok((positions, triangles)),
        _ => Err(argument("positions and triangles have three numbers each")),
    }
}

/// A model and its files.
pub(super) fn model_to(model: &[u8], files: &Files) -> Result<Object, JsValue> {
    let named = Object::new();
    for (name, bytes) in files {
        set(&named, name, &Uint8Array::from(bytes.as_slice()))?;
    }
    let result = Object::new();
    set(&result, "model", &Uint8Array::from(model))?;
    set(&result, "files", &named)?;
    Ok(result)
}

pub(super) fn embed_options_from(given: &Options) -> Result<EmbedOptions, JsValue> {
    let mut options = EmbedOptions::default();
    let strength = given.get("strength");
    if let Some(name) = strength.as_string() {
        // Numbers come as numbers; to read them from text takes 12 KB of tables and code.
        options.strength =
            Strength::from_name(&name).ok_or_else(|| thrown(Error::Strength(name)))?;
    } else if let Some(rms_rel) = strength.as_f64() {
        options.strength = Strength::new(rms_rel).map_err(thrown)?;
    } else if !strength.is_undefined() {
        return Err(thrown(Error::Strength(format!("{strength:?}"))));
    }
    let max_movement = given.get("maxMovement");
    if !max_movement.is_undefined() {
        // What is no number is refused as one that is not positive.
        options.max_movement = Some(max_movement.as_f64().unwrap_or(f64::NAN));
    }
    let carriers = given.get("carriers");
    if !carriers.is_undefined() {
        let name = |name: JsValue| {
            let known = name.as_string().and_then(|name| Carrier::from_name(&name));
            known.ok_or_else(|| argument(&format!("there is no carrier {name:?}")))
        };
        let names = carriers
            .dyn_into::<Array>()
            .map_err(|_| argument("carriers is an array of names"))?;
        options.carriers = names.iter().map(name).collect::<Result<_, _>>()?;
    }
    Ok(options)
}
