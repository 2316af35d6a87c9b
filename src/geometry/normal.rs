//! Normals of faces and vertices.

use crate::mesh::Mesh;
use glam::DVec3;

/// F area vectors: each along a face's normal, as long as its area, in squared scene units.
pub fn face_areas(mesh: &Mesh) -> Vec<DVec3> {
    let area = |&triangle: &[u32; 3]| {
        let [a, b, c] = mesh.corners(triangle);
        (b - a).cross(c - a) * 0.5
    };
    mesh.triangles.iter().map(area).collect()
}

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

/// V angles, 0 to pi: the largest between a vertex's normal and those of its faces. `areas` are the mesh's [`face_areas`],
/// `normals` its [`vertex_normals`].
pub fn normal_deviations(mesh: &Mesh, areas: &[DVec3], normals: &[DVec3]) -> Vec<f64> {
    // By the square of the chord, which is as exact for small angles as for large ones.
    let mut chords = vec![0.0f64; mesh.positions.len()];
    for (triangle, area) in mesh.triangles.iter().zip(areas) {
        let normal = area.normalize_or_zero();
        for &vertex in triangle {
            let chord = &mut chords[vertex as usize];
            *chord = chord.max(normal.distance_squared(normals[vertex as usize]));
        }
    }
    let angle = |chord: f64| 2.0 * libm::asin((chord.sqrt() / 2.0).min(1.0));
    chords.into_iter().map(angle).collect()
}
