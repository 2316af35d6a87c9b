//! A model that was made from another, written whole or not at all.
//!
//! All files are written under names of their own first, and take their places when the last of them is complete; what stood there
//! before is put back if one cannot. So no run leaves half a model, in place or elsewhere.

use crate::failure::Failure;
use crate::file::{Opened, inside, load};
use clap::Args;
use meshmark::Files;
use meshmark::internals::digest::sha256;
use meshmark::internals::document::Document;
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};

/// Where a changed model goes.
#[derive(Args)]
pub struct Output {
    /// Where the marked model goes: a file, or a folder. What a .gltf names (buffers, textures) goes beside it, whether it changed or not
    #[arg(required_unless_present = "in_place")]
    output: Option<PathBuf>,
    /// Write over the input, and over its buffers
    #[arg(long, conflicts_with = "output")]
    in_place: bool,
}

/// What was written, for the report.
#[derive(Serialize)]
pub struct Stored {
    /// The model, then what it names: each below the model's folder.
    written: Vec<String>,
    /// What the model names and was not written beside it, because it is not beside the input, or lies outside of its folder.
    missing: Vec<String>,
    /// Of the model's file.
    #[serde(skip)]
    pub sha256: String,
}

impl Output {
    /// To a file or a folder.
    pub fn to(output: PathBuf) -> Output {
        Output {
            output: Some(output),
            in_place: false,
        }
    }

    /// The file that the model becomes.
    fn model(&self, input: &Path) -> PathBuf {
        match &self.output {
            Some(output) if is_folder(output) => output.join(input.file_name().unwrap_or_default()),
            Some(output) => output.clone(),
            None => input.to_owned(),
        }
    }

    /// Where the record of the marked model goes: beside it, by its name.
    pub fn record(&self, input: &Path) -> PathBuf {
        self.model(input).with_extension("meshmark.json")
    }

    /// Writes a changed model with all that it names: `changed` files anew, the others as they are beside the input.
    pub fn store(
        &self,
        input: &Path,
        host: &Opened,
        model: &[u8],
        changed: &Files,
    ) -> Result<Stored, Failure> {
        let output = self.model(input);
        let wrapped = host.wrapped(&output, model)?;
        let mut plan = Plan::new(&output, &wrapped);
        let mut missing = Vec::new();
        for name in Document::linked_files(model).map_err(Failure::of)? {
            let (from, to) = match (inside(input, &name), inside(&output, &name)) {
                (Ok(from), Ok(to)) => (from, to),
                _ => {
                    missing.push(name);
                    continue;
                }
            };
            match changed.get(&name) {
                Some(bytes) => plan.add(name, to, Content::Bytes(bytes))?,
                None if same_file(&from, &to) => {}
                None if from.is_file() => plan.add(name, to, Content::CopyOf(from))?,
                None => missing.push(name),
            }
        }
        if !self.in_place {
            plan.check_against(input, changed)?;
        }
        let written = plan.files.iter().map(|file| file.name.clone()).collect();
        plan.carry_out()?;
        Ok(Stored {
            written,
            missing,
            sha256: sha256(&wrapped),
        })
    }
}

/// Whether a path is a folder, or says that it is one.
fn is_folder(path: &Path) -> bool {
    path.is_dir()
        || path
            .as_os_str()
            .to_string_lossy()
            .ends_with(['/', std::path::MAIN_SEPARATOR])
}

enum Content<'a> {
    Bytes(&'a [u8]),
    CopyOf(PathBuf),
}

struct Planned<'a> {
    name: String,
    path: PathBuf,
    content: Content<'a>,
}

/// The files to write, the model first.
struct Plan<'a> {
    files: Vec<Planned<'a>>,
}

