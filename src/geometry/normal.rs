//! Vertex normals.

use crate::mesh::Mesh;
use glam::DVec3;

/// V unit normals: the area-weighted mean over a vertex's faces; zero where that mean vanishes.
pub fn vertex_normals(mesh: &Mesh) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; mesh.positions.len()];
    for &triangle in &mesh.triangles {
        let [a, b, c] = mesh.corners(triangle);
        let twice_area = (b - a).cross(c - a);
        for vertex in triangle {
            normals[vertex as usize] += twice_area;
        }
    }
    normals
        .iter()
        .map(|normal| normal.normalize_or_zero())
        .collect()
}
