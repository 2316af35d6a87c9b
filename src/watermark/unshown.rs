//! Meshes that no scene shows, but an extension or another program may: levels of detail, and what is left over. Each is marked as if it
//! were a file of its own.

use super::displace::{Displaced, Used, displacement, write};
use super::read_back::is_seen_at_once;
use super::report::Unshown;
use super::{EmbedOptions, Error, Model};
use crate::bits::Payload;
use crate::carrier::Mark;
use crate::document::Document;
use crate::geometry::Leeway;
use crate::scene::Scene;

/// Meshes that are marked, at most: for each the file is read anew.
const MOST_MARKED: usize = 32;

/// What holds the mark of meshes, by their places in the file.
pub(super) type UsedByMesh = Vec<(usize, Vec<Used>)>;

/// Marks the meshes of a document that no scene shows, where they share no position with what is marked already; and says which were
/// marked, and what holds the mark of those.
pub(super) fn mark_unshown(
    model: &mut Model,
    document: &mut Document,
    shown: &Scene,
    mark: &Mark,
    payload: Option<Payload>,
    options: &EmbedOptions,
) -> Result<(Vec<Unshown>, UsedByMesh), Error> {
    let unshown = Scene::unshown(document).into_iter().enumerate();
    let (mut all, mut used) = (Vec::new(), Vec::new());
    let mut others = Vec::new();
    for (number, mesh) in unshown {
        let mut is_marked = false;
        if number < MOST_MARKED
            && let Ok(scene) = Scene::of_mesh(document, mesh)
            && !shares_with_any(&scene, others.iter().chain([shown]), document)?
            && let Some((displacement, carriers)) = marked(model, &scene, mark, payload, options)?
        {
            scene.scatter(document, &displacement)?;
            others.push(scene);
            used.push((mesh, carriers));
            is_marked = true;
        }
        all.push(Unshown { mesh, is_marked });
    }
    Ok((all, used))
}

/// Whether some positions of a scene are those of another.
fn shares_with_any<'a>(
    scene: &Scene,
    others: impl Iterator<Item = &'a Scene>,
    document: &Document,
) -> Result<bool, Error> {
    for other in others {
        if scene.shares_with(other, document)? {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The displacement by which a mesh alone holds the mark, and what holds it; none where it cannot hold it.
fn marked(
    model: &mut Model,
    scene: &Scene,
    mark: &Mark,
    payload: Option<Payload>,
    options: &EmbedOptions,
) -> Result<Option<Displaced>, Error> {
    let mut document = Document::read(model.bytes, model.files)?;
    let parts = scene.parts();
    let leeway = Leeway::new(&scene.mesh, &parts, options.bounds()?);
    let (displacement, used) =
        match displacement(scene, &leeway, mark, payload.is_some(), options, model) {
            Err(refusal) if refusal.is_of_the_model() => return Ok(None),
            found => found?,
        };
    let moved = write(model, &mut document, scene, &parts, &leeway, displacement)?;
    let mesh = scene.mesh.with_positions(moved.positions);
    drop(leeway);
    let is_read = is_seen_at_once(&mesh, mark.key, payload, model)?;
    Ok(is_read.then_some((moved.displacement, used)))
}
