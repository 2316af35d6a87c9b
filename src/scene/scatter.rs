//! Scene -> Document: displacements back to every element, positions from a changed document.

use super::follow::followers;
use super::uses::uses;
use super::{Scene, SceneError};
use crate::document::{Document, Slot};
use glam::DVec3;
use std::collections::BTreeMap;

impl Scene {
    /// Displaces the document's elements as V admissible displacements of the vertices say. Each coordinate is rounded to
    /// what its accessor can hold.
    pub fn scatter(
        &self,
        document: &mut Document,
        displacement: &[DVec3],
    ) -> Result<(), SceneError> {
        // By accessor, so that each is read and stored once, however often it is shown.
        let mut moves: BTreeMap<usize, Vec<(u32, DVec3)>> = BTreeMap::new();
        let uses = uses(document, &self.placements)?;
        for uses in uses.chunk_by(|a, b| a.slot == b.slot) {
            // The displacement is admissible, so all uses of an element agree about it: the first moves it.
            let Some(first) = uses.first() else { continue };
            let placement = self.placements.get(first.placement as usize);
            if let (Some(placement), Some(d)) = (placement, displacement.get(first.vertex as usize))
                && let Some(to_local) = placement.to_local
            {
                let moves = moves.entry(placement.accessor).or_default();
                moves.push((first.element, to_local * *d));
            }
        }
        for follower in followers(self, document, &uses, displacement)? {
            let moves = moves.entry(follower.accessor).or_default();
            moves.push((follower.element, follower.displacement));
        }
        for (accessor, moves) in moves {
            let mut positions = document.positions(accessor)?;
            for (element, d) in moves {
                if let Some(position) = positions.get_mut(element as usize) {
                    *position = (DVec3::from_array(*position) + d).to_array();
                }
            }
            document.set_positions(accessor, &positions)?;
        }
        Ok(())
    }

    /// Whether some bytes are positions of both.
    ///
    /// # Errors
    /// Where the document is another one.
    pub fn shares_with(&self, other: &Scene, document: &Document) -> Result<bool, SceneError> {
        let slots = |scene: &Scene| -> Result<Vec<Slot>, SceneError> {
            let uses = uses(document, &scene.placements)?.into_iter();
            Ok(uses.map(|usage| usage.slot).collect())
        };
        let (own, its) = (slots(self)?, slots(other)?);
        Ok(own.iter().any(|slot| its.binary_search(slot).is_ok()))
    }

    /// Where a document that differs in positions only has the vertices of this scene: each where its first element is.
    pub fn positions_in(&self, document: &Document) -> Result<Vec<DVec3>, SceneError> {
        let mut positions = vec![None; self.mesh.positions.len()];
        for placement in &self.placements {
            let locals = document.positions(placement.accessor)?;
            for (vertex, local) in placement.vertices.iter().zip(locals) {
                if let Some(slot) = vertex.and_then(|vertex| positions.get_mut(vertex as usize)) {
                    slot.get_or_insert_with(|| {
                        let local = DVec3::from_array(local);
                        placement.to_world.transform_point3(local)
                    });
                }
            }
        }
        // Every vertex has an element.
        Ok(positions
            .into_iter()
            .map(Option::unwrap_or_default)
            .collect())
    }
}
