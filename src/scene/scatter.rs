//! Scene -> Document: displacements back to every element, positions from a changed document.

use super::uses::uses;
use super::{Scene, SceneError};
use crate::document::Document;
use glam::DVec3;

impl Scene {
    /// Displaces the document's elements as V admissible displacements of the vertices say. Each coordinate is rounded to
    /// what its accessor can hold.
    pub fn scatter(
        &self,
        document: &mut Document,
        displacement: &[DVec3],
    ) -> Result<(), SceneError> {
        let mut moves: Vec<Vec<(usize, DVec3)>> = vec![Vec::new(); self.placements.len()];
        for uses in uses(document, &self.placements)?.chunk_by(|a, b| a.slot == b.slot) {
            // The displacement is admissible, so all uses of an element agree about it: the first moves it.
            let Some(first) = uses.first() else { continue };
            let to_local = self
                .placements
                .get(first.placement)
                .and_then(|placement| placement.to_local);
            if let (Some(to_local), Some(d), Some(moves)) = (
                to_local,
                displacement.get(first.vertex as usize),
                moves.get_mut(first.placement),
            ) {
                moves.push((first.element, to_local * *d));
            }
        }
        for (placement, moves) in self.placements.iter().zip(moves) {
            let mut positions = document.positions(placement.accessor)?;
            for (element, d) in moves {
                if let Some(position) = positions.get_mut(element) {
                    *position = (DVec3::from_array(*position) + d).to_array();
                }
            }
            document.set_positions(placement.accessor, &positions)?;
        }
        Ok(())
    }

    /// Where a document that differs in positions only has the vertices of this scene.
    pub fn positions_in(&self, document: &Document) -> Result<Vec<DVec3>, SceneError> {
        let mut positions = self.mesh.positions.clone();
        for placement in &self.placements {
            let locals = document.positions(placement.accessor)?;
            for (vertex, local) in placement.vertices.iter().zip(locals) {
                if let Some(slot) = vertex.and_then(|vertex| positions.get_mut(vertex as usize)) {
                    *slot = placement
                        .to_world
                        .transform_point3(DVec3::from_array(local));
                }
            }
        }
        Ok(positions)
    }
}
