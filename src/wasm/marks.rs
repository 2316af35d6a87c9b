//! Marking and checking: what the package is made of.

use super::listener::Listener;
use super::{argument, encoded, files_from, set, thrown};
use crate::watermark::{self, Error, Strength};
use crate::{Carrier, EmbedOptions, Evidence, Extraction, Key, Payload};
use js_sys::{Array, Function, JsString, Object, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;
use web_sys::AbortSignal;
use zeroize::Zeroizing;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = include_str!("types.d.ts");

/// 32 bytes from an owner's name and passphrase, which the engine brings to Unicode NFKC on the way.
#[wasm_bindgen(js_name = deriveKey, skip_typescript)]
pub fn derive_key(owner: JsString, passphrase: JsString) -> Result<Vec<u8>, JsValue> {
    let nfkc = |text: JsString| Zeroizing::new(String::from(text.normalize("NFKC")));
    let key = Key::from_passphrase(&nfkc(owner), &nfkc(passphrase))
        .map_err(Error::from)
        .map_err(thrown)?;
    Ok(key.to_bytes().to_vec())
}

/// Marks a model.
#[wasm_bindgen(skip_typescript)]
pub fn embed(
    model: &[u8],
    files: JsValue,
    payload: JsValue,
    key: &[u8],
    options: JsValue,
    on_progress: Option<Function>,
    signal: Option<AbortSignal>,
) -> Result<Object, JsValue> {
    let mut listener = Listener {
        on_progress,
        signal,
    };
    let key = key_from(key)?;
    let (payload, options, files) = (
        payload_from(&payload)?,
        options_from(&options)?,
        files_from(&files)?,
    );
    let embedding =
        watermark::embed(model, &files, payload, &key, &options, &mut listener).map_err(thrown)?;
    let marked_files = Object::new();
    for (name, bytes) in &embedding.files {
        set(&marked_files, name, &Uint8Array::from(bytes.as_slice()))?;
    }
    let result = Object::new();
    set(
        &result,
        "model",
        &Uint8Array::from(embedding.model.as_slice()),
    )?;
    set(&result, "files", &marked_files)?;
    set(&result, "report", &encoded(&embedding.report)?)?;
    Ok(result)
}

/// Measures a suspect.
#[wasm_bindgen(skip_typescript)]
pub fn measure(
    model: &[u8],
    files: JsValue,
    on_progress: Option<Function>,
    signal: Option<AbortSignal>,
) -> Result<Vec<u8>, JsValue> {
    let mut listener = Listener {
        on_progress,
        signal,
    };
    let evidence =
        watermark::measure(model, &files_from(&files)?, &mut listener).map_err(thrown)?;
    Ok(evidence.to_bytes())
}

/// Reads a suspect in one go.
#[wasm_bindgen(skip_typescript)]
pub fn detect(
    model: &[u8],
    files: JsValue,
    key: &[u8],
    expected: JsValue,
    options: JsValue,
    on_progress: Option<Function>,
    signal: Option<AbortSignal>,
) -> Result<JsValue, JsValue> {
    let expected = match expected.is_undefined() {
        true => None,
        false => Some(payload_from(&expected)?),
    };
    let mut listener = Listener {
        on_progress,
        signal,
    };
    let (files, key) = (files_from(&files)?, key_from(key)?);
    let extraction =
        watermark::detect(model, &files, &key, expected, &mut listener).map_err(thrown)?;
    told(extraction, &options)
}

/// Reads a payload.
#[wasm_bindgen(skip_typescript)]
pub fn extract(evidence: &[u8], key: &[u8], options: JsValue) -> Result<JsValue, JsValue> {
    let extraction = watermark::extract(&evidence_from(evidence)?, &key_from(key)?);
    told(extraction, &options)
}

/// Tests an expected payload.
#[wasm_bindgen(skip_typescript)]
pub fn verify(
    evidence: &[u8],
    key: &[u8],
    expected: JsValue,
    options: JsValue,
) -> Result<JsValue, JsValue> {
    let extraction = watermark::verify(
        &evidence_from(evidence)?,
        &key_from(key)?,
        payload_from(&expected)?,
    );
    told(extraction, &options)
}

/// Describes a model.
#[wasm_bindgen(skip_typescript)]
pub fn inspect(model: &[u8], files: JsValue) -> Result<JsValue, JsValue> {
    encoded(&watermark::inspect(model, &files_from(&files)?).map_err(thrown)?)
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

/// A reading, with its details where `options` ask for them.
fn told(extraction: Extraction, options: &JsValue) -> Result<JsValue, JsValue> {
    let is_for_owner = field(options, "details") == JsValue::TRUE;
    encoded(&match is_for_owner {
        true => extraction.with_details(),
        false => extraction,
    })
}

fn key_from(bytes: &[u8]) -> Result<Key, JsValue> {
    Key::from_bytes(bytes).map_err(Error::from).map_err(thrown)
}

fn evidence_from(bytes: &[u8]) -> Result<Evidence, JsValue> {
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

fn options_from(value: &JsValue) -> Result<EmbedOptions, JsValue> {
    let mut options = EmbedOptions::default();
    let strength = field(value, "strength");
    if let Some(name) = strength.as_string() {
        // Numbers come as numbers; to read them from text takes 12 KB of tables and code.
        options.strength =
            Strength::from_name(&name).ok_or_else(|| thrown(Error::Strength(name)))?;
    } else if let Some(rms_rel) = strength.as_f64() {
        options.strength = Strength::new(rms_rel).map_err(thrown)?;
    } else if !strength.is_undefined() {
        return Err(thrown(Error::Strength(format!("{strength:?}"))));
    }
    let carriers = field(value, "carriers");
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

/// A property, `undefined` where the value is no object.
fn field(value: &JsValue, name: &str) -> JsValue {
    Reflect::get(value, &name.into()).unwrap_or(JsValue::UNDEFINED)
}
