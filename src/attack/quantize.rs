//! Quantization of positions.

use crate::mesh::Mesh;
use glam::DVec3;

/// Rounds every coordinate to a multiple of `2^-bits` of the bounding box's side along it, from the lower face on, as the LIRIS
/// benchmark (Wang et al. 2010): `2^bits + 1` values on each axis, the upper face's among them.
pub fn quantize(mesh: &Mesh, bits: u32) -> Mesh {
    rounded(mesh, |extent| extent / (1u64 << bits) as f64)
}

/// Rounds every coordinate to one of `2^bits` values along the longest side of the bounding box, with the same steps on all axes, as
/// glTF's optimisers do: harder on flat models than [`quantize`].
pub fn quantize_evenly(mesh: &Mesh, bits: u32) -> Mesh {
    rounded(mesh, |extent| {
        DVec3::splat(extent.max_element() / ((1u64 << bits) - 1) as f64)
    })
}

/// Rounds to steps that follow from the bounding box's extent; along an axis without steps nothing moves.
fn rounded(mesh: &Mesh, steps: impl Fn(DVec3) -> DVec3) -> Mesh {
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
