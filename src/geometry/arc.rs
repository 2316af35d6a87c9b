//! What a simplified mesh may have looked like: its chords replaced by arcs.

use super::vertex_normals;
use crate::mesh::Mesh;
use crate::order::order_by;

/// The mesh with every triangle split in four, the middle of each edge lifted half as far as an arc between the ends'
/// normals would be (PN triangles, Vlachos et al. 2001): a simplified mesh keeps to the surface about half as far as that.
pub fn refined(mesh: &Mesh) -> Mesh {
    let normals = vertex_normals(mesh);
    let edge = |a: u32, b: u32| u64::from(a.min(b)) << 32 | u64::from(a.max(b));
    let sides = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [edge(a, b), edge(b, c), edge(c, a)]);
    let order = order_by(sides);
    let mut positions = mesh.positions.clone();
    let mut middles = vec![0; order.len()];
    for sides in order.chunk_by(|a, b| a.0 == b.0) {
        let [a, b] = [sides[0].0 >> 32, sides[0].0 & u64::from(u32::MAX)].map(|end| end as usize);
        let (p, q) = (mesh.positions[a], mesh.positions[b]);
        let along = q - p;
        let lift = normals[b] * normals[b].dot(along) - normals[a] * normals[a].dot(along);
        sides
            .iter()
            .for_each(|&(_, side)| middles[side as usize] = positions.len() as u32);
        positions.push((p + q) * 0.5 + lift * (0.5 / 8.0));
    }
    let (middles, _) = middles.as_chunks::<3>();
    let split = |(&[a, b, c], &[ab, bc, ca]): (&[u32; 3], &[u32; 3])| {
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    let triangles = mesh.triangles.iter().zip(middles).flat_map(split).collect();
    Mesh {
        positions,
        triangles,
    }
}
