//! Which way is out.

use crate::mesh::{Edges, Mesh};
use glam::DVec3;

/// A patch whose signed volume is smaller than this, times the area to the power 3/2, has no inside to speak of.
const FLAT: f64 = 5e-5;

/// The triangles of a mesh with consistent winding within each patch of two-faced edges, and each patch turned so that its
/// signed volume about its own area centroid is positive; flat ones face as most of their area did.
pub fn outward(mesh: &Mesh) -> Vec<[u32; 3]> {
    outward_along(mesh, &Edges::new(mesh))
}

/// A mesh that faces outwards, and its edges that have one face, directed as these are.
pub fn oriented(mesh: &Mesh) -> (Mesh, Vec<(u32, u32)>) {
    let edges = Edges::new(mesh);
    let triangles = outward_along(mesh, &edges);
    let boundary = edges.boundary(&triangles).collect();
    let positions = mesh.positions.clone();
    let oriented = Mesh {
        positions,
        triangles,
    };
    (oriented, boundary)
}

fn outward_along(mesh: &Mesh, edges: &Edges) -> Vec<[u32; 3]> {
    let winding = edges.winding();
    let turn = |(&[a, b, c], &flip): (&[u32; 3], &bool)| if flip { [a, c, b] } else { [a, b, c] };
    let mut triangles: Vec<[u32; 3]> = mesh
        .triangles
        .iter()
        .zip(&winding.flips)
        .map(turn)
        .collect();

    let mut patches = vec![Patch::default(); winding.num_patches];
    for ((&triangle, &number), &flip) in triangles.iter().zip(&winding.patches).zip(&winding.flips)
    {
        let [a, b, c] = mesh.corners(triangle);
        let area = (b - a).cross(c - a).length() * 0.5;
        let patch = &mut patches[number as usize];
        patch.area += area;
        patch.first += (a + b + c) * (area / 3.0);
        patch.kept += if flip { -area } else { area };
    }
    for (&triangle, &number) in triangles.iter().zip(&winding.patches) {
        let patch = &mut patches[number as usize];
        let centroid = patch.first / patch.area;
        let [a, b, c] = mesh.corners(triangle).map(|corner| corner - centroid);
        patch.volume += a.dot(b.cross(c)) / 6.0;
    }
    for (triangle, &number) in triangles.iter_mut().zip(&winding.patches) {
        if patches[number as usize].faces_inwards() {
            triangle.swap(1, 2);
        }
    }
    triangles
}

/// Sums over a patch with consistent winding.
#[derive(Clone, Default)]
struct Patch {
    area: f64,
    first: DVec3,
    /// Area that faces as it did, less area that was turned.
    kept: f64,
    volume: f64,
}

impl Patch {
    fn faces_inwards(&self) -> bool {
        if self.volume.abs() > FLAT * self.area * self.area.sqrt() {
            self.volume < 0.0
        } else {
            self.kept < 0.0
        }
    }
}
