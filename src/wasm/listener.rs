//! A caller's callback.

use crate::{Progress, Stage};
use js_sys::Function;
use std::ops::ControlFlow;
use wasm_bindgen::prelude::*;

/// Hears of progress, and ends the work by throwing.
pub struct Listener(pub Option<Function>);

impl Progress for Listener {
    fn report(&mut self, stage: Stage, fraction: f64) -> ControlFlow<()> {
        let heard = self
            .0
            .as_ref()
            .map(|f| f.call2(&JsValue::NULL, &stage.name().into(), &fraction.into()));
        match heard {
            Some(Err(_)) => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }
}
