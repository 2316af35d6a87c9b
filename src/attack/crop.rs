//! Cropping by a plane.

use crate::mesh::Mesh;
use crate::random::Random;

/// Cuts away the `fraction` (0 to 1) of the vertices that lie furthest along a random direction, with their triangles.
/// The cropping of the LIRIS benchmark (Wang et al. 2010) removes 10, 30 and 50 %.
pub fn crop(mesh: &Mesh, fraction: f64, seed: u64) -> Mesh {
    let direction = Random::new(seed).direction();
    let mut order: Vec<(f64, u32)> = mesh
        .positions
        .iter()
        .map(|p| p.dot(direction))
        .zip(0..)
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    order.truncate(((1.0 - fraction) * order.len() as f64).round() as usize);
    let mut kept: Vec<u32> = order.into_iter().map(|(_, vertex)| vertex).collect();
    kept.sort_unstable();

    let mut renamed = vec![None; mesh.positions.len()];
    kept.iter()
        .zip(0u32..)
        .for_each(|(&vertex, name)| renamed[vertex as usize] = Some(name));
    let rename = |&[a, b, c]: &[u32; 3]| {
        Some([
            renamed[a as usize]?,
            renamed[b as usize]?,
            renamed[c as usize]?,
        ])
    };
    Mesh {
        positions: kept
            .iter()
            .map(|&vertex| mesh.positions[vertex as usize])
            .collect(),
        triangles: mesh.triangles.iter().filter_map(rename).collect(),
    }
}
