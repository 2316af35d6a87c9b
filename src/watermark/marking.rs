//! Marking: read, displace, write, and read back as any detector would.

use super::forecast::is_read;
use super::judge::Judge;
use super::report::Input;
use super::{EmbedOptions, Error, Extraction, Model, detect};
use crate::bits::Payload;
use crate::carrier::{Carrier, CarrierError, Host, Mark};
use crate::code::{Checked, Codeword};
use crate::document::{Document, Written};
use crate::geometry::{Distortion, Leeway, Parts};
use crate::key::Key;
use crate::mesh::{Admissible, Mesh};
use crate::progress::{Progress, Stage};
use crate::scene::Scene;
use glam::DVec3;

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
    if payload.is_none() && !is_seen_at_once(&marked.marked, key, model)? {
        return Err(unreadable());
    }
    let mut marked_files = model.files.clone();
    marked_files.extend(marked.written.files.clone());
    let copy = Model::new(&marked.written.model).with_files(&marked_files);
    let read_back = detect(copy.with_progress(model), key, None)?;
    if !is_read(&read_back, payload) {
        return Err(unreadable());
    }
    Ok(Held {
        payload,
        marked,
        read_back,
    })
}

/// Whether a mark without a payload shows in the mesh as it is. What is so weak is not found by a search.
fn is_seen_at_once(mesh: &Mesh, key: &Key, progress: &mut dyn Progress) -> Result<bool, Error> {
    let mut readings = Carrier::ALL.map(|_| Default::default());
    for carrier in Carrier::ALL {
        readings[carrier as usize] = carrier.read_at_once(mesh, key, progress)?;
    }
    let read = Judge::new(key, None, Input::Model).conclude(&readings);
    Ok(is_read(&read, None))
}

/// Whether the model is refused for what it is, not for what was asked.
pub(super) fn is_of_the_model(refusal: &Error) -> bool {
    match refusal {
        Error::Carrier(refusal) => !matches!(refusal, CarrierError::Cancelled(_)),
        Error::Unreadable { .. } => true,
        _ => false,
    }
}

/// What is left of an embedding once it is written.
pub(super) struct Marked {
    pub host: Mesh,
    pub parts: Parts,
    pub marked: Mesh,
    pub written: Written,
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
    let leeway = Leeway::new(&scene.mesh, &parts, options.strength.bounds());
    let mesh = displaced(&scene, &leeway, &mark, payload.is_some(), options, model)?;

    model.step(Stage::Write, 0.0)?;
    // Each carrier keeps to a limit of its own: together they exceed the whole's by a few percent, which quantizers do not
    // notice.
    let limit = options.strength.rms_rel();
    let taken = Distortion::between(&scene.mesh.positions, &mesh.positions).rms_rel;
    let scale = if taken > limit { limit / taken } else { 1.0 };
    let pairs = mesh.positions.iter().zip(&scene.mesh.positions);
    let displacement: Vec<DVec3> = pairs
        .map(|(marked, host)| (*marked - *host) * scale)
        .collect();
    // What is done with makes room: models of a million vertices are marked in a browser tab too.
    drop(mesh);
    let positions = write(model, &mut document, &scene, &leeway, displacement)?;
    drop(leeway);
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
    })
}

/// The host's mesh with the mark in it, in every carrier that it suits.
fn displaced(
    scene: &Scene,
    leeway: &Leeway,
    mark: &Mark,
    has_payload: bool,
    options: &EmbedOptions,
    progress: &mut dyn Progress,
) -> Result<Mesh, Error> {
    let limit = options.strength.rms_rel();
    let mut mesh = scene.mesh.clone();
    // Marks that are not sturdy, and what was refused.
    let (mut weak, mut refusals) = (Vec::new(), Vec::new());
    for carrier in Carrier::ALL {
        if !options.carriers.contains(&carrier) {
            continue;
        }
        let is_first = mesh == scene.mesh;
        let rms_rel = if is_first {
            limit
        } else {
            // Where SOLID stays below the limit to be hidden, RING follows halfway: of cropped copies it is all that is left.
            let below = Distortion::between(&scene.mesh.positions, &mesh.positions).rms_rel;
            (below * limit).sqrt() * Carrier::SHARE_ON_TOP
        };
        let host = Host {
            mesh: &mesh,
            leeway,
            admissible: &scene.admissible,
            rms_rel,
            hidden: options.strength.is_hidden(),
            on_top: !is_first,
        };
        match carrier.embed(&host, mark, progress) {
            Ok(embedded) if embedded.is_sturdy() => mesh.displace(&embedded.displacement),
            Ok(embedded) => weak.push(embedded),
            Err(CarrierError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(refusal) => refusals.push(refusal),
        }
    }
    if mesh != scene.mesh {
        return Ok(mesh);
    }
    let best = weak
        .into_iter()
        .max_by(|a, b| a.share().total_cmp(&b.share()));
    let Some(best) = best else {
        let nearest = refusals
            .into_iter()
            .max_by(|a, b| a.share().total_cmp(&b.share()));
        return Err(nearest.map_or(Error::NoCarrier, Error::Carrier));
    };
    if has_payload && best.share() < 1.0 {
        return Err(best.without_payload().into());
    }
    mesh.displace(&best.displacement);
    Ok(mesh)
}

/// Displaces the vertices of a document that was just read, and says where they are then. Those that rounding to the file's numbers takes
/// too far, or whose triangles it turns too far, stay where they were.
pub(super) fn write(
    model: &Model,
    document: &mut Document,
    scene: &Scene,
    leeway: &Leeway,
    mut displacement: Vec<DVec3>,
) -> Result<Vec<DVec3>, Error> {
    loop {
        scene.scatter(document, &displacement)?;
        let positions = scene.positions_in(document)?;
        let mut beyond = leeway.beyond(&positions);
        beyond.retain(|&vertex| displacement[vertex as usize] != DVec3::ZERO);
        if beyond.is_empty() {
            return Ok(positions);
        }
        freeze(&mut displacement, &scene.admissible, &beyond);
        *document = Document::read(model.bytes, model.files)?;
    }
}

/// Leaves vertices, and those that move with them, where they are.
fn freeze(displacement: &mut [DVec3], admissible: &Admissible, vertices: &[u32]) {
    for &vertex in vertices {
        displacement[vertex as usize] = DVec3::ZERO;
    }
    for orbit in &admissible.orbits {
        let members = || orbit.members.iter().map(|&(vertex, _)| vertex as usize);
        if members().any(|vertex| displacement[vertex] == DVec3::ZERO) {
            members().for_each(|vertex| displacement[vertex] = DVec3::ZERO);
        }
    }
}
