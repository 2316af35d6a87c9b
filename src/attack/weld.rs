//! Merging by distance.

use crate::geometry::diagonal;
use crate::mesh::Mesh;
use std::collections::BTreeMap;

/// Merges every vertex into the first that is no more than `distance` times the bounding box's diagonal away, if that one was not
/// merged itself; triangles that lose a corner go. What importers and clean-up tools do, seams or not. O(V log V).
pub fn weld(mesh: &Mesh, distance: f64) -> Mesh {
    let reach = distance * diagonal(&mesh.positions);
    if reach <= 0.0 {
        return mesh.clone();
    }
    let mut cells: BTreeMap<[i64; 3], Vec<u32>> = BTreeMap::new();
    let mut kept = Vec::with_capacity(mesh.positions.len());
    for (&position, vertex) in mesh.positions.iter().zip(0u32..) {
        let cell = (position / reach).floor().to_array().map(|x| x as i64);
        let around = (0..27).map(|n| [0, 1, 2].map(|i| cell[i] + n / [1, 3, 9][i] % 3 - 1));
        let near = around
            .filter_map(|cell| cells.get(&cell))
            .flatten()
            .filter(|&&v| mesh.positions[v as usize].distance(position) <= reach);
        let first = near.min().copied().unwrap_or(vertex);
        if first == vertex {
            cells.entry(cell).or_default().push(vertex);
        }
        kept.push(first);
    }
    let merged = mesh.triangles.iter().map(|t| t.map(|v| kept[v as usize]));
    mesh.part(merged.filter(|&[a, b, c]| a != b && b != c && c != a))
}
