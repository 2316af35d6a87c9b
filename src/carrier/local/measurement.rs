//! What LOCAL measures of a suspect without a key.

use super::ball::{Ball, widths};
use crate::carrier::solid::lattice::{Placement, RADIUS};
use crate::carrier::solid::window::Window;
use crate::geometry::places::{Areas, Place, areas, places};
use crate::geometry::{diagonal, oriented};
use crate::mesh::Mesh;
use glam::DVec3;

/// Places that are looked at, at most, the sharpest. Half a bunny has 90.
const MOST_PLACES: usize = 384;

/// The places of a suspect, and the surface about them.
#[derive(Clone, Debug)]
pub struct Measurement {
    pub(super) areas: Areas,
    pub(super) places: Vec<Place>,
    /// Where boundary edges begin.
    boundary: Vec<DVec3>,
    pub(super) diagonal: f64,
}

impl Measurement {
    /// Measures a mesh.
    pub fn new(mesh: &Mesh) -> Measurement {
        let (mesh, boundary) = oriented(mesh);
        let diagonal = diagonal(&mesh.positions);
        let widths = widths(diagonal);
        let areas = areas(&mesh, &widths);
        let mut places = places(&areas, &widths);
        places.truncate(MOST_PLACES);
        Measurement {
            places,
            areas,
            boundary: boundary
                .iter()
                .map(|&(start, _)| mesh.positions[start as usize])
                .collect(),
            diagonal,
        }
    }

    /// How many places there are.
    pub fn num_places(&self) -> usize {
        self.places.len()
    }

    /// Leaves out the windows that see a boundary: half of what they saw may be gone.
    pub(super) fn keep_whole(&self, windows: &mut Vec<Window>, ball: &Ball, placement: &Placement) {
        let reach = RADIUS * placement.pitch;
        let is_near = |point: &&DVec3| point.distance(ball.place.point) < 8.0 * placement.pitch;
        let near: Vec<DVec3> = self.boundary.iter().filter(is_near).copied().collect();
        windows.retain(|window| {
            let centre = placement.point(DVec3::from_array(window.index.map(f64::from)));
            let sees = |point: &DVec3| point.distance_squared(centre) <= reach * reach;
            !near.iter().any(sees)
        });
    }
}
