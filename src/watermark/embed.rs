//! Embedding: read, displace, write, and read the result back as any detector would.

use super::forecast::forecast;
use super::{EmbedOptions, EmbedReport, Error, Model, Verdict, detect};
use crate::bits::Payload;
use crate::carrier::{Carrier, CarrierError, Host, Mark};
use crate::code::{Checked, Codeword};
use crate::digest::sha256;
use crate::document::{Document, Files, Written};
use crate::geometry::{Bounds, Deformation, Distortion, Leeway, Parts, cuts, diagonal};
use crate::key::Key;
use crate::mesh::{Admissible, Mesh};
use crate::progress::Stage;
use crate::scene::Scene;
use glam::DVec3;

/// A marked model.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Embedding {
    /// The main file: as the host's, but for positions and the bounds of their accessors.
    pub model: Vec<u8>,
    /// The external buffers that changed.
    pub files: Files,
    /// What was done, and what was read back.
    pub report: EmbedReport,
}

/// Marks a model with a payload under a key.
///
/// A carrier that the model is too small or too regular for is left out, if another can be used.
///
/// The marked bytes are read back and tested before they are returned.
///
/// # Errors
/// Where the model cannot be read or no carrier can be used; [`Error::Unreadable`] where the mark cannot be found again in the marked
/// bytes; [`Error::Cancelled`] where its progress was told to stop. Nothing is returned then.
pub fn embed<'a>(
    model: impl Into<Model<'a>>,
    payload: Payload,
    key: &Key,
    options: &EmbedOptions,
) -> Result<Embedding, Error> {
    embed_in(model.into(), payload, key, options)
}

fn embed_in(
    mut model: Model,
    payload: Payload,
    key: &Key,
    options: &EmbedOptions,
) -> Result<Embedding, Error> {
    if options.carriers.is_empty() {
        return Err(Error::NoCarrier);
    }
    let Marked {
        host,
        parts,
        marked,
        written,
        strays,
        num_cuts,
    } = mark(&mut model, payload, key, options)?;
    let distortion = Distortion::between(&host.positions, &marked.positions);
    let deformation = Deformation::between(&host, &parts, &marked.positions);
    let mut marked_files = model.files.clone();
    marked_files.extend(written.files.clone());
    let copy = Model::new(&written.model).with_files(&marked_files);
    let read_back = detect(copy.with_progress(&mut model), key, None)?;
    if read_back.verdict != Verdict::Found || read_back.number != Some(payload.number()) {
        let addresses = read_back
            .details()
            .carriers
            .iter()
            .map(|carrier| carrier.addresses)
            .sum();
        return Err(Error::Unreadable { addresses });
    }
    let forecast = forecast(&host, &marked, &read_back, key, payload, &mut model)?;
    let report = EmbedReport {
        tag: payload.tag(),
        number: payload.number(),
        vertices: host.positions.len(),
        moved_vertices: distortion.num_moved,
        diagonal: diagonal(&host.positions),
        rms_rel: distortion.rms_rel,
        max_rel: distortion.max_rel,
        max_movement: distortion.max_rel * diagonal(&host.positions),
        worst_part_rel: deformation.worst_part,
        worst_turn_degrees: deformation.worst_turn,
        new_intersections: num_cuts,
        warnings: warnings(&deformation).into_iter().chain(strays).collect(),
        strength: options.strength.rms_rel(),
        read_back,
        forecast,
        host_sha256: sha256(model.bytes),
        marked_sha256: sha256(&written.model),
    };
    Ok(Embedding {
        model: written.model,
        files: written.files,
        report,
    })
}

/// What may be seen of a deformation: more than the strong strength's.
fn warnings(deformation: &Deformation) -> Vec<String> {
    let bounds = Bounds::STRONG;
    let mut warnings = Vec::new();
    if deformation.worst_part > 2.0 * bounds.part {
        warnings.push(format!(
            "a part of the model is deformed by {:.1} % of its own size: look at it, or take a smaller strength",
            100.0 * deformation.worst_part
        ));
    }
    if deformation.worst_turn > bounds.turn {
        warnings.push(format!(
            "a triangle turned by {:.0} degrees: look at it, or take a smaller strength",
            deformation.worst_turn
        ));
    }
    warnings
}

/// What is left of an embedding once it is written.
struct Marked {
    host: Mesh,
    parts: Parts,
    marked: Mesh,
    written: Written,
    /// Where strays lie, in words.
    strays: Option<String>,
    /// Pairs of triangles that cut each other and did not before.
    num_cuts: usize,
}

