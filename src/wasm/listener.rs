//! A caller's callback and signal.

use crate::{Progress, Stage};
use js_sys::Function;
use std::ops::ControlFlow;
use wasm_bindgen::prelude::*;
use web_sys::AbortSignal;

/// Hears of progress, and can end the work.
pub struct Listener {
    pub on_progress: Option<Function>,
    pub signal: Option<AbortSignal>,
}

impl Progress for Listener {
    fn report(&mut self, stage: Stage, fraction: f64) -> ControlFlow<()> {
        let heard = self
            .on_progress
            .as_ref()
            .map(|f| f.call2(&JsValue::NULL, &stage.name().into(), &fraction.into()));
        // A callback that throws has asked for the work to stop.
        let stopped =
            matches!(heard, Some(Err(_))) || self.signal.as_ref().is_some_and(AbortSignal::aborted);
        if stopped {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}
