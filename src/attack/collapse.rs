//! Simplification by edge collapses, the cheapest first: what its methods have in common.

use super::editing::Editable;
use super::queue::{Candidate, Queue};
use crate::mesh::{Edges, Mesh};
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

/// A mesh whose edges collapse. Inside, a collapse takes two faces and three edges. An edge whose cost has risen since it was queued
/// goes back into the queue; one whose cost has fallen for a change that did not reach its ends waits.
pub(super) struct Collapse<P> {
    editable: Editable,
    placement: P,
    queue: Queue,
    /// How often each vertex has changed: a candidate of another count is out of date.
    ages: Vec<u32>,
    num_edges: usize,
    /// At the beginning.
    all_edges: usize,
}

impl<P: Placement> Collapse<P> {
    /// Queues all edges.
    pub fn new(mesh: &Mesh, placement: impl FnOnce(&Editable) -> P) -> Collapse<P> {
        let editable = Editable::new(mesh);
        let placement = placement(&editable);
        let mut all_edges = 0;
        let queue = Queue::new(Edges::new(mesh).ends().filter_map(|ends| {
            all_edges += 1;
            if !editable.is_small(ends) {
                return None;
            }
            let (_, cost) = placement.place(&editable, ends[0], ends[1])?;
            Some(Candidate::new(cost, ends, [0; 2]))
        }));
        Collapse {
            editable,
            placement,
            queue,
            ages: vec![0; mesh.positions.len()],
            num_edges: all_edges,
            all_edges,
        }
    }

    /// Collapses edges. Stops earlier where no collapse is left that keeps the surface's topology and turns no face over.
    /// O(F log F).
    pub fn run(&mut self, until: Until) {
        let (most_edges, most_faces) = match until {
            Until::WithoutEdges(part) => {
                (((1.0 - part) * self.all_edges as f64).ceil() as usize, 0)
            }
            Until::Faces(most) => (0, most),
        };
        while self.num_edges > most_edges && self.editable.num_faces() > most_faces {
            let ages = &self.ages;
            let Some(cheapest) = self.queue.pop(|candidate| candidate.is_current(ages)) else {
                break;
            };
            if cheapest.is_current(ages) {
                self.take(&cheapest);
            }
        }
    }

    /// Collapses an edge if it can be, and still costs what it did.
    fn take(&mut self, cheapest: &Candidate) {
        let [a, b] = cheapest.ends;
        if !self.editable.is_small([a, b]) {
            return;
        }
        let Some((to, cost)) = self.placement.place(&self.editable, a, b) else {
            return;
        };
        if cost.to_bits() > cheapest.cost {
            self.push(cost, [a, b]);
            return;
        }
        let num_faces = self.editable.num_faces();
        if !self.editable.collapse(a, b, to) {
            return;
        }
        self.num_edges -= 1 + num_faces - self.editable.num_faces();
        self.placement.merge(a, b);
        self.ages[a as usize] += 1;
        self.ages[b as usize] += 1;
        for neighbour in self.editable.neighbours(a) {
            let ends = [a.min(neighbour), a.max(neighbour)];
            if !self.editable.is_small(ends) {
                continue;
            }
            if let Some((_, cost)) = self.placement.place(&self.editable, ends[0], ends[1]) {
                self.push(cost, ends);
            }
        }
    }

    fn push(&mut self, cost: f64, ends: [u32; 2]) {
        let ages = ends.map(|v| self.ages[v as usize]);
        self.queue.push(Candidate::new(cost, ends, ages));
    }

    /// What is left.
    pub fn mesh(&self) -> Mesh {
        self.editable.mesh()
    }
}
