//! Why a scene has no room for small displacements.

use super::{Scene, SceneError};
use crate::document::{Document, PositionGrid};
use crate::geometry::diagonal;
use glam::DVec3;

/// How coarse numbers may be, as a fraction of the diagonal, before they are said to be the reason: a quarter of the balanced strength.
const COARSE: f64 = 1e-4;

impl Scene {
    /// Refuses a scene of which no vertex can move.
    ///
    /// # Errors
    ///
    /// [`SceneError::NothingMovable`].
    pub fn check_movable(&self) -> Result<(), SceneError> {
        if self.admissible.fixed.len() == self.mesh.positions.len() {
            return Err(SceneError::NothingMovable);
        }
        Ok(())
    }

    /// Why nothing small can be written into this scene, if it is because of its numbers: the values that they can take are too far
    /// apart, as those of 32-bit floats are far away from the origin.
    pub fn coarse(&self, document: &Document) -> Option<SceneError> {
        let diagonal = diagonal(&self.mesh.positions);
        let steps = self.placements.iter().filter_map(|placement| {
            let positions = document.positions(placement.accessor).ok()?;
            let step = match document.position_grid(placement.accessor).ok()? {
                PositionGrid::Integer { step, .. } => step,
                PositionGrid::Float32 => positions
                    .iter()
                    .flatten()
                    .map(|&number| spacing(number))
                    .fold(0.0, f64::max),
            };
            let axes = [DVec3::X, DVec3::Y, DVec3::Z];
            let longest = axes
                .map(|axis| (placement.to_world.matrix3 * axis).length())
                .into_iter()
                .fold(0.0, f64::max);
            Some(step * longest)
        });
        let step_rel = steps.fold(0.0, f64::max) / diagonal;
        (step_rel > COARSE).then_some(SceneError::CoarseNumbers {
            percent: 100.0 * step_rel,
        })
    }
}

/// The distance from a number that is a 32-bit float to the next one, away from zero.
fn spacing(number: f64) -> f64 {
    let number = number.abs() as f32;
    f64::from(number.next_up()) - f64::from(number)
}
