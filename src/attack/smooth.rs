//! Smoothing by the umbrella operator.

use crate::mesh::{Edges, Mesh, Rings};
use glam::DVec3;

/// Moves every vertex by `lambda` of the way to the mean of its neighbours, `steps` times, on boundaries too, as modelling
/// programs do.
pub fn smooth(mesh: &Mesh, lambda: f64, steps: u32) -> Mesh {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let mut positions = mesh.positions.clone();
    for _ in 0..steps {
        positions = stepped(&positions, &rings, lambda, |_| true);
    }
    mesh.with_positions(positions)
}

/// The same, but vertices of a boundary stay: the LIRIS benchmark (Wang et al. 2010), with lambda 0.10, 5 to 50 times.
pub fn smooth_inside(mesh: &Mesh, lambda: f64, steps: u32) -> Mesh {
    let edges = Edges::new(mesh);
    let mut moves = vec![true; mesh.positions.len()];
    for (from, to) in edges.boundary(&mesh.triangles) {
        moves[from as usize] = false;
        moves[to as usize] = false;
    }
    let rings = edges.rings(mesh.positions.len());
    let mut positions = mesh.positions.clone();
    for _ in 0..steps {
        positions = stepped(&positions, &rings, lambda, |v| moves[v]);
    }
    mesh.with_positions(positions)
}

/// Smoothing that does not shrink (Taubin 1995): `steps` times a step by `lambda` > 0 and one by `mu` < -`lambda`. Boundaries
/// move too, as they do in modelling programs, whose defaults are 0.5 and -0.53.
pub fn taubin(mesh: &Mesh, lambda: f64, mu: f64, steps: u32) -> Mesh {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let mut positions = mesh.positions.clone();
    for _ in 0..steps {
        positions = stepped(&positions, &rings, lambda, |_| true);
        positions = stepped(&positions, &rings, mu, |_| true);
    }
    mesh.with_positions(positions)
}

/// Moves every vertex by -`lambda` times its bilaplacian, `steps` times: the umbrella of the vertices' umbrellas, where an
/// umbrella leads to the mean of the neighbours (Belyaev and Ohtake 2003). It flattens the change of curvature and not curvature,
/// so it shrinks less. Stable for `lambda` up to 0.5. Vertices whose rings are not closed stay.
pub fn bilaplacian(mesh: &Mesh, lambda: f64, steps: u32) -> Mesh {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let mut positions = mesh.positions.clone();
    for _ in 0..steps {
        let twice = umbrellas(&umbrellas(&positions, &rings), &rings);
        for (v, position) in positions.iter_mut().enumerate() {
            if rings.is_closed(v) {
                *position -= twice[v] * lambda;
            }
        }
    }
    mesh.with_positions(positions)
}

/// From each value to the mean of its neighbours'.
fn umbrellas(values: &[DVec3], rings: &Rings) -> Vec<DVec3> {
    let means = stepped(values, rings, 1.0, |_| true);
    means
        .iter()
        .zip(values)
        .map(|(mean, value)| mean - value)
        .collect()
}

/// One step of all vertices at once.
fn stepped(
    positions: &[DVec3],
    rings: &Rings,
    fraction: f64,
    moves: impl Fn(usize) -> bool,
) -> Vec<DVec3> {
    let moved = |v: usize| {
        let neighbours = rings.neighbours(v);
        if neighbours.is_empty() || !moves(v) {
            return positions[v];
        }
        let sum: DVec3 = neighbours.iter().map(|&n| positions[n as usize]).sum();
        positions[v].lerp(sum / neighbours.len() as f64, fraction)
    };
    (0..positions.len()).map(moved).collect()
}
