//! Triangles that share nothing.

use crate::mesh::Mesh;

/// Gives every triangle three vertices of its own, as in a capture from a graphics card. V = 3 F.
pub fn soup(mesh: &Mesh) -> Mesh {
    let corners = mesh.triangles.iter().flat_map(|&t| mesh.corners(t));
    let names = (0..mesh.triangles.len() as u32).map(|face| [0, 1, 2].map(|i| 3 * face + i));
    Mesh {
        positions: corners.collect(),
        triangles: names.collect(),
    }
}
