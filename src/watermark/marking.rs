//! Marking: read, displace, write, and read back.

use super::displace::{Moved, Used, displacement, write};
use super::extract::read_back;
use super::read_back::{is_read, is_seen_at_once};
use super::report::Unshown;
use super::unshown::{UsedByMesh, mark_unshown};
use super::{EmbedOptions, Error, Extraction, Model};
use crate::bits::Payload;
use crate::carrier::{Carrier, CarrierError, Mark};
use crate::code::{Checked, Codeword};
use crate::document::{Document, Written};
use crate::geometry::{Leeway, Parts};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::Stage;
use crate::scene::Scene;

/// What the owner of a model should know that holds no more.
pub(super) const WITHOUT_PAYLOAD: &str = "the model is too small to hold a payload: its mark says that it is yours, and no tag or number";

/// A mark that was read back.
pub(super) struct Held {
    /// `None` where the model holds a mark without one only.
    pub payload: Option<Payload>,
    pub marked: Marked,
    pub read_back: Extraction,
}

/// Marks a model with a payload or, where it cannot hold one, without, and reads the mark back.
pub(super) fn hold(
    model: &mut Model,
    payload: Payload,
    key: &Key,
    options: &EmbedOptions,
) -> Result<Held, Error> {
    match hold_content(model, Some(payload), key, options) {
        Err(Error::Carrier(CarrierError::NoPayload { .. }) | Error::Unreadable { .. }) => {
            hold_content(model, None, key, options)
        }
        held => held,
    }
}

fn hold_content(
    model: &mut Model,
    payload: Option<Payload>,
    key: &Key,
    options: &EmbedOptions,
) -> Result<Held, Error> {
    let marked = mark(model, payload, key, options)?;
    let unreadable = || Error::Unreadable {
        has_axes: Carrier::has_axes(&marked.host),
    };
    // What has no payload is too weak for a search to find.
    if payload.is_none() && !is_seen_at_once(&marked.marked, key, payload, model)? {
        return Err(unreadable());
    }
    let mut marked_files = model.files.clone();
    marked_files.extend(marked.written.files.clone());
    let copy = Model::new(&marked.written.model).with_files(&marked_files);
    let copy = copy.with_progress(model).into();
    let read_back = read_back(copy, key, options.asked())?;
    if !is_read(&read_back, payload) {
        return Err(unreadable());
    }
    Ok(Held {
        payload,
        marked,
        read_back,
    })
}

/// What is left of an embedding once it is written.
pub(super) struct Marked {
    pub host: Mesh,
    pub parts: Parts,
    pub marked: Mesh,
    pub written: Written,
    pub unshown: Vec<Unshown>,
    /// Where strays lie, in words.
    pub strays: Option<String>,
    /// Pairs of triangles that cut each other and did not before.
    pub num_cuts: usize,
    pub recipe: Recipe,
}

/// How a model was marked: what another message needs no search for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Recipe {
    pub shown: Vec<Used>,
    pub unshown: UsedByMesh,
}

/// Reads, displaces and writes.
fn mark(
    model: &mut Model,
    payload: Option<Payload>,
    key: &Key,
    options: &EmbedOptions,
) -> Result<Marked, Error> {
    model.step(Stage::Read, 0.0)?;
    let mut document = Document::read(model.bytes, model.files)?;
    let scene = Scene::gather(&document)?;
    scene.check_movable()?;
    model.step(Stage::Embed, 0.0)?;

    let codeword = match payload {
        Some(payload) => Codeword::new(Checked::new(key).message(payload)),
        None => Codeword::Presence,
    };
    let mark = Mark {
        key,
        codeword: &codeword,
    };
    let parts = scene.parts();
    let leeway = Leeway::new(&scene.mesh, &parts, options.bounds()?);
    let (displacement, shown) =
        displacement(&scene, &leeway, &mark, payload.is_some(), options, model)?;

    model.step(Stage::Write, 0.0)?;
    let Moved {
        positions,
        num_cuts,
        ..
    } = write(model, &mut document, &scene, &parts, &leeway, displacement)?;
    drop(leeway);
    let (unshown, of_unshown) =
        mark_unshown(model, &mut document, &scene, &mark, payload, options)?;
    let strays = scene.strays_in_words();
    let host = scene.mesh;
    let written = document.write()?;
    drop(document);
    let marked = host.with_positions(positions);
    model.step(Stage::Write, 1.0)?;
    Ok(Marked {
        host,
        parts,
        marked,
        written,
        unshown,
        strays,
        num_cuts,
        recipe: Recipe {
            shown,
            unshown: of_unshown,
        },
    })
}
