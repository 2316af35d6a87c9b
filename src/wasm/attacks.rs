//! Trying to break a mark: the attacks by name, and what each costs. Whoever attacks has no key.

use super::options::Options;
use super::{argument, encoded, failure, thrown};
use crate::Files;
use crate::attack::{Step, entries, step};
use crate::document::Document;
use crate::geometry::Quality;
use crate::mesh::Mesh;
use crate::scene::{Scene, to_glb};
use crate::watermark::Error;
use js_sys::{Array, Uint8Array};
use serde::Serialize;
use wasm_bindgen::prelude::*;

/// Every attack there is.
#[wasm_bindgen(skip_typescript)]
pub fn catalogue() -> Result<JsValue, JsValue> {
    encoded(&entries())
}

/// A copy after some steps.
#[wasm_bindgen(skip_typescript)]
pub fn attack(model: &[u8], steps: JsValue, options: JsValue) -> Result<Uint8Array, JsValue> {
    let options = Options::new(options, &["files", "seed"])?;
    let (steps, seed) = (steps_from(steps)?, seed_from(&options.get("seed"))?);
    let mut mesh = gathered(model, &options.files("files")?)?;
    for (step, seed) in steps.iter().zip(seed..) {
        mesh = step.apply(&mesh, seed);
        if mesh.triangles.is_empty() {
            let message = format!("after {step} there is nothing left of the model");
            return Err(failure("attack.nothing-left", &message, None));
        }
    }
    Ok(Uint8Array::from(to_glb(&mesh).as_slice()))
}

/// What an attack cost and left.
#[wasm_bindgen(skip_typescript)]
pub fn quality(reference: &[u8], model: &[u8], options: JsValue) -> Result<JsValue, JsValue> {
    #[derive(Serialize)]
    struct Report {
        #[serde(flatten)]
        quality: Quality,
        vertices: usize,
        triangles: usize,
    }
    let options = Options::new(options, &["referenceFiles", "files"])?;
    let (reference, mesh) = (
        gathered(reference, &options.files("referenceFiles")?)?,
        gathered(model, &options.files("files")?)?,
    );
    encoded(&Report {
        quality: Quality::between(&reference, &mesh),
        vertices: mesh.positions.len(),
        triangles: mesh.triangles.len(),
    })
}

fn gathered(model: &[u8], files: &Files) -> Result<Mesh, JsValue> {
    let scene = Document::read(model, files)
        .map_err(Error::from)
        .and_then(|document| Scene::gather(&document).map_err(Error::from))
        .map_err(thrown)?;
    Ok(scene.mesh)
}

fn steps_from(names: JsValue) -> Result<Vec<Step>, JsValue> {
    let names = names
        .dyn_into::<Array>()
        .map_err(|_| argument("steps is an array of names"))?;
    let named = |name: JsValue| {
        let known = name.as_string().and_then(|name| step(&name));
        known.ok_or_else(|| argument(&format!("there is no attack {name:?}")))
    };
    names.iter().map(named).collect()
}

/// A whole number below 2^32; 1 where it was left out.
fn seed_from(value: &JsValue) -> Result<u64, JsValue> {
    match value.as_f64() {
        None if value.is_undefined() => Ok(1),
        Some(seed) if f64::from(seed as u32) == seed => Ok(seed as u64),
        _ => Err(argument("seed is a whole number below 2^32")),
    }
}
