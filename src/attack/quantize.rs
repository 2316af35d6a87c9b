//! Quantization of positions.

use crate::geometry::{evenly, rounded};
use crate::mesh::Mesh;

/// Rounds every coordinate to a multiple of `2^-bits` of the bounding box's side along it, from the lower face on, as the LIRIS
/// benchmark (Wang et al. 2010): `2^bits + 1` values on each axis, the upper face's among them.
pub fn quantize(mesh: &Mesh, bits: u32) -> Mesh {
    rounded(mesh, |extent| extent / (1u64 << bits) as f64)
}

/// Rounds every coordinate to one of `2^bits` values along the longest side of the bounding box, with the same steps on all axes, as
/// glTF's optimisers do: harder on flat models than [`quantize`].
pub fn quantize_evenly(mesh: &Mesh, bits: u32) -> Mesh {
    rounded(mesh, |extent| evenly(extent, bits))
}
