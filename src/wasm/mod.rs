//! What JavaScript sees: options decoded, one library function called, its result encoded. Nothing is computed here.
//!
//! There are three modules, each with a feature and contracts of its own, so that a page that only marks and checks loads nothing
//! else: `marks.rs` with `types.d.ts`; a second that has all of it, and beside it `informed.rs` and `copies.rs`, with `full.d.ts`; and
//! a third for research, `study.rs` and `attacks.rs` with `research.d.ts`. The package's
//! tests hold the contracts to what is exported. What a call cannot do without are its arguments; all else is in one object, its
//! last. Bytes cross as `Uint8Array`, reports by serde. Errors are plain objects `{code, message, path}`.

#[cfg(feature = "wasm-research")]
mod attacks;
#[cfg(feature = "wasm-full")]
mod copies;
#[cfg(feature = "wasm-full")]
mod informed;
mod listener;
#[cfg(feature = "wasm-marks")]
mod marks;
mod options;
#[cfg(feature = "wasm-full")]
mod statement;
#[cfg(feature = "wasm-research")]
mod study;

use crate::Files;
use crate::watermark::Error;
use js_sys::{Array, Object, Uint8Array};
use serde::Serialize;
use wasm_bindgen::prelude::*;

/// Of the module with everything: what `informed.rs` and `copies.rs` export.
#[cfg(feature = "wasm-full")]
#[wasm_bindgen(typescript_custom_section)]
const FULL_TYPES: &str = include_str!("full.d.ts");

/// Of the module for research: what `study.rs` and `attacks.rs` export.
#[cfg(feature = "wasm-research")]
#[wasm_bindgen(typescript_custom_section)]
const RESEARCH_TYPES: &str = include_str!("research.d.ts");

/// A panic stops the module, and the package can say no more than `internal`: the console says what happened and where, so that
/// it can be reported.
#[wasm_bindgen(start, skip_typescript)]
fn start() {
    std::panic::set_hook(Box::new(|panic| {
        web_sys::console::error_1(&format!("meshmark: {panic}").into());
    }));
}

/// `undefined`, `null`, or an object of byte arrays.
fn files_from(value: &JsValue) -> Result<Files, JsValue> {
    if value.is_undefined() || value.is_null() {
        return Ok(Files::new());
    }
    let files = value
        .dyn_ref::<Object>()
        .ok_or_else(|| argument("files is an object of byte arrays"))?;
    let mut named = Files::new();
    for entry in Object::entries(files).iter() {
        let entry = Array::from(&entry);
        let bytes = entry
            .get(1)
            .dyn_into::<Uint8Array>()
            .map_err(|_| argument("files are byte arrays"))?;
        named.insert(entry.get(0).as_string().unwrap_or_default(), bytes.to_vec());
    }
    Ok(named)
}

fn set(object: &Object, name: &str, value: &JsValue) -> Result<(), JsValue> {
    js_sys::Reflect::set(object, &name.into(), value).map(drop)
}

/// A report as a plain object: `null` for what is not there, numbers for whole numbers below 2^53.
fn encoded(report: &impl Serialize) -> Result<JsValue, JsValue> {
    let serializer = serde_wasm_bindgen::Serializer::json_compatible();
    report
        .serialize(&serializer)
        .map_err(|error| argument(&error.to_string()))
}

/// An error as JavaScript sees it.
fn thrown(error: Error) -> JsValue {
    failure(error.code(), &error.to_string(), error.pointer())
}

/// The error of a call whose arguments are not what types.d.ts says.
fn argument(message: &str) -> JsValue {
    failure("options.argument", message, None)
}

fn failure(code: &str, message: &str, path: Option<&str>) -> JsValue {
    #[derive(Serialize)]
    struct Failure<'a> {
        code: &'a str,
        message: &'a str,
        path: Option<&'a str>,
    }
    encoded(&Failure {
        code,
        message,
        path,
    })
    .unwrap_or(JsValue::UNDEFINED)
}
