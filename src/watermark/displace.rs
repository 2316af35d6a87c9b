//! Displacing: the mark in every carrier that suits a host, and back into the file.

use super::{EmbedOptions, Error, Model};
use crate::carrier::{Carrier, CarrierError, Chosen, Host, Mark, Prepared};
use crate::document::Document;
use crate::geometry::{Distortion, Leeway, Parts, Pieces, cuts, diagonal};
use crate::mesh::{Admissible, Mesh};
use crate::progress::Progress;
use crate::scene::Scene;
use glam::DVec3;

/// A carrier that holds a mark, and what it chose for that.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Used {
    pub carrier: Carrier,
    pub chosen: Vec<Chosen>,
}

/// The displacement of all vertices, and what holds the mark.
pub(super) type Displaced = (Vec<DVec3>, Vec<Used>);

/// The displacement that gives the host the mark, in every carrier that it suits, and which these are.
pub(super) fn displacement(
    scene: &Scene,
    leeway: &Leeway,
    mark: &Mark,
    has_payload: bool,
    options: &EmbedOptions,
    progress: &mut dyn Progress,
) -> Result<Displaced, Error> {
    let mut displaced =
        |beside| displaced(scene, leeway, mark, has_payload, beside, options, progress);
    let beside = options.asked();
    if let Some(asked) = beside.filter(|asked| asked.is_beside_solid(&scene.mesh)) {
        match displaced(Some(asked)) {
            Ok((mesh, used)) if used.iter().any(|used| used.carrier == asked) => {
                return Ok((within_limit(scene, &mesh, options), used));
            }
            Err(refusal) if !refusal.is_of_the_model() => return Err(refusal),
            // SOLID shares nothing with what is left out.
            _ => {}
        }
    }
    let (mesh, used) = displaced(None)?;
    Ok((within_limit(scene, &mesh, options), used))
}

/// The same as it was done before, with another message.
pub(super) fn displacement_again(
    scene: &Scene,
    leeway: &Leeway,
    mark: &Mark,
    prepared: &[Prepared],
    options: &EmbedOptions,
    is_thorough: bool,
) -> Vec<DVec3> {
    let mut mesh = scene.mesh.clone();
    let in_objects = prepared.iter().any(Prepared::is_in_objects);
    for carrier in prepared {
        let limits = limits_on_top(scene, &mesh, in_objects, options);
        let host = host(scene, &mesh, leeway, limits.as_deref(), options);
        let displacement = carrier.again(&host, mark, is_thorough);
        mesh.displace(&displacement);
    }
    within_limit(scene, &mesh, options)
}

/// From the scene's mesh to the displaced one, within the limit.
fn within_limit(scene: &Scene, mesh: &Mesh, options: &EmbedOptions) -> Vec<DVec3> {
    // Each carrier keeps to a limit of its own: together they exceed the whole's by a few percent, which quantizers do not
    // notice.
    let limit = options.strength.rms_rel();
    let taken = Distortion::between(&scene.mesh.positions, &mesh.positions).rms_rel;
    let scale = if taken > limit { limit / taken } else { 1.0 };
    let pairs = mesh.positions.iter().zip(&scene.mesh.positions);
    pairs
        .map(|(marked, host)| (*marked - *host) * scale)
        .collect()
}

/// What a carrier is given: the scene's mesh, displaced by those before it.
pub(super) fn host<'a>(
    scene: &'a Scene,
    mesh: &'a Mesh,
    leeway: &'a Leeway,
    on_top: Option<&'a [f64]>,
    options: &EmbedOptions,
) -> Host<'a> {
    Host {
        mesh,
        leeway,
        admissible: &scene.admissible,
        rms_rel: options.strength.rms_rel(),
        share: 1.0,
        hidden: options.strength.is_hidden(),
        on_top,
    }
}

