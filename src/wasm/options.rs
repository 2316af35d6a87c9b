//! The options of a call: one object, in which every name is known.

use super::{argument, files_from};
use crate::Files;
use js_sys::{Object, Reflect};
use wasm_bindgen::prelude::*;

/// What a call was given beside what it cannot do without.
pub struct Options(JsValue);

impl Options {
    /// Refuses a name that the call does not know: a misspelt one would be left out in silence.
    pub fn new(value: JsValue, known: &[&str]) -> Result<Options, JsValue> {
        if value.is_undefined() {
            return Ok(Options(value));
        }
        let object = value
            .dyn_ref::<Object>()
            .ok_or_else(|| argument("options are an object"))?;
        for name in Object::keys(object).iter() {
            let name = name.as_string().unwrap_or_default();
            if !known.contains(&name.as_str()) {
                let known = known.join(", ");
                return Err(argument(&format!(
                    "there is no option {name:?}; there are {known}"
                )));
            }
        }
        Ok(Options(value))
    }

    /// An option; `undefined` where it was left out.
    pub fn get(&self, name: &str) -> JsValue {
        Reflect::get(&self.0, &name.into()).unwrap_or(JsValue::UNDEFINED)
    }

    /// Files by their names; none where they were left out.
    pub fn files(&self, name: &str) -> Result<Files, JsValue> {
        files_from(&self.get(name))
    }

    /// A choice of yes or no; no where it was left out.
    #[cfg(feature = "wasm-marks")]
    pub fn is_set(&self, name: &str) -> Result<bool, JsValue> {
        let value = self.get(name);
        match value.as_bool() {
            None if !value.is_undefined() => Err(argument(&format!("{name} is true or false"))),
            choice => Ok(choice.unwrap_or_default()),
        }
    }

    /// Who hears of progress; nobody where that was left out.
    pub fn listener(&self) -> Result<super::listener::Listener, JsValue> {
        let on_progress = self.get("onProgress");
        let function = match on_progress.is_undefined() {
            true => None,
            false => {
                let function = on_progress.dyn_into();
                Some(function.map_err(|_| argument("onProgress is a function"))?)
            }
        };
        Ok(super::listener::Listener(function))
    }

    /// All options at once, those that were left out by their defaults.
    #[cfg(feature = "wasm-research")]
    pub fn decoded<T: for<'a> serde::Deserialize<'a>>(&self) -> Result<T, JsValue> {
        let given = Object::new();
        if let Some(options) = self.0.dyn_ref::<Object>() {
            for name in Object::keys(options).iter() {
                let value = Reflect::get(options, &name)?;
                if !value.is_undefined() {
                    Reflect::set(&given, &name, &value)?;
                }
            }
        }
        serde_wasm_bindgen::from_value(given.into()).map_err(|error| argument(&error.to_string()))
    }
}
