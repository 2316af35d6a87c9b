//! Another order of everything.

use crate::mesh::Mesh;
use crate::random::Random;

/// Random order of vertices, of triangles, and of the first corner in each.
pub fn reorder(mesh: &Mesh, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let names = random.permutation(mesh.positions.len());
    let mut positions = mesh.positions.clone();
    names
        .iter()
        .zip(&mesh.positions)
        .for_each(|(&name, &position)| positions[name as usize] = position);
    let order = random.permutation(mesh.triangles.len());
    let triangles = order.iter().map(|&triangle| {
        let mut corners = mesh.triangles[triangle as usize].map(|vertex| names[vertex as usize]);
        corners.rotate_left((random.bits() % 3) as usize);
        corners
    });
    Mesh {
        positions,
        triangles: triangles.collect(),
    }
}
