//! Which way is out.

use crate::mesh::{Edges, Mesh};
use glam::DVec3;

/// The triangles of a mesh with consistent winding within each patch of two-faced edges, and each patch turned so that its
/// signed volume about its own area centroid is not negative.
pub fn outward(mesh: &Mesh) -> Vec<[u32; 3]> {
    let winding = Edges::new(mesh).winding();
    let turn = |(&[a, b, c], &flip): (&[u32; 3], &bool)| if flip { [a, c, b] } else { [a, b, c] };
    let mut triangles: Vec<[u32; 3]> = mesh
        .triangles
        .iter()
        .zip(&winding.flips)
        .map(turn)
        .collect();

    let mut centroids = vec![(0.0, DVec3::ZERO); winding.num_patches];
    for (&triangle, &patch) in triangles.iter().zip(&winding.patches) {
        let [a, b, c] = mesh.corners(triangle);
        let area = (b - a).cross(c - a).length();
        let (total, sum) = &mut centroids[patch as usize];
        *total += area;
        *sum += (a + b + c) * (area / 3.0);
    }
    let mut volumes = vec![0.0; winding.num_patches];
    for (&triangle, &patch) in triangles.iter().zip(&winding.patches) {
        let (total, sum) = centroids[patch as usize];
        let [a, b, c] = mesh.corners(triangle).map(|corner| corner - sum / total);
        volumes[patch as usize] += a.dot(b.cross(c));
    }
    for (triangle, &patch) in triangles.iter_mut().zip(&winding.patches) {
        if volumes[patch as usize] < 0.0 {
            triangle.swap(1, 2);
        }
    }
    triangles
}
