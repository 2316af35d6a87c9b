//! Models and what lies beside them, from disk.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::format::{Format, Wrapping, recognize, unwrap};
use crate::surface::Triangles;
use meshmark::internals::document::Document;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::Scene;
use meshmark::{Files, Model, Surface, Suspect, file_names};
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// What evidence begins with. A file is not read as evidence because it begins so: a suspect's maker would choose how it is judged.
const EVIDENCE: &[u8] = b"MMEV";

/// A model as it was found on disk.
pub struct Opened {
    bytes: Vec<u8>,
    files: Files,
    wrapping: Wrapping,
}

/// What is to be checked, as it was found on disk.
pub enum Found {
    Model(Opened),
    Surface(Triangles),
}

impl Opened {
    /// To work on, watched by a clock.
    pub fn model<'a>(&'a self, clock: &'a mut Clock) -> Model<'a> {
        Model::new(&self.bytes)
            .with_files(&self.files)
            .with_progress(clock)
    }

    /// A changed model in what this one came wrapped in.
    pub fn wrapped(&self, path: &Path, model: &[u8]) -> Result<Vec<u8>, Failure> {
        self.wrapping
            .wrap(model)
            .map_err(|error| Failure::file(path, error))
    }

    /// The mesh, as it is seen by whoever checks the model.
    pub fn mesh(&self) -> Result<Mesh, Failure> {
        let document = Document::read(&self.bytes, &self.files).map_err(Failure::of)?;
        let scene = Scene::gather(&document).map_err(Failure::of)?;
        Ok(scene.mesh)
    }
}

impl Found {
    /// To look at, watched by a clock.
    pub fn suspect<'a>(&'a self, clock: &'a mut Clock) -> Suspect<'a> {
        match self {
            Found::Model(model) => model.model(clock).into(),
            Found::Surface(Triangles {
                positions,
                triangles,
            }) => Surface::new(positions, triangles)
                .with_progress(clock)
                .into(),
        }
    }
}

/// A model and the external buffers that it names, which are looked for beside it.
pub fn open(path: &Path) -> Result<Opened, Failure> {
    match find(path)? {
        (Format::Gltf, bytes, wrapping) => with_files(path, bytes, wrapping),
        (format, ..) => Err(format.refused(path)),
    }
}

/// What is to be checked: glTF, or a surface in another format.
pub fn open_suspect(path: &Path) -> Result<Found, Failure> {
    let (format, bytes, wrapping) = find(path)?;
    Ok(match format {
        Format::Gltf => Found::Model(with_files(path, bytes, wrapping)?),
        format => Found::Surface(Triangles::read(path, format, &bytes)?),
    })
}

/// A file's kind, its content, and what that was wrapped in.
fn find(path: &Path) -> Result<(Format, Vec<u8>, Wrapping), Failure> {
    let (bytes, wrapping) = unwrap(path, load(path)?)?;
    if bytes.starts_with(EVIDENCE) {
        return Err(Failure::NotAsked(path.to_owned()));
    }
    Ok((recognize(path, &bytes)?, bytes, wrapping))
}

fn with_files(path: &Path, model: Vec<u8>, wrapping: Wrapping) -> Result<Opened, Failure> {
    let mut files = Files::new();
    let mut known = BTreeSet::new();
    // A model that cannot be read names no files; whoever reads it next says what is wrong.
    for uri in file_names(&model).unwrap_or_default() {
        let buffer = inside(path, &uri)?;
        // A small model could have a large file loaded as often as it finds another name for it.
        if let Ok(place) = buffer.canonicalize()
            && !known.insert(place)
        {
            let words = format!("{uri:?} is the same file as another buffer's");
            return Err(Failure::Words(words));
        }
        files.insert(uri, load(&buffer)?);
    }
    Ok(Opened {
        bytes: model,
        files,
        wrapping,
    })
}

/// A file beside another. A model's URIs are a stranger's words: they may not lead out of its folder.
pub fn inside(path: &Path, name: &str) -> Result<PathBuf, Failure> {
    let is_inside = |component| matches!(component, Component::Normal(_) | Component::CurDir);
    if !Path::new(name).components().all(is_inside) {
        let words = format!("{name:?} lies outside of the model's folder");
        return Err(Failure::Words(words));
    }
    Ok(path.parent().unwrap_or(Path::new("")).join(name))
}

pub fn load(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| Failure::file(path, error))
}

/// A file of UTF-8.
pub fn load_text(path: &Path) -> Result<String, Failure> {
    String::from_utf8(load(path)?)
        .map_err(|_| Failure::Words(format!("{} is not text in UTF-8", path.display())))
}

pub fn store(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    std::fs::write(path, bytes).map_err(|error| Failure::file(path, error))
}
