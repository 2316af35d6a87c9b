//! Merging by distance.

use crate::geometry::{diagonal, merged};
use crate::mesh::Mesh;

/// Merges every vertex into the first that is no more than `distance` times the bounding box's diagonal away, if that one was not
/// merged itself; triangles that lose a corner go. What importers and clean-up tools do, seams or not. O(V log V).
pub fn weld(mesh: &Mesh, distance: f64) -> Mesh {
    let reach = distance * diagonal(&mesh.positions);
    if reach <= 0.0 {
        return mesh.clone();
    }
    let mut kept: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let points: Vec<(u32, u8)> = kept.iter().map(|&vertex| (vertex, 0)).collect();
    for (vertex, first) in merged(&mesh.positions, &points, &[reach], |_, _| true) {
        kept[vertex as usize] = first;
    }
    let renamed = mesh.triangles.iter().map(|t| t.map(|v| kept[v as usize]));
    mesh.part(renamed.filter(|&[a, b, c]| a != b && b != c && c != a))
}
