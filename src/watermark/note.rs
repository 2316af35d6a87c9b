//! Notes: a text in the distances of all vertices from the centroid, beside the mark or without one. Read with the key alone.

use super::displace::write;
use super::embed::unpacked;
use super::{Error, Model, Verdict};
use crate::carrier::CarrierError;
use crate::carrier::direction::{Cells, NUM_TESTS};
use crate::code::{Block, TextCheck, TextError};
use crate::detection::{LN_P_FOUND, Statistic, union};
use crate::digest::sha256;
use crate::document::{Document, Files};
use crate::geometry::{Bounds, Deformation, Distortion, Leeway};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::Stage;
use crate::scene::Scene;
use serde::Serialize;
use std::f64::consts::LN_2;

/// Step of the quantizers, in units of the frame: an RMS displacement of 0.07 to 0.09 % of the diagonal.
const STEP: f64 = 0.0125;

/// A model with a note.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct NoteEmbedding {
    /// The main file: as the host's, but for positions and the bounds of their accessors.
    pub model: Vec<u8>,
    /// The external buffers that changed.
    pub files: Files,
    /// What was done, and what was read back.
    pub report: NoteReport,
}

/// How much a note holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct NoteSize {
    /// Bits of UTF-8.
    pub bits: usize,
    /// Characters. Of a capacity: of ASCII, for others take more bytes.
    pub characters: usize,
}

/// What the embedding of a note did.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct NoteReport {
    /// The note.
    pub text: String,
    /// How much that is.
    pub size: NoteSize,
    /// How much this model could hold.
    pub capacity: NoteSize,
    /// The code.
    pub block: Block,
    /// Welded vertices of the scene.
    pub vertices: usize,
    /// How many of them moved.
    pub moved_vertices: usize,
    /// RMS displacement over all vertices, as a fraction of the diagonal of the host's bounding box.
    pub rms_rel: f64,
    /// Maximum displacement, as a fraction of that diagonal.
    pub max_rel: f64,
    /// As in a mark's report: at most 0.02.
    pub worst_part_rel: f64,
    /// As in a mark's report: at most 20.
    pub worst_turn_degrees: f64,
    /// What is to be known of the copy.
    pub warnings: Vec<String>,
    /// The output, read again from its bytes.
    pub read_back: NoteReading,
    /// SHA-256 of the main file before.
    pub host_sha256: String,
    /// SHA-256 of the main file after.
    pub marked_sha256: String,
}

/// The answer to "does this model carry a note of this key?".
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct NoteReading {
    /// `found`, `none`, or `cannot-check` for a model with too few vertices.
    pub verdict: Verdict,
    /// The note.
    pub text: Option<String>,
    /// How much that is; 0 without a note.
    pub size: NoteSize,
    /// Natural logarithm of a bound of the probability that any note is read in a model that was made without the key: all
    /// texts of this code's length, all codes and all ways of reading are charged; at most 0.
    pub ln_p: f64,
    /// Weighted agreement of the cells with the note: 1 is perfect, 0 is chance.
    pub agreement: f64,
}

/// Writes a text into a model under a key: 1 to 29 bytes of UTF-8, as [`note_capacity`] allows.
///
/// The bytes are read back and tested before they are returned. A mark may go on top, and should go after the note: RING's symbols do
/// not stand a note's displacement, which is larger.
///
/// # Errors
/// Where the model cannot be read, or the text is longer than the model can hold; [`Error::NoteUnreadable`] where the note cannot be
/// found again; [`Error::Cancelled`] where its progress was told to stop. Nothing is returned then.
pub fn embed_note<'a>(
    model: impl Into<Model<'a>>,
    text: &str,
    key: &Key,
) -> Result<NoteEmbedding, Error> {
    let mut model = model.into();
    let block = Block::for_text(text)?;
    let message = TextCheck::new(key).message(text, block)?;
    model.step(Stage::Read, 0.0)?;
    let mut document = Document::read(model.bytes, model.files)?;
    let scene = Scene::gather(&document)?;
    scene.check_movable()?;
    let room = room(&scene)?;
    if room < block {
        return Err(Error::Text(TextError::TooLong {
            bytes: text.len(),
            capacity: room.text_bytes(),
        }));
    }
    model.step(Stage::Embed, 0.0)?;
    let mut displacement = Cells::new(key, block, STEP).embed(&scene.mesh, &message)?;
    scene.admissible.project(&mut displacement);
    let parts = scene.parts();
    let leeway = Leeway::new(&scene.mesh, &parts, Bounds::STRONG);
    leeway.keep(&scene.mesh.positions, &mut displacement, &scene.admissible);
    model.step(Stage::Write, 0.0)?;
    let positions = write(&model, &mut document, &scene, &parts, &leeway, displacement)?.positions;
    let marked = scene.mesh.with_positions(positions);
    let deformation = Deformation::between(&scene.mesh, &parts, &marked.positions);
    let distortion = Distortion::between(&scene.mesh.positions, &marked.positions);
    let written = document.write()?;
    model.step(Stage::Write, 1.0)?;

    let mut marked_files = model.files.clone();
    marked_files.extend(written.files.clone());
    let copy = Model::new(&written.model).with_files(&marked_files);
    let read_back = read_note(copy.with_progress(&mut model), key)?;
    if read_back.text.as_deref() != Some(text) {
        return Err(Error::NoteUnreadable);
    }
    Ok(NoteEmbedding {
        report: NoteReport {
            text: text.to_owned(),
            size: NoteSize::of(text),
            capacity: NoteSize::room(room),
            block,
            vertices: scene.mesh.positions.len(),
            moved_vertices: distortion.num_moved,
            rms_rel: distortion.rms_rel,
            max_rel: distortion.max_rel,
            worst_part_rel: deformation.worst_part,
            worst_turn_degrees: deformation.worst_turn,
            warnings: unpacked(&written),
            read_back,
            host_sha256: sha256(model.bytes),
            marked_sha256: sha256(&written.model),
        },
        model: written.model,
        files: written.files,
    })
}

