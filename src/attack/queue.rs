//! Candidates in the order of their costs, most of them not yet sorted.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Candidates whose costs agree but for this many of their last bits wait together.
const DROPPED_BITS: u32 = 50;

/// An edge as it was when it was queued.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Candidate {
    /// The bits of what its collapse costs. Costs are not negative, so these are in their order.
    pub cost: u64,
    /// Its vertices.
    pub ends: [u32; 2],
    /// How often each of them had changed.
    ages: [u32; 2],
}

impl Candidate {
    /// With a cost that is not negative.
    pub fn new(cost: f64, ends: [u32; 2], ages: [u32; 2]) -> Candidate {
        Candidate {
            cost: cost.to_bits(),
            ends,
            ages,
        }
    }

    /// Whether its vertices have not changed since.
    pub fn is_current(&self, ages: &[u32]) -> bool {
        self.ends.map(|v| ages[v as usize]) == self.ages
    }
}

/// A priority queue, the least candidate first: a heap of those that are next, which fits into a processor's cache, and the others
/// in unsorted lists by cost. (One heap of a million vertices' edges misses the cache at nearly every step of every removal.)
pub(super) struct Queue {
    /// All candidates of a class up to `class`.
    next: BinaryHeap<Reverse<Candidate>>,
    class: usize,
    /// By class.
    waiting: Vec<Vec<Candidate>>,
    num_waiting: usize,
    /// When more wait, those that are out of date are dropped.
    most_waiting: usize,
}

impl Queue {
    /// All of these.
    pub fn new(candidates: impl Iterator<Item = Candidate>) -> Queue {
        let mut queue = Queue {
            next: BinaryHeap::new(),
            class: 0,
            waiting: Vec::new(),
            num_waiting: 0,
            most_waiting: usize::MAX,
        };
        candidates.for_each(|candidate| queue.push(candidate));
        queue.most_waiting = (queue.next.len() + queue.num_waiting) / 4 * 5;
        queue
    }

    pub fn push(&mut self, candidate: Candidate) {
        let class = (candidate.cost >> DROPPED_BITS) as usize;
        if class <= self.class {
            self.next.push(Reverse(candidate));
            return;
        }
        if class >= self.waiting.len() {
            self.waiting.resize_with(class + 1, Vec::new);
        }
        self.waiting[class].push(candidate);
        self.num_waiting += 1;
    }

    /// The least one; those that are not `current` may be dropped on the way.
    pub fn pop(&mut self, current: impl Fn(&Candidate) -> bool) -> Option<Candidate> {
        if self.num_waiting > self.most_waiting {
            for list in &mut self.waiting {
                list.retain(&current);
            }
            self.num_waiting = self.waiting.iter().map(Vec::len).sum();
            // So that it is done rarely even where none is out of date.
            self.most_waiting = self.most_waiting.max(2 * self.num_waiting);
        }
        while self.next.is_empty() {
            self.class += 1;
            let mut list = std::mem::take(self.waiting.get_mut(self.class)?);
            self.num_waiting -= list.len();
            list.retain(&current);
            self.next = list.into_iter().map(Reverse).collect();
        }
        self.next.pop().map(|Reverse(candidate)| candidate)
    }
}
