//! Scene -> Document: displacements back to every element, positions from a changed document.

use super::{Scene, SceneError};
use crate::document::Document;
use glam::DVec3;
use std::collections::BTreeMap;

impl Scene {
    /// Displaces the document's elements as V admissible displacements of the vertices say. Each coordinate is rounded to
    /// what its accessor can hold.
    pub fn scatter(&self, document: &mut Document, displacement: &[DVec3]) -> Result<(), SceneError> {
        let mut changed: BTreeMap<usize, Vec<[f64; 3]>> = BTreeMap::new();
        // Placements of one accessor agree about its elements, for the displacement is admissible: the first that shows an
        // element moves it.
        let mut moved: BTreeMap<usize, Vec<bool>> = BTreeMap::new();
        for placement in &self.placements {
            let Some(to_local) = placement.to_local else { continue };
            let accessor = placement.accessor;
            if !changed.contains_key(&accessor) {
                let positions = document.positions(accessor)?;
                moved.insert(accessor, vec![false; positions.len()]);
                changed.insert(accessor, positions);
            }
            let (Some(positions), Some(moved)) = (changed.get_mut(&accessor), moved.get_mut(&accessor)) else { continue };
            for ((vertex, position), moved) in placement.vertices.iter().zip(positions).zip(moved) {
                let d = vertex.and_then(|vertex| displacement.get(vertex as usize)).copied().unwrap_or_default();
                if d != DVec3::ZERO && !std::mem::replace(moved, true) {
                    *position = (DVec3::from_array(*position) + to_local * d).to_array();
                }
            }
        }
        for (accessor, positions) in changed {
            document.set_positions(accessor, &positions)?;
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
                    *slot = placement.to_world.transform_point3(DVec3::from_array(local));
                }
            }
        }
        Ok(positions)
    }
}
