//! Copies: one host under one key, a number for each buyer. What does not depend on the number is done once.

use super::displace::{Moved, Used, displacement_again, host, write};
use super::embed::embed_in;
use super::extract::detect;
use super::judge::Judge;
use super::marking::Recipe;
use super::read_back::is_read;
use super::report::{Extraction, Input};
use super::{EmbedOptions, EmbedReport, Error, Model};
use crate::bits::Payload;
use crate::carrier::{Carrier, Mark, Prepared};
use crate::code::{Checked, Codeword, Numbers};
use crate::digest::sha256;
use crate::document::{Document, Files, Written};
use crate::geometry::{Distortion, Leeway, Parts};
use crate::key::Key;
use crate::scene::Scene;
use glam::DVec3;
use serde::Serialize;

/// The number whose copy a plan is tried with.
const SPECIMEN: u64 = 0;

/// A copy whose exponent is a smaller part of the specimen's is said to be weaker.
const WEAKER: f64 = 0.75;

/// A host that is ready to be stamped with any number. It holds the host and the key: who has it can make copies and read them, so it is as
/// secret as the key.
pub struct Plan {
    pub(super) stored: Stored,
    shown: Place,
    unshown: Vec<Place>,
}

/// What a plan is made from.
pub(super) struct Stored {
    pub host: Vec<u8>,
    pub files: Files,
    pub key: Key,
    pub options: EmbedOptions,
    pub recipe: Recipe,
    /// What was read of the specimen.
    pub ln_p: f64,
}

/// A scene that is marked for itself: the one that is shown, or a mesh that no scene shows.
struct Place {
    scene: Scene,
    parts: Parts,
    leeway: Leeway<'static>,
    carriers: Vec<Prepared>,
}

/// The host with a mark.
struct Copied {
    written: Written,
    positions: Vec<DVec3>,
    num_cuts: usize,
    /// 0 where its payload was not read at once.
    ln_p: f64,
}

/// A copy.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Stamped {
    /// The main file.
    pub model: Vec<u8>,
    /// The external buffers that changed.
    pub files: Files,
    /// What was done, and what was read back.
    pub report: StampReport,
}

/// What a stamp did.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct StampReport {
    /// The copy's number.
    pub number: u64,
    /// The payload that stands for it under this key: what `detect` reads.
    pub payload: u64,
    /// How many vertices moved.
    pub moved_vertices: usize,
    /// Triangles of the scene. Where a ledger keeps them, a tracing can say how many a copy that leaked has left.
    pub triangles: usize,
    /// RMS displacement over all vertices, as a fraction of the diagonal.
    pub rms_rel: f64,
    /// Maximum displacement, as a fraction of that diagonal.
    pub max_rel: f64,
    /// Pairs of triangles of one part that cut each other now, and neither did nor touched before: none.
    pub new_intersections: usize,
    /// Natural logarithm of the bound, read from the copy.
    pub ln_p: f64,
    /// Whether that is less than three quarters of what the plan's specimen reached: the forecast was made with that one.
    pub is_weaker: bool,
    /// SHA-256 of the main file.
    pub marked_sha256: String,
}

/// Looks at a model once for all its copies. It is marked as [`embed`](super::embed) does it, with the number 0, which is best given to no buyer: the report
/// is of that specimen, and says what the mark of the copies is likely to survive.
///
/// # Errors
/// As [`embed`](super::embed); [`Error::NoCopies`] where the model is too small to hold a number; [`Error::NotInCopies`] where LOCAL is asked
/// for.
pub fn prepare<'a>(
    model: impl Into<Model<'a>>,
    key: &Key,
    options: &EmbedOptions,
) -> Result<(Plan, EmbedReport), Error> {
    if options.asked().is_some() {
        return Err(Error::NotInCopies);
    }
    let model = model.into();
    let (bytes, files) = (model.bytes.to_vec(), model.files.clone());
    let specimen = Numbers::new(key).payload(SPECIMEN)?;
    let (embedding, recipe) = embed_in(model, specimen, key, options)?;
    let report = embedding.report;
    if report.number.is_none() {
        return Err(Error::NoCopies);
    }
    let ln_p = report.read_back.details().ln_p;
    let plan = Plan::of(Stored {
        host: bytes,
        files,
        key: key.clone(),
        options: options.clone(),
        recipe,
        ln_p,
    })?;
    Ok((plan, report))
}

impl Plan {
    /// Looks at a host for which all is chosen.
    pub(super) fn of(stored: Stored) -> Result<Plan, Error> {
        let Stored { key, options, .. } = &stored;
        let document = Document::read(&stored.host, &stored.files)?;
        let scene = Scene::gather(&document)?;
        let shown = Place::new(scene, &stored.recipe.shown, key, options)?;
        let mut unshown = Vec::new();
        for (mesh, used) in &stored.recipe.unshown {
            let scene = Scene::of_mesh(&document, *mesh)?;
            unshown.push(Place::new(scene, used, key, options)?);
        }
        drop(document);
        Ok(Plan {
            stored,
            shown,
            unshown,
        })
    }

