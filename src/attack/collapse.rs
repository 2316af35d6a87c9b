//! Simplification by edge collapses, the cheapest first: what its methods have in common.

use super::editing::Editable;
use crate::mesh::Mesh;
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Candidates that a collapse mostly gives at most: with room for so many, those out of date are dropped before it has to grow.
const MOST_AT_ONCE: usize = 64;

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
    // Costs are not negative, so their bits are in their order.
    let entry = |ages: &[u32], cost: f64, a: u32, b: u32| {
        Reverse((cost.to_bits(), a, b, ages[a as usize], ages[b as usize]))
    };
    let edges = editable.edges();
    let mut num_edges = edges.len();
    let (most_edges, most_faces) = match until {
        Until::WithoutEdges(part) => (((1.0 - part) * num_edges as f64).ceil() as usize, 0),
        Until::Faces(most) => (0, most),
    };
    let mut heap = BinaryHeap::with_capacity(edges.len() / 4 * 5 + MOST_AT_ONCE);
    heap.extend(edges.into_iter().filter_map(|[a, b]| {
        let (_, cost) = placement.place(&editable, a, b)?;
        Some(entry(&ages, cost, a, b))
    }));
    while num_edges > most_edges && editable.num_faces() > most_faces {
        let Some(Reverse((queued, a, b, age_a, age_b))) = heap.pop() else {
            break;
        };
        if (age_a, age_b) != (ages[a as usize], ages[b as usize]) {
            continue;
        }
        let Some((to, cost)) = placement.place(&editable, a, b) else {
            continue;
        };
        if cost.to_bits() > queued {
            heap.push(entry(&ages, cost, a, b));
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
        if heap.len() + MOST_AT_ONCE > heap.capacity() {
            heap.retain(|Reverse((_, a, b, age_a, age_b))| {
                (*age_a, *age_b) == (ages[*a as usize], ages[*b as usize])
            });
        }
        for neighbour in editable.neighbours(a) {
            let (a, b) = (a.min(neighbour), a.max(neighbour));
            if let Some((_, cost)) = placement.place(&editable, a, b) {
                heap.push(entry(&ages, cost, a, b));
            }
        }
    }
    editable.into_mesh()
}
