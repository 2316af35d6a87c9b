//! Rounding of positions to a grid in the bounding box.

use crate::mesh::Mesh;
use glam::DVec3;

/// Bits of the coarsest grid that usual programs for the web bring a model to by default, along the longest side of its box. They ask
/// for 14, of which one is the sign.
const WEB_BITS: u32 = 13;

/// The mesh as a web pipeline rounds it: the same steps on all axes.
pub fn rounded_for_web(mesh: &Mesh) -> Mesh {
    rounded(mesh, |extent| evenly(extent, WEB_BITS))
}

/// Steps of `2^bits` values along the longest side of a box, the same on all axes.
pub fn evenly(extent: DVec3, bits: u32) -> DVec3 {
    DVec3::splat(extent.max_element() / ((1u64 << bits) - 1) as f64)
}

/// Rounds to steps that follow from the bounding box's extent; along an axis without steps nothing moves.
pub fn rounded(mesh: &Mesh, steps: impl Fn(DVec3) -> DVec3) -> Mesh {
    let first = mesh.positions.first().copied().unwrap_or_default();
    let low = mesh.positions.iter().fold(first, |low, p| low.min(*p));
    let high = mesh.positions.iter().fold(first, |high, p| high.max(*p));
    let steps = steps(high - low);
    let round = |p: &DVec3| {
        let rounded = ((*p - low) / steps).round() * steps + low;
        DVec3::select(steps.cmpgt(DVec3::ZERO), rounded, *p)
    };
    mesh.with_positions(mesh.positions.iter().map(round).collect())
}