impl<'a> Plan<'a> {
    fn new(output: &Path, model: &'a [u8]) -> Plan<'a> {
        let name = output.file_name().unwrap_or_default();
        Plan {
            files: vec![Planned {
                name: name.to_string_lossy().into_owned(),
                path: output.to_owned(),
                content: Content::Bytes(model),
            }],
        }
    }

    fn add(&mut self, name: String, path: PathBuf, content: Content<'a>) -> Result<(), Failure> {
        if self.files.iter().any(|file| file.path == path) {
            let words = format!(
                "the model names {name:?}, which is where the marked model goes: choose another name"
            );
            return Err(Failure::Words(words));
        }
        self.files.push(Planned {
            name,
            path,
            content,
        });
        Ok(())
    }

    /// Refuses to write over what the input consists of.
    fn check_against(&self, input: &Path, changed: &Files) -> Result<(), Failure> {
        let mut sources = vec![input.to_owned()];
        for name in changed.keys() {
            sources.push(inside(input, name)?);
        }
        let lost = self
            .files
            .iter()
            .find(|file| sources.iter().any(|source| same_file(source, &file.path)));
        match lost {
            Some(file) => Err(Failure::Words(format!(
                "{} would be overwritten: write the marked model to another folder, or say --in-place",
                file.path.display()
            ))),
            None => Ok(()),
        }
    }

    /// Writes all files, or none.
    fn carry_out(&self) -> Result<(), Failure> {
        let mut undo = Undo::default();
        let mut staged = Vec::with_capacity(self.files.len());
        for file in &self.files {
            undo.make_folders(&file.path)?;
            if file.path.is_dir() {
                let words = format!("{} is a folder", file.path.display());
                return Err(Failure::Words(words));
            }
            let stage = beside(&file.path, "new");
            let bytes;
            let content = match &file.content {
                Content::Bytes(bytes) => bytes,
                Content::CopyOf(source) => {
                    bytes = load(source)?;
                    &*bytes
                }
            };
            undo.made.push(stage.clone());
            fs::write(&stage, content).map_err(|error| Failure::file(&file.path, error))?;
            staged.push((stage, &file.path));
        }
        // The model last: whoever opens it meanwhile finds all that it names.
        for (stage, path) in staged.iter().rev() {
            let failed = |error| Failure::file(path, error);
            if path.exists() {
                let old = beside(path, "old");
                fs::rename(path, &old).map_err(failed)?;
                undo.moved.push((old, path.to_path_buf()));
            }
            fs::rename(stage, path).map_err(failed)?;
            undo.made.push(path.to_path_buf());
        }
        undo.settle();
        Ok(())
    }
}

/// A name of this run's own in the same folder.
fn beside(path: &Path, kind: &str) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{}.{kind}", std::process::id()))
}

/// What is undone where not all could be written.
#[derive(Default)]
struct Undo {
    folders: Vec<PathBuf>,
    made: Vec<PathBuf>,
    /// What stood in the way, and where.
    moved: Vec<(PathBuf, PathBuf)>,
}

impl Undo {
    /// Makes the folders of a file that are not there.
    fn make_folders(&mut self, path: &Path) -> Result<(), Failure> {
        let mut lacking: Vec<&Path> = Vec::new();
        let mut folder = path.parent();
        while let Some(path) = folder.filter(|path| !path.as_os_str().is_empty() && !path.exists())
        {
            lacking.push(path);
            folder = path.parent();
        }
        for path in lacking.into_iter().rev() {
            fs::create_dir(path).map_err(|error| Failure::file(path, error))?;
            self.folders.push(path.to_owned());
        }
        Ok(())
    }

    /// All was written: what stood there before is gone.
    fn settle(&mut self) {
        for (old, _) in self.moved.drain(..) {
            let _ = fs::remove_file(old);
        }
        self.made.clear();
        self.folders.clear();
    }
}

impl Drop for Undo {
    /// What cannot be undone either stays as it is: the error that led here is told.
    fn drop(&mut self) {
        for path in self.made.drain(..).rev() {
            let _ = fs::remove_file(path);
        }
        for (old, path) in self.moved.drain(..).rev() {
            let _ = fs::rename(old, path);
        }
        for folder in self.folders.drain(..).rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