    /// A copy with a number, 0 to 2^48 - 1. The same plan and number give the same bytes on every machine. They are not those that
    /// [`embed`](super::embed) gives, which takes more rounds.
    ///
    /// The copy is read back before it is returned.
    ///
    /// # Errors
    /// [`Error::Payload`] for a number out of range; [`Error::Unreadable`] where the number cannot be found again in the copy.
    pub fn stamp(&self, number: u64) -> Result<Stamped, Error> {
        let payload = Numbers::new(&self.stored.key).payload(number)?;
        let codeword = Codeword::new(Checked::new(&self.stored.key).message(payload));
        let mark = Mark {
            key: &self.stored.key,
            codeword: &codeword,
        };
        let mut copy = self.copy(&mark, payload, false)?;
        if self.is_weaker(copy.ln_p) {
            copy = self.copy(&mark, payload, true)?;
        }
        if copy.ln_p == 0.0 {
            let found = self.read_as_anybody(&copy.written)?;
            if !is_read(&found, Some(payload)) {
                return Err(Error::Unreadable {
                    has_axes: Carrier::has_axes(&self.shown.scene.mesh),
                });
            }
            copy.ln_p = found.details().ln_p;
        }
        let host = &self.shown.scene.mesh;
        let distortion = Distortion::between(&host.positions, &copy.positions);
        let report = StampReport {
            number,
            payload: payload.number(),
            moved_vertices: distortion.num_moved,
            triangles: host.triangles.len(),
            rms_rel: distortion.rms_rel,
            max_rel: distortion.max_rel,
            new_intersections: copy.num_cuts,
            ln_p: copy.ln_p,
            is_weaker: self.is_weaker(copy.ln_p),
            marked_sha256: sha256(&copy.written.model),
        };
        Ok(Stamped {
            model: copy.written.model,
            files: copy.written.files,
            report,
        })
    }

    fn is_weaker(&self, ln_p: f64) -> bool {
        ln_p > WEAKER * self.stored.ln_p
    }

    /// The host with a mark, and what is read of it where it is looked for at once.
    fn copy(&self, mark: &Mark, payload: Payload, is_thorough: bool) -> Result<Copied, Error> {
        let model = Model::new(&self.stored.host).with_files(&self.stored.files);
        let write = |place: &Place| place.write(&model, mark, &self.stored.options, is_thorough);
        let (mut document, moved) = write(&self.shown)?;
        for place in &self.unshown {
            let (_, moved) = write(place)?;
            place.scene.scatter(&mut document, &moved.displacement)?;
        }
        let written = document.write()?;
        drop(document);
        let mesh = self.shown.scene.mesh.with_positions(moved.positions);
        let mut readings = Carrier::STANDARD.map(|_| Default::default());
        for prepared in &self.shown.carriers {
            readings[prepared.carrier() as usize] = prepared.read(&mesh, &self.stored.key);
        }
        let found = Judge::new(&self.stored.key, None, Input::Model).conclude(&readings);
        Ok(Copied {
            written,
            positions: mesh.positions,
            num_cuts: moved.num_cuts,
            ln_p: match is_read(&found, Some(payload)) {
                true => found.details().ln_p,
                false => 0.0,
            },
        })
    }

    /// Reads a copy as a detector does that knows no more than the key.
    fn read_as_anybody(&self, copy: &Written) -> Result<Extraction, Error> {
        let mut files = self.stored.files.clone();
        files.extend(copy.files.clone());
        detect(
            Model::new(&copy.model).with_files(&files),
            &self.stored.key,
            None,
        )
    }
}

impl Place {
    fn new(scene: Scene, used: &[Used], key: &Key, options: &EmbedOptions) -> Result<Place, Error> {
        let parts = scene.parts();
        let leeway = Leeway::new(&scene.mesh, &parts, options.bounds()?).into_owned();
        let own = host(&scene, &scene.mesh, &leeway, None, options);
        let carriers = used.iter();
        let carriers = carriers
            .filter_map(|used| used.carrier.prepare(&own, key, &used.chosen))
            .collect();
        Ok(Place {
            scene,
            parts,
            leeway,
            carriers,
        })
    }

    /// The host with the mark here.
    fn write(
        &self,
        model: &Model,
        mark: &Mark,
        options: &EmbedOptions,
        is_thorough: bool,
    ) -> Result<(Document, Moved), Error> {
        let mut document = Document::read(model.bytes, model.files)?;
        let displacement = displacement_again(
            &self.scene,
            &self.leeway,
            mark,
            &self.carriers,
            options,
            is_thorough,
        );
        let moved = write(
            model,
            &mut document,
            &self.scene,
            &self.parts,
            &self.leeway,
            displacement,
        )?;
        Ok((document, moved))
    }
}

impl Payload {
    /// The payload of the copy with a number, 0 to 2^48 - 1, under a key.
    ///
    /// # Errors
    /// [`PayloadError::Range`](crate::PayloadError::Range) for a larger one.
    pub fn of_copy(number: u64, key: &Key) -> Result<Payload, crate::PayloadError> {
        Numbers::new(key).payload(number)
    }

    /// The number of the copy that has this payload under a key. Every payload has one, whether such a copy was made or not.
    pub fn copy_number(self, key: &Key) -> u64 {
        Numbers::new(key).number(self)
    }
}