/// Reads, displaces and writes.
fn mark(
    model: &mut Model,
    payload: Payload,
    key: &Key,
    options: &EmbedOptions,
) -> Result<Marked, Error> {
    model.step(Stage::Read, 0.0)?;
    let mut document = Document::read(model.bytes, model.files)?;
    let scene = Scene::gather(&document)?;
    model.step(Stage::Embed, 0.0)?;

    let codeword = Codeword::new(Checked::new(key).message(payload));
    let mark = Mark {
        key,
        codeword: &codeword,
    };
    let mut mesh = scene.mesh.clone();
    let parts = scene.parts();
    let leeway = Leeway::new(&scene.mesh, &parts, options.bounds()?);
    let chosen: Vec<Carrier> = Carrier::ALL
        .into_iter()
        .filter(|carrier| options.carriers.contains(carrier))
        .collect();
    let mut refusals = Vec::new();
    let limit = options.strength.rms_rel();
    for &carrier in &chosen {
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
            leeway: &leeway,
            admissible: &scene.admissible,
            rms_rel,
            hidden: options.strength.is_hidden(),
            on_top: !is_first,
        };
        match carrier.embed(&host, &mark, model) {
            Ok(displacement) => mesh
                .positions
                .iter_mut()
                .zip(displacement)
                .for_each(|(position, d)| *position += d),
            Err(CarrierError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(refusal) => refusals.push(refusal),
        }
    }
    if refusals.len() == chosen.len() {
        return Err(refusals.pop().map_or(Error::NoCarrier, Error::Carrier));
    }

    model.step(Stage::Write, 0.0)?;
    // Each carrier keeps to a limit of its own: together they exceed the whole's by a few percent, which quantizers do not
    // notice.
    let taken = Distortion::between(&scene.mesh.positions, &mesh.positions).rms_rel;
    let scale = if taken > limit { limit / taken } else { 1.0 };
    let pairs = mesh.positions.iter().zip(&scene.mesh.positions);
    let displacement: Vec<DVec3> = pairs
        .map(|(marked, host)| (*marked - *host) * scale)
        .collect();
    // What is done with makes room: models of a million vertices are marked in a browser tab too.
    drop(mesh);
    let (positions, num_cuts) = write(model, &mut document, &scene, &parts, &leeway, displacement)?;
    drop(leeway);
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
        strays,
        num_cuts,
    })
}

/// Triangles that would cut each other are brought back half of the way so often, before they are left where they were.
const HALVINGS: usize = 4;

/// Displaces the vertices of a document that was just read, and says where they are then. Those that rounding to the file's numbers takes
/// too far, or whose triangles it turns too far, stay where they were; those whose triangles would cut others of their part go less far.
/// Gives back how many pairs of triangles cut each other after all.
pub(super) fn write(
    model: &Model,
    document: &mut Document,
    scene: &Scene,
    parts: &Parts,
    leeway: &Leeway,
    mut displacement: Vec<DVec3>,
) -> Result<(Vec<DVec3>, usize), Error> {
    let mut time = 0;
    loop {
        scene.scatter(document, &displacement)?;
        let positions = scene.positions_in(document)?;
        let is_moved = |vertex: &u32| displacement[*vertex as usize] != DVec3::ZERO;
        let mut beyond = leeway.beyond(&positions);
        beyond.retain(is_moved);
        let cuts = cuts(&scene.mesh, parts, &positions);
        let corners = |triangle: u32| scene.mesh.triangles[triangle as usize];
        let mut cut: Vec<u32> = cuts.iter().flatten().flat_map(|&t| corners(t)).collect();
        cut.retain(is_moved);
        if beyond.is_empty() && cut.is_empty() {
            return Ok((positions, cuts.len()));
        }
        let share = if time < HALVINGS { 0.5 } else { 0.0 };
        shorten(&mut displacement, &scene.admissible, &cut, share);
        shorten(&mut displacement, &scene.admissible, &beyond, 0.0);
        *document = Document::read(model.bytes, model.files)?;
        time += 1;
    }
}

/// Leaves vertices, and those that move with them, a share of their movement.
fn shorten(displacement: &mut [DVec3], admissible: &Admissible, vertices: &[u32], share: f64) {
    if vertices.is_empty() {
        return;
    }
    let mut is_shorter = vec![false; displacement.len()];
    for &vertex in vertices {
        is_shorter[vertex as usize] = true;
    }
    for orbit in &admissible.orbits {
        let members = || orbit.members.iter().map(|&(vertex, _)| vertex as usize);
        if members().any(|vertex| is_shorter[vertex]) {
            members().for_each(|vertex| is_shorter[vertex] = true);
        }
    }
    let moves = displacement.iter_mut().zip(is_shorter);
    moves
        .filter(|(_, is_shorter)| *is_shorter)
        .for_each(|(d, _)| *d *= share);
}
