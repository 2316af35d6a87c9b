//! Laplacian smoothing.

use crate::mesh::{Edges, Mesh};
use glam::DVec3;

/// Moves every vertex by `lambda` of the way to the mean of its neighbours, `steps` times. The LIRIS benchmark (Wang et al.
/// 2010) smooths with lambda 0.10, 5 to 50 times.
pub fn smooth(mesh: &Mesh, lambda: f64, steps: u32) -> Mesh {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let mut positions = mesh.positions.clone();
    for _ in 0..steps {
        let moved = |v: usize| {
            let neighbours = rings.neighbours(v);
            if neighbours.is_empty() {
                return positions[v];
            }
            let mean = neighbours
                .iter()
                .map(|&n| positions[n as usize])
                .sum::<DVec3>()
                / neighbours.len() as f64;
            positions[v].lerp(mean, lambda)
        };
        positions = (0..positions.len()).map(moved).collect();
    }
    mesh.with_positions(positions)
}
