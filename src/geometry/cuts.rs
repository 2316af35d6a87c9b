//! Where a movement makes a surface cut itself: what slicers refuse to print.

use super::Parts;
use crate::mesh::Mesh;
use crate::order::order_by;
use glam::DVec3;

/// Triangles in a leaf of the tree.
const LEAF: usize = 4;

/// Pairs of nodes that are looked at for each leaf, at most: a fan of 65 000 triangles about one vertex has 8000, and would take minutes.
const MOST_LOOKS: usize = 512;

/// What was within this fraction of its part's diagonal before touched already.
const TOUCH: f64 = 1e-6;

/// The pairs of triangles of one part that cut each other after the V vertices went to other positions, and neither cut nor touched before.
/// Triangles with a common edge are left to the turns that they may make. O(F log F) on surfaces that are not folded all over.
pub fn cuts(mesh: &Mesh, parts: &Parts, after: &[DVec3]) -> Vec<[u32; 2]> {
    let place = |triangle: u32| mesh.triangles[triangle as usize].map(|v| after[v as usize]);
    let tree = Tree::new(mesh.triangles.len(), place);
    let mut cuts = Vec::new();
    tree.for_each_pair(|a, b| {
        let [part, other] = [a, b].map(|triangle| parts.of_triangles[triangle as usize]);
        let corners = [a, b].map(|triangle| mesh.triangles[triangle as usize]);
        if part == other && are_cut(corners, |v| after[v as usize], 0.0) {
            let touch = TOUCH * parts.diagonals[part as usize];
            if !are_cut(corners, |v| mesh.positions[v as usize], touch) {
                cuts.push([a, b]);
            }
        }
    });
    cuts
}

/// Whether two triangles cut each other where they have no corner in common.
fn are_cut([a, b]: [[u32; 3]; 2], at: impl Fn(u32) -> DVec3, touch: f64) -> bool {
    if a.iter().filter(|v| b.contains(v)).count() > 1 {
        return false;
    }
    let [p, q] = [a, b].map(|triangle| triangle.map(&at));
    if is_beside(q, b.map(|v| a.contains(&v)), p, touch)
        || is_beside(p, a.map(|v| b.contains(&v)), q, touch)
    {
        return false;
    }
    let reaches = |from: [u32; 3], corners: [DVec3; 3], into: [u32; 3], others: [DVec3; 3]| {
        [[0, 1], [1, 2], [2, 0]].into_iter().any(|side| {
            let is_free = !side.iter().any(|&end| into.contains(&from[end]));
            is_free && pierces(side.map(|end| corners[end]), others, touch)
        })
    };
    reaches(a, p, b, q) || reaches(b, q, a, p)
}

/// Whether all corners of a triangle that are not shared lie on one side of another's plane.
fn is_beside(corners: [DVec3; 3], is_shared: [bool; 3], [a, b, c]: [DVec3; 3], touch: f64) -> bool {
    let normal = (b - a).cross(c - a);
    let near = touch * normal.length();
    let (mut above, mut below) = (true, true);
    for (corner, is_shared) in corners.into_iter().zip(is_shared) {
        let side = (corner - a).dot(normal);
        above &= is_shared || side > near;
        below &= is_shared || side < -near;
    }
    above || below
}

/// Whether a segment goes through a triangle, or comes so near.
fn pierces([p, q]: [DVec3; 2], [a, b, c]: [DVec3; 3], touch: f64) -> bool {
    let normal = (b - a).cross(c - a);
    let size = normal.length();
    let [above, below] = [p, q].map(|end| (end - a).dot(normal));
    let is_apart = above * below > 0.0 || above == below;
    if size == 0.0 || is_apart && above.abs().min(below.abs()) > touch * size {
        return false;
    }
    if is_apart && touch == 0.0 {
        return false;
    }
    let share = (above / (above - below)).clamp(0.0, 1.0);
    let point = match is_apart {
        true if above.abs() < below.abs() => p,
        true => q,
        false => p + (q - p) * share,
    };
    [[a, b], [b, c], [c, a]].into_iter().all(|[from, to]| {
        let outward = (to - from).cross(normal);
        (point - from).dot(outward) <= touch * outward.length()
    })
}

