//! Progress and cancellation, one trait for both.

use std::ops::ControlFlow;

/// What the work is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Parsing the document and welding its scene.
    Read,
    /// Finding the displacement that carries the mark.
    Embed,
    /// Writing the marked document.
    Write,
    /// Measuring a model, without a key.
    Measure,
    /// Testing a measurement with a key.
    Test,
    /// Trying what a mark survives.
    Forecast,
}

impl Stage {
    /// The stage's name, as scripts and pages see it.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Read => "read",
            Stage::Embed => "embed",
            Stage::Write => "write",
            Stage::Measure => "measure",
            Stage::Test => "test",
            Stage::Forecast => "forecast",
        }
    }
}

/// Told how far the work is; may ask it to stop.
pub trait Progress {
    /// `fraction` is of the stage, from 0 to 1. `Break` ends the work with [`Cancelled`].
    fn report(&mut self, stage: Stage, fraction: f64) -> ControlFlow<()>;
}

impl<F: FnMut(Stage, f64) -> ControlFlow<()>> Progress for F {
    fn report(&mut self, stage: Stage, fraction: f64) -> ControlFlow<()> {
        self(stage, fraction)
    }
}

/// A [`Progress`] for callers who do not care.
pub fn ignore(_: Stage, _: f64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// The caller asked the work to stop; nothing was changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the work was stopped before it was done")]
pub struct Cancelled;

/// Reports, and turns a request to stop into an error that `?` carries up.
pub(crate) fn step(
    progress: &mut dyn Progress,
    stage: Stage,
    fraction: f64,
) -> Result<(), Cancelled> {
    match progress.report(stage, fraction) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Cancelled),
    }
}
