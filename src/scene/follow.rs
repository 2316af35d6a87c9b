//! Points and lines that lie on the surface: they move with it.

use super::gather::placed_nodes;
use super::uses::Use;
use super::{Scene, inverse};
use crate::document::{Document, DocumentError, Slot};
use crate::geometry::{Surface, diagonal};
use glam::{DAffine3, DVec3};
use std::collections::BTreeSet;

/// How far from the surface something lies on it, as a fraction of the diagonal: an edge's own curve leaves the chords that triangles have.
const NEAR: f64 = 1e-3;

/// A displacement of an element of a position accessor, in the element's own space.
pub struct Follower {
    pub accessor: usize,
    pub element: u32,
    pub displacement: DVec3,
}

/// The elements of points and lines that lie on the surface, as the first node that shows them has them, and how they go with V
/// displacements of its vertices. Elements that are vertices, and those that cannot be written, are not among them.
pub fn followers(
    scene: &Scene,
    document: &Document,
    uses: &[Use],
    displacement: &[DVec3],
) -> Result<Vec<Follower>, DocumentError> {
    let shown = shown(document);
    let mut followers = Vec::new();
    if shown.is_empty() {
        return Ok(followers);
    }
    let surface = Surface::new(&scene.mesh);
    let near = NEAR * diagonal(&scene.mesh.positions);
    let mut known: BTreeSet<[usize; 2]> = uses.iter().map(|usage| words(usage.slot)).collect();
    for (accessor, to_world) in shown {
        let (Some(to_local), Ok(positions)) =
            (inverse(to_world.matrix3), document.positions(accessor))
        else {
            continue;
        };
        let fixed = document.fixed_elements(accessor)?;
        let elements = (0..).zip(document.slots(accessor)?).zip(fixed);
        for (((element, slot), is_fixed), position) in elements.zip(positions) {
            let Some(slot) = slot.filter(|_| !is_fixed) else {
                continue;
            };
            let world = to_world.transform_point3(DVec3::from_array(position));
            if !world.is_finite() || !known.insert(words(slot)) {
                continue;
            }
            let Some(found) = surface
                .nearest(world)
                .filter(|found| found.distance <= near)
            else {
                continue;
            };
            let corners = scene.mesh.triangles.get(found.triangle as usize);
            let moves = corners.into_iter().flatten().zip(found.weights);
            let moved: DVec3 = moves
                .filter_map(|(&vertex, weight)| Some(*displacement.get(vertex as usize)? * weight))
                .sum();
            followers.push(Follower {
                accessor,
                element,
                displacement: to_local * moved,
            });
        }
    }
    Ok(followers)
}

/// The position accessors of primitives without triangles, each with the transform of the first node that shows it.
fn shown(document: &Document) -> Vec<(usize, DAffine3)> {
    let (mut meshes, mut known) = (BTreeSet::new(), BTreeSet::new());
    let mut shown = Vec::new();
    for placed in placed_nodes(document) {
        // A mesh may have many parts, and many nodes may show it.
        if !meshes.insert(placed.mesh) {
            continue;
        }
        let primitives = document.meshes().get(placed.mesh);
        let primitives = primitives.map_or(&[][..], |mesh| &mesh.primitives);
        for (index, primitive) in primitives.iter().enumerate() {
            if let Some(accessor) = primitive.position
                && document.num_triangles(placed.mesh, index) == 0
                && known.insert(accessor)
            {
                shown.push((accessor, placed.to_world));
            }
        }
    }
    shown
}

fn words(slot: Slot) -> [usize; 2] {
    [slot.storage, slot.offset]
}
