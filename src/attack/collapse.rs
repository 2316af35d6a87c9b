//! Simplification by edge collapses, the cheapest first: what its methods have in common.

use super::editing::Editable;
use super::queue::{Candidate, Queue};
use crate::mesh::Mesh;
use glam::DVec3;

/// What a method of simplification decides.
pub(super) trait Placement {
    /// Where the vertex goes that is to replace an edge's two, and what that costs: not negative. `None`: the edge stays.
    fn place(&self, editable: &Editable, a: u32, b: u32) -> Option<(DVec3, f64)>;

    /// One vertex has become the other.
    fn merge(&mut self, kept: u32, lost: u32);
}

/// When to stop.
#[derive(Clone, Copy)]
pub(super) enum Until {
    /// The fraction (0 to 1) of the edges is gone, as the LIRIS benchmark counts (Wang et al. 2010).
    WithoutEdges(f64),
    /// No more faces are left than that.
    Faces(usize),
}

/// Collapses edges. Inside, a collapse takes two faces and three edges. Stops earlier where no
/// collapse is left that keeps the surface's topology and turns no face over. An edge whose cost has risen since it was queued goes
/// back into the queue; one whose cost has fallen for a change that did not reach its ends waits. O(F log F).
pub(super) fn collapse(mesh: &Mesh, mut placement: impl Placement, until: Until) -> Mesh {
    let mut editable = Editable::new(mesh);
    // Counts a vertex's changes: a candidate of another count is out of date.
    let mut ages = vec![0u32; mesh.positions.len()];
    let candidate = |ages: &[u32], cost: f64, a: u32, b: u32| Candidate {
        cost: cost.to_bits(),
        ends: [a, b],
        ages: [a, b].map(|v| ages[v as usize]),
    };
    let is_current =
        |ages: &[u32],
         Candidate {
             ends, ages: then, ..
         }: &Candidate| { ends.map(|v| ages[v as usize]) == *then };
    let edges = editable.edges();
    let mut num_edges = edges.len();
    let (most_edges, most_faces) = match until {
        Until::WithoutEdges(part) => (((1.0 - part) * num_edges as f64).ceil() as usize, 0),
        Until::Faces(most) => (0, most),
    };
    let mut queue = Queue::new(edges.into_iter().filter_map(|[a, b]| {
        let (_, cost) = placement.place(&editable, a, b)?;
        Some(candidate(&ages, cost, a, b))
    }));
    while num_edges > most_edges && editable.num_faces() > most_faces {
        let Some(cheapest) = queue.pop(|candidate| is_current(&ages, candidate)) else {
            break;
        };
        if !is_current(&ages, &cheapest) {
            continue;
        }
        let [a, b] = cheapest.ends;
        let Some((to, cost)) = placement.place(&editable, a, b) else {
            continue;
        };
        if cost.to_bits() > cheapest.cost {
            queue.push(candidate(&ages, cost, a, b));
            continue;
        }
        let num_faces = editable.num_faces();
        if !editable.collapse(a, b, to) {
            continue;
        }
        num_edges -= 1 + num_faces - editable.num_faces();
        placement.merge(a, b);
        ages[a as usize] += 1;
        ages[b as usize] += 1;
        for neighbour in editable.neighbours(a) {
            let (a, b) = (a.min(neighbour), a.max(neighbour));
            if let Some((_, cost)) = placement.place(&editable, a, b) {
                queue.push(candidate(&ages, cost, a, b));
            }
        }
    }
    editable.into_mesh()
}
