//! Models taken apart.

use crate::mesh::{Edges, Mesh};
use crate::random::Random;
use glam::DVec3;

/// Materials that a model is divided among.
const MATERIALS: usize = 4;

/// Takes out the component of the second largest area, of those that edges join: of what can be missing without the model being
/// another one, the most. A mesh of one component stays as it is.
pub fn take_out(mesh: &Mesh) -> Mesh {
    let labels = Edges::new(mesh).components();
    let mut areas: Vec<(f64, u32)> = Vec::new();
    for (&label, &triangle) in labels.iter().zip(&mesh.triangles) {
        let [a, b, c] = mesh.corners(triangle);
        if label as usize == areas.len() {
            areas.push((0.0, label));
        }
        areas[label as usize].0 += (b - a).cross(c - a).length();
    }
    areas.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let Some(&(_, gone)) = areas.get(1) else {
        return mesh.clone();
    };
    let pairs = mesh.triangles.iter().zip(&labels);
    mesh.part(pairs.filter(|(_, label)| **label != gone).map(|(&t, _)| t))
}

/// Divides the surface among four materials, each triangle by the nearest of as many random ones, and writes material by material, in
/// random order, each with its own copies of the vertices.
pub fn split(mesh: &Mesh, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let centre = |&triangle: &[u32; 3]| mesh.corners(triangle).iter().sum::<DVec3>() / 3.0;
    let order = random.permutation(mesh.triangles.len());
    let middles: Vec<DVec3> = order
        .iter()
        .take(MATERIALS)
        .map(|&face| centre(&mesh.triangles[face as usize]))
        .collect();
    let mut materials = vec![Vec::new(); middles.len()];
    for triangle in &mesh.triangles {
        let distance = |i: &usize| middles[*i].distance_squared(centre(triangle));
        let nearest = (0..middles.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest
            .into_iter()
            .for_each(|material| materials[material].push(*triangle));
    }
    let order = random.permutation(materials.len());
    Mesh::joined(
        order
            .iter()
            .map(|&material| mesh.part(materials[material as usize].iter().copied())),
    )
}
