//! Quantization of positions.

use crate::mesh::Mesh;
use glam::DVec3;

/// Rounds every coordinate to one of `2^bits` values on the longest side of the bounding box, as the LIRIS benchmark (Wang
/// et al. 2010) and glTF's optimisers do.
pub fn quantize(mesh: &Mesh, bits: u32) -> Mesh {
    let first = mesh.positions.first().copied().unwrap_or_default();
    let low = mesh.positions.iter().fold(first, |low, p| low.min(*p));
    let high = mesh.positions.iter().fold(first, |high, p| high.max(*p));
    let step = (high - low).max_element() / ((1u64 << bits) - 1) as f64;
    let round = |p: &DVec3| {
        if step > 0.0 {
            ((*p - low) / step).round() * step + low
        } else {
            *p
        }
    };
    mesh.with_positions(mesh.positions.iter().map(round).collect())
}