/// How long a note a model can hold.
///
/// # Errors
/// Where the model cannot be read, or is too small for any note.
pub fn note_capacity<'a>(model: impl Into<Model<'a>>) -> Result<NoteSize, Error> {
    let model = model.into();
    let scene = Scene::gather(&Document::read(model.bytes, model.files)?)?;
    Ok(NoteSize::room(room(&scene)?))
}

/// Reads the note of a key, with nothing else known.
///
/// # Errors
/// As [`measure`](crate::measure).
pub fn read_note<'a>(model: impl Into<Model<'a>>, key: &Key) -> Result<NoteReading, Error> {
    let mut model = model.into();
    model.step(Stage::Read, 0.0)?;
    let mesh = Scene::gather(&Document::read(model.bytes, model.files)?)?.mesh;
    let mut best = NoteReading::none(Cells::capacity(mesh.positions.len()));
    for (number, block) in Block::ALL.into_iter().enumerate() {
        model.step(Stage::Test, number as f64 / Block::ALL.len() as f64)?;
        for found in notes(&mesh, key, block) {
            if found.ln_p < best.ln_p.min(LN_P_FOUND) {
                best = found;
            }
        }
    }
    model.step(Stage::Test, 1.0)?;
    Ok(best)
}

/// The longest block that a scene's vertices carry, those that cannot move left out.
fn room(scene: &Scene) -> Result<Block, CarrierError> {
    let movable = scene.mesh.positions.len() - scene.admissible.fixed.len();
    Cells::capacity(movable).ok_or(CarrierError::TooFewHosts {
        needed: Cells::num_vertices(Block::Tc128),
        available: movable,
    })
}

/// The texts that are in a mesh, however it is read, whose check bits hold.
fn notes(mesh: &Mesh, key: &Key, block: Block) -> impl Iterator<Item = NoteReading> {
    let check = TextCheck::new(key);
    let readings = Cells::new(key, block, STEP).read(mesh);
    readings.into_iter().filter_map(move |reading| {
        let message = reading.message(|message| check.text(message).is_some())?;
        let text = check.text(&message)?;
        let statistic = reading.statistic(&block.encode(&message));
        Some(NoteReading::found(text, block, statistic))
    })
}

impl NoteSize {
    fn of(text: &str) -> NoteSize {
        NoteSize {
            bits: 8 * text.len(),
            characters: text.chars().count(),
        }
    }

    fn room(block: Block) -> NoteSize {
        NoteSize {
            bits: 8 * block.text_bytes(),
            characters: block.text_bytes(),
        }
    }
}

impl NoteReading {
    fn none(room: Option<Block>) -> NoteReading {
        NoteReading {
            verdict: if room.is_some() {
                Verdict::None
            } else {
                Verdict::CannotCheck
            },
            text: None,
            size: NoteSize::default(),
            ln_p: 0.0,
            agreement: 0.0,
        }
    }

    fn found(text: String, block: Block, statistic: Statistic) -> NoteReading {
        let ways = f64::from(NUM_TESTS) * Block::ALL.len() as f64;
        let charge = NoteSize::room(block).bits as f64 * LN_2 + libm::log(ways);
        NoteReading {
            verdict: Verdict::Found,
            size: NoteSize::of(&text),
            text: Some(text),
            ln_p: union(statistic.ln_p(), charge),
            agreement: statistic.agreement(),
        }
    }
}
