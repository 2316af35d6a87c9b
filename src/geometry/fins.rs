//! Needles on the surface that no other triangle goes on from: they cover nothing, and part the surface that they stand on.

use super::facet::Facet;
use crate::mesh::Mesh;
use crate::order::order_by;

/// Says of each triangle whether it is no fin: a sliver, or without area, of which one edge has three triangles or more and the two others
/// have it alone. `None` where there are none. O(F + S log S), S the number of triangles about slivers.
pub fn without_fins(mesh: &Mesh) -> Option<Vec<bool>> {
    let is_thin = |triangle: &[u32; 3]| Facet::of(mesh.corners(*triangle), 0.0) != Facet::Plain;
    let thin: Vec<bool> = mesh.triangles.iter().map(is_thin).collect();
    let mut is_near = vec![false; mesh.positions.len()];
    let slivers = mesh.triangles.iter().zip(&thin).filter(|(_, thin)| **thin);
    for &vertex in slivers.flat_map(|(triangle, _)| triangle) {
        is_near[vertex as usize] = true;
    }
    let (mut sides, mut faces): (Vec<u64>, Vec<u32>) = Default::default();
    for (&[a, b, c], face) in mesh.triangles.iter().zip(0..) {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            if is_near[a as usize] && is_near[b as usize] {
                sides.push(u64::from(a.min(b)) << 32 | u64::from(a.max(b)));
                faces.push(face);
            }
        }
    }
    // Of each triangle: edges that it has alone, edges of three triangles and more.
    let mut numbers = vec![[0u8; 2]; mesh.triangles.len()];
    for edge in order_by(sides.into_iter()).chunk_by(|a, b| a.0 == b.0) {
        let kind = match edge.len() {
            1 => 0,
            2 => continue,
            _ => 1,
        };
        for &(_, side) in edge {
            numbers[faces[side as usize] as usize][kind] += 1;
        }
    }
    let is_kept = |(is_thin, numbers): (bool, [u8; 2])| !(is_thin && numbers == [2, 1]);
    let kept: Vec<bool> = thin.into_iter().zip(numbers).map(is_kept).collect();
    kept.contains(&false).then_some(kept)
}
