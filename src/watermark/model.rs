//! What a pipeline works on.

use super::Error;
use crate::document::{Document, Files};
use crate::progress::{Cancelled, Progress, Stage, step};
use std::ops::ControlFlow;

/// A model to work on: a `.glb`, or a `.gltf` with the files that it names. Where the bytes are all there is, a reference to them
/// will do.
///
/// ```
/// use meshmark::{Files, Model, Stage, demo_model, measure};
/// use std::ops::ControlFlow;
///
/// # fn main() -> Result<(), meshmark::Error> {
/// let (model, files) = (demo_model(), Files::new());
/// let mut report = |stage: Stage, fraction: f64| {
///     eprintln!("{} {:.0} %", stage.name(), 100.0 * fraction);
///     ControlFlow::Continue(())
/// };
/// let evidence = measure(Model::new(&model).with_files(&files).with_progress(&mut report))?;
/// # Ok(())
/// # }
/// ```
pub struct Model<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) files: &'a Files,
    progress: Option<&'a mut dyn Progress>,
}

impl<'a> Model<'a> {
    /// A model of one file.
    pub fn new(bytes: &'a [u8]) -> Model<'a> {
        static NONE: Files = Files::new();
        Model {
            bytes,
            files: &NONE,
            progress: None,
        }
    }

    /// The same with files, keyed by the URIs that the model names them by: see [`file_names`](crate::file_names).
    pub fn with_files(self, files: &'a Files) -> Model<'a> {
        Model { files, ..self }
    }

    /// The same, watched: `progress` hears how far the work is, and can end it.
    pub fn with_progress(self, progress: &'a mut dyn Progress) -> Model<'a> {
        Model {
            progress: Some(progress),
            ..self
        }
    }

    /// Says how far the work is.
    pub(super) fn step(&mut self, stage: Stage, fraction: f64) -> Result<(), Cancelled> {
        step(self, stage, fraction)
    }
}

impl<'a, B: AsRef<[u8]> + ?Sized> From<&'a B> for Model<'a> {
    fn from(bytes: &'a B) -> Model<'a> {
        Model::new(bytes.as_ref())
    }
}

impl Progress for Model<'_> {
    fn report(&mut self, stage: Stage, fraction: f64) -> ControlFlow<()> {
        match &mut self.progress {
            Some(progress) => progress.report(stage, fraction),
            None => ControlFlow::Continue(()),
        }
    }
}

/// The external buffers that a model names, percent-decoded, each once: the [`Files`] that it is to be opened with. A `.glb` mostly
/// names none.
///
/// # Errors
/// Where the model cannot be read.
pub fn file_names(model: &[u8]) -> Result<Vec<String>, Error> {
    Ok(Document::file_names(model)?)
}

/// A model whose geometry is not compressed: the model itself, if it is none such. Second come the files that it names and that differ
/// from those that were given, of a `.gltf`.
///
/// # Errors
/// Where the model cannot be read.
pub fn decompress<'a>(model: impl Into<Model<'a>>) -> Result<(Vec<u8>, Files), Error> {
    let model = model.into();
    let written = Document::read(model.bytes, model.files)?.write_plain()?;
    Ok((written.model, written.files))
}
