//! How far vertices may move before somebody sees it.
//!
//! What is seen of a displacement is its slope, so the wider it spreads, the farther it may go; and a rough surface hides
//! what a smooth one shows. The numbers are this project's own, from renders under raking light of models whose normals were
//! computed anew.

use crate::carrier::Host;
use crate::geometry::{diagonal, face_areas, roughness};
use crate::mesh::{Edges, Mesh};

/// The slope, in radians, that a displacement may add to a flat surface and stay unseen under raking light ...
const UNSEEN: f64 = 0.005;
/// ... and what each radian of roughness adds to that by masking it ...
const MASKING: f64 = 0.7;
/// ... beyond this, which may be the chords of a curve and masks nothing.
const CHORDS: f64 = 0.02;
/// A displacement spreads over a vertex's share of the surface, and over no less than this part of the whole: windows are larger.
const SPREAD: f64 = 1.0 / 8000.0;
/// The RMS, as a fraction of the diagonal, that the flattest surface is given: the smallest step needs about twice as much.
const LEAST_RMS: f64 = 6e-5;
/// The least freedom where the whole limit is spent, seen or not.
const LEAST_FREEDOM: f64 = 0.25;
/// What an open boundary leaves of a freedom: its outline is seen against what is behind.
const BOUNDARY: f64 = 0.5;

/// The least freedom of a vertex that may hardly move: freedoms are divided by.
const SMALLEST: f64 = 1e-3;

/// How far each of the V vertices of a host's oriented mesh may move, as a share of its limit: at most 1. The host's leeway is what a
/// vertex may move at most, which is `clamp` times its freedom.
pub fn freedoms(mesh: &Mesh, boundary: &[(u32, u32)], host: &Host, clamp: f64) -> Vec<f64> {
    let limit = host.rms_rel * diagonal(&mesh.positions);
    let least = if host.hidden {
        (LEAST_RMS / host.rms_rel).min(1.0)
    } else {
        LEAST_FREEDOM
    };
    let mut areas = vec![0.0; mesh.positions.len()];
    for (triangle, area) in mesh.triangles.iter().zip(face_areas(mesh)) {
        for &vertex in triangle {
            areas[vertex as usize] += area.length() / 3.0;
        }
    }
    let narrowest = SPREAD * areas.iter().sum::<f64>();
    let mut freedoms = roughness(mesh, &Edges::new(mesh));
    for (freedom, area) in freedoms.iter_mut().zip(areas) {
        let slope = UNSEEN + MASKING * (*freedom - CHORDS).max(0.0);
        *freedom = slope * area.max(narrowest).sqrt() / limit;
    }
    for &(vertex, _) in boundary {
        freedoms[vertex as usize] *= BOUNDARY;
    }
    freedoms
        .into_iter()
        .zip(host.leeway.reaches())
        .map(|(freedom, reach)| {
            let most = (reach / (clamp * limit)).clamp(SMALLEST, 1.0);
            freedom.clamp(least, 1.0).min(most)
        })
        .collect()
}

/// The RMS freedom.
pub fn typical(freedoms: &[f64]) -> f64 {
    let square: f64 = freedoms.iter().map(|freedom| freedom * freedom).sum();
    (square / freedoms.len() as f64).sqrt()
}
