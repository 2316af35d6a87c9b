//! Quantization of positions.

use crate::mesh::Mesh;
use glam::DVec3;

/// Rounds every coordinate to a multiple of `2^-bits` of the bounding box's side along it, from the lower face on, as the LIRIS
/// benchmark (Wang et al. 2010): `2^bits + 1` values on each axis, the upper face's among them.
pub fn quantize(mesh: &Mesh, bits: u32) -> Mesh {
    let first = mesh.positions.first().copied().unwrap_or_default();
    let low = mesh.positions.iter().fold(first, |low, p| low.min(*p));
    let high = mesh.positions.iter().fold(first, |high, p| high.max(*p));
    let step = (high - low) / (1u64 << bits) as f64;
    let round = |p: &DVec3| {
        DVec3::from([0, 1, 2].map(|axis| {
            if step[axis] > 0.0 {
                ((p[axis] - low[axis]) / step[axis]).round() * step[axis] + low[axis]
            } else {
                p[axis]
            }
        }))
    };
    mesh.with_positions(mesh.positions.iter().map(round).collect())
}
