//! Models and what lies beside them, from disk.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::format::{Format, Wrapping, recognize, unwrap};
use crate::surface::Triangles;
use meshmark::internals::digest::sha256;
use meshmark::internals::document::Document;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::Scene;
use meshmark::{Files, Model, Surface, Suspect, decompress, file_names};
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// What evidence begins with. A file is not read as evidence because it begins so: a suspect's maker would choose how it is judged.
const EVIDENCE: &[u8] = b"MMEV";

/// A model as it was found on disk.
pub struct Opened {
    bytes: Vec<u8>,
    files: Files,
    wrapping: Wrapping,
    /// Of the file on disk.
    pub sha256: String,
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

    /// To work on.
    pub fn unwatched(&self) -> Model<'_> {
        Model::new(&self.bytes).with_files(&self.files)
    }

    /// Takes the compression out of it.
    pub fn decompress(&mut self) -> Result<(), Failure> {
        let (bytes, files) = decompress(Model::new(&self.bytes).with_files(&self.files))?;
        self.bytes = bytes;
        self.files.extend(files);
        Ok(())
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
        (Format::Gltf, content) => with_files(path, content),
        (format, _) => Err(format.refused(path)),
    }
}

/// What is to be checked: glTF, or a surface in another format.
pub fn open_suspect(path: &Path) -> Result<Found, Failure> {
    let (format, content) = find(path)?;
    Ok(match format {
        Format::Gltf => Found::Model(with_files(path, content)?),
        format => Found::Surface(Triangles::read(path, format, &content.bytes)?),
    })
}

/// What is in a file.
struct Content {
    bytes: Vec<u8>,
    wrapping: Wrapping,
    sha256: String,
}

/// A file's kind and its content.
fn find(path: &Path) -> Result<(Format, Content), Failure> {
    let file = load(path)?;
    let sha256 = sha256(&file);
    let (bytes, wrapping) = unwrap(path, file)?;
    if bytes.starts_with(EVIDENCE) {
        return Err(Failure::NotAsked(path.to_owned()));
    }
    let format = recognize(path, &bytes)?;
    Ok((
        format,
        Content {
            bytes,
            wrapping,
            sha256,
        },
    ))
}

fn with_files(path: &Path, content: Content) -> Result<Opened, Failure> {
    let Content {
        bytes,
        wrapping,
        sha256,
    } = content;
    let mut files = Files::new();
    let mut known = BTreeSet::new();
    // A model that cannot be read names no files; whoever reads it next says what is wrong.
    for uri in file_names(&bytes).unwrap_or_default() {
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
        bytes,
        files,
        wrapping,
        sha256,
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