/// What RING may do about each vertex on top of SOLID, in scene units; none where nothing is in the mesh yet. Where SOLID is in objects, each
/// in its own size, RING keeps to that size too: of the scene's it would take the mark of the small ones.
fn limits_on_top(
    scene: &Scene,
    mesh: &Mesh,
    in_objects: bool,
    options: &EmbedOptions,
) -> Option<Vec<f64>> {
    if *mesh == scene.mesh {
        return None;
    }
    let limit = |before: &[DVec3], after: &[DVec3]| {
        // Where SOLID stays below the limit to be hidden, RING follows halfway: of cropped copies it is all that is left.
        let below = Distortion::between(before, after).rms_rel;
        (below * options.strength.rms_rel()).sqrt() * Carrier::SHARE_ON_TOP * diagonal(after)
    };
    let whole = limit(&scene.mesh.positions, &mesh.positions);
    let mut limits = vec![whole; mesh.positions.len()];
    let objects = in_objects.then(|| Pieces::stable_objects(&scene.mesh));
    for object in objects.into_iter().flatten() {
        let before = scene.mesh.part(object.iter().copied()).positions;
        let after = mesh.part(object.iter().copied()).positions;
        let own = limit(&before, &after);
        // What SOLID left as it was has nothing to lose.
        if own > 0.0 {
            let vertices = object.iter().flatten();
            vertices.for_each(|&vertex| limits[vertex as usize] = own.min(whole));
        }
    }
    Some(limits)
}

/// The host's mesh with the mark in it, in every carrier that it suits; with one beside SOLID, which shares the limit with it.
fn displaced(
    scene: &Scene,
    leeway: &Leeway,
    mark: &Mark,
    has_payload: bool,
    beside: Option<Carrier>,
    options: &EmbedOptions,
    progress: &mut dyn Progress,
) -> Result<(Mesh, Vec<Used>), Error> {
    let mut mesh = scene.mesh.clone();
    // Marks that are not sturdy, and what was refused.
    let (mut weak, mut refusals) = (Vec::new(), Vec::new());
    let mut used: Vec<Used> = Vec::new();
    for carrier in Carrier::ALL {
        let is_standard = Carrier::STANDARD.contains(&carrier);
        // What comes beside SOLID holds no payload: it is left out where SOLID does not hold the mark.
        let is_beside = beside == Some(carrier) && !used.is_empty();
        if !(is_beside || is_standard && options.carriers.contains(&carrier)) {
            continue;
        }
        let chosen: Vec<Chosen> = used.iter().flat_map(|used| used.chosen.clone()).collect();
        let in_objects = chosen.iter().any(|frame| frame.object.is_some());
        let limits = limits_on_top(scene, &mesh, in_objects, options);
        let mut host = host(scene, &mesh, leeway, limits.as_deref(), options);
        if is_beside || used.is_empty() && beside.is_some() {
            host.rms_rel = options.strength.rms_rel();
            host.share = Carrier::SHARE_BESIDE;
        }
        match carrier.embed_above(&host, mark, &chosen, progress) {
            Ok(embedded) if embedded.is_sturdy() => {
                mesh.displace(&embedded.displacement);
                used.push(Used {
                    carrier,
                    chosen: embedded.chosen,
                });
            }
            Ok(embedded) => weak.push(embedded),
            Err(CarrierError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(refusal) => refusals.push(refusal),
        }
    }
    if mesh != scene.mesh {
        return Ok((mesh, used));
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
    let used = Used {
        carrier: best.carrier,
        chosen: best.chosen,
    };
    Ok((mesh, vec![used]))
}

/// What was written of a scene's vertices.
pub(super) struct Moved {
    /// Where they are.
    pub positions: Vec<DVec3>,
    /// What was asked for, of those that were moved.
    pub displacement: Vec<DVec3>,
    /// Pairs of triangles that cut each other and did not before.
    pub num_cuts: usize,
}

/// Triangles that would cut each other are brought back half of the way so often, before they are left where they were.
const HALVINGS: usize = 4;

/// Displaces the vertices of a document that was just read. Those that rounding to the file's numbers takes
/// too far, or whose triangles it turns too far, stay where they were; those whose triangles would cut others of their part go less far.
pub(super) fn write(
    model: &Model,
    document: &mut Document,
    scene: &Scene,
    parts: &Parts,
    leeway: &Leeway,
    mut displacement: Vec<DVec3>,
) -> Result<Moved, Error> {
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
            return Ok(Moved {
                positions,
                displacement,
                num_cuts: cuts.len(),
            });
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