/// Boxes about triangles, those that lie near each other side by side.
struct Tree {
    order: Vec<u32>,
    /// Of each triangle, by its place.
    boxes: Vec<Span>,
    /// Of a heap: the children of node n are 2 n + 1 and 2 n + 2; the last `leaves` are leaves.
    nodes: Vec<Span>,
    leaves: usize,
}

#[derive(Clone, Copy)]
struct Span {
    low: [f32; 3],
    high: [f32; 3],
}

impl Span {
    const NONE: Span = Span {
        low: [f32::INFINITY; 3],
        high: [f32::NEG_INFINITY; 3],
    };

    /// Of corners, not smaller for being rounded.
    fn of([a, b, c]: [DVec3; 3]) -> Span {
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        Span {
            low: low.to_array().map(|x| (x as f32).next_down()),
            high: high.to_array().map(|x| (x as f32).next_up()),
        }
    }

    fn with(self, other: Span) -> Span {
        Span {
            low: std::array::from_fn(|i| self.low[i].min(other.low[i])),
            high: std::array::from_fn(|i| self.high[i].max(other.high[i])),
        }
    }

    fn meets(&self, other: &Span) -> bool {
        // All at once: which of them fails is not to be foreseen.
        (0..3).fold(true, |meets, i| {
            meets & (self.low[i] <= other.high[i]) & (other.low[i] <= self.high[i])
        })
    }
}

impl Tree {
    fn new(num: usize, place: impl Fn(u32) -> [DVec3; 3]) -> Tree {
        let all: Vec<Span> = (0..num as u32).map(|t| Span::of(place(t))).collect();
        let whole = all.iter().fold(Span::NONE, |whole, span| whole.with(*span));
        let code = |span: &Span| {
            let axis = |i: usize| {
                let middle = (span.low[i] + span.high[i]) / 2.0 - whole.low[i];
                spread((middle / (whole.high[i] - whole.low[i]) * 1023.0) as u64)
            };
            axis(0) << 2 | axis(1) << 1 | axis(2)
        };
        let order: Vec<u32> = order_by(all.iter().map(code))
            .into_iter()
            .map(|(_, t)| t)
            .collect();
        let boxes: Vec<Span> = order.iter().map(|&t| all[t as usize]).collect();
        let leaves = num.div_ceil(LEAF).next_power_of_two();
        let mut nodes = vec![Span::NONE; 2 * leaves - 1];
        for (leaf, boxes) in boxes.chunks(LEAF).enumerate() {
            nodes[leaves - 1 + leaf] = boxes.iter().fold(Span::NONE, |all, one| all.with(*one));
        }
        for node in (0..leaves - 1).rev() {
            nodes[node] = nodes[2 * node + 1].with(nodes[2 * node + 2]);
        }
        Tree {
            order,
            boxes,
            nodes,
            leaves,
        }
    }

    /// Shows every pair of triangles whose boxes meet, once; of those of surfaces that are folded all over, only some.
    fn for_each_pair(&self, mut show: impl FnMut(u32, u32)) {
        let mut open = vec![(0, 0)];
        for _ in 0..MOST_LOOKS * self.leaves {
            let Some((a, b)) = open.pop() else { break };
            if a != b && !self.nodes[a].meets(&self.nodes[b]) {
                continue;
            }
            let children = |node: usize| [2 * node + 1, 2 * node + 2];
            match (a + 1 >= self.leaves, a == b) {
                (true, _) => self.show_leaves([a, b], &mut show),
                (false, true) => {
                    let [first, second] = children(a);
                    open.extend([(first, first), (first, second), (second, second)]);
                }
                (false, false) => {
                    for first in children(a) {
                        open.extend(children(b).map(|second| (first, second)));
                    }
                }
            }
        }
    }

    fn show_leaves(&self, [a, b]: [usize; 2], show: &mut impl FnMut(u32, u32)) {
        let places = |leaf: usize| {
            let start = (leaf + 1 - self.leaves) * LEAF;
            start.min(self.order.len())..(start + LEAF).min(self.order.len())
        };
        for i in places(a) {
            for j in places(b) {
                if (a != b || i < j) && self.boxes[i].meets(&self.boxes[j]) {
                    show(self.order[i], self.order[j]);
                }
            }
        }
    }
}

/// Ten bits, each with two zeros before the next.
fn spread(x: u64) -> u64 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}
