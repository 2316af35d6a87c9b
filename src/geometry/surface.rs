//! The nearest point of a surface.

use crate::mesh::{Edges, Mesh};
use glam::DVec3;

/// Triangles in a leaf.
const LEAF: usize = 4;

/// A tree halves at every node, and of 2^32 triangles, more than names go, is less deep: on the way down there is one open node a level, and one more.
const DEEPEST: usize = 33;

/// A mesh's triangles in a tree of bounding boxes. Construction O(F log F), a query O(log F) on surfaces that are not folded
/// all over.
pub struct Surface<'a> {
    mesh: &'a Mesh,
    /// The triangles, in the order of the leaves, and their corners: what is looked at together lies together.
    order: Vec<u32>,
    corners: Vec<[DVec3; 3]>,
    /// The root first; the first child of an inner node follows it.
    nodes: Vec<Node>,
}

struct Node {
    low: DVec3,
    high: DVec3,
    kind: Kind,
}

enum Kind {
    /// Where in the order its triangles are.
    Leaf(std::ops::Range<usize>),
    /// The second child.
    Inner(usize),
}

/// The point of a surface that is nearest to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The point.
    pub point: DVec3,
    /// Its distance.
    pub distance: f64,
    /// The triangle that it is in.
    pub triangle: u32,
    /// Its barycentric coordinates there: one is 0 on an edge, two at a corner.
    pub weights: [f64; 3],
}

impl Nearest {
    /// Whether it is on a side of its triangle that has no other, as [`open_sides`] tells them.
    pub fn is_at_boundary(&self, open: &[[bool; 3]]) -> bool {
        let open = open[self.triangle as usize];
        (0..3).any(|side| open[side] && self.weights[(side + 2) % 3] <= 0.0)
    }
}

/// For each triangle, which of its sides, from its first corner on, have no other triangle.
pub fn open_sides(mesh: &Mesh) -> Vec<[bool; 3]> {
    let edges = Edges::new(mesh);
    let mut open: Vec<(u32, u32)> = edges.boundary(&mesh.triangles).collect();
    open.sort_unstable();
    let is_open = |a: u32, b: u32| open.binary_search(&(a, b)).is_ok();
    let sides = |&[a, b, c]: &[u32; 3]| [is_open(a, b), is_open(b, c), is_open(c, a)];
    mesh.triangles.iter().map(sides).collect()
}

impl<'a> Surface<'a> {
    /// Sorts the triangles of a mesh. Those without area are left out: where they are, others are.
    pub fn new(mesh: &'a Mesh) -> Surface<'a> {
        let centres: Vec<DVec3> = mesh
            .triangles
            .iter()
            .map(|&t| mesh.corners(t).iter().sum::<DVec3>() / 3.0)
            .collect();
        let mut surface = Surface {
            mesh,
            order: (0u32..)
                .zip(&mesh.triangles)
                .filter(|(_, triangle)| {
                    let [a, b, c] = mesh.corners(**triangle);
                    (b - a).cross(c - a) != DVec3::ZERO
                })
                .map(|(number, _)| number)
                .collect(),
            corners: Vec::new(),
            nodes: Vec::new(),
        };
        if !surface.order.is_empty() {
            surface.grow(0..surface.order.len(), &centres);
        }
        let corners = |&t: &u32| mesh.corners(mesh.triangles[t as usize]);
        surface.corners = surface.order.iter().map(corners).collect();
        surface
    }

    /// The node of a range of triangles, and all below it.
    fn grow(&mut self, range: std::ops::Range<usize>, centres: &[DVec3]) {
        let corners = self.order[range.clone()]
            .iter()
            .flat_map(|&t| self.mesh.corners(self.mesh.triangles[t as usize]));
        let (low, high) = bounds(corners);
        let name = self.nodes.len();
        self.nodes.push(Node {
            low,
            high,
            kind: Kind::Leaf(range.clone()),
        });
        if range.len() <= LEAF {
            return;
        }
        let (from, to) = bounds(
            self.order[range.clone()]
                .iter()
                .map(|&t| centres[t as usize]),
        );
        let axis = (to - from).max_position();
        let half = range.len() / 2;
        self.order[range.clone()].select_nth_unstable_by(half, |&a, &b| {
            let key = |t: u32| centres[t as usize][axis];
            key(a).total_cmp(&key(b)).then(a.cmp(&b))
        });
        self.grow(range.start..range.start + half, centres);
        self.nodes[name].kind = Kind::Inner(self.nodes.len());
        self.grow(range.start + half..range.end, centres);
    }

    /// The point nearest to `from`, and the unit normal of its triangle; `None` where it is not nearer than a distance.
    pub fn foot(&self, from: DVec3, within: f64) -> Option<(DVec3, DVec3)> {
        let nearest = self.nearest_within(from, within)?;
        let [a, b, c] = self
            .mesh
            .corners(self.mesh.triangles[nearest.triangle as usize]);
        Some((nearest.point, (b - a).cross(c - a).normalize_or_zero()))
    }

    /// The point nearest to `from`; `None` for a mesh without area.
    pub fn nearest(&self, from: DVec3) -> Option<Nearest> {
        self.nearest_within(from, f64::INFINITY)
    }

    /// The same, `None` where it is not nearer than a distance: what is far away is told at once.
    pub fn nearest_within(&self, from: DVec3, within: f64) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        let mut least = within * within;
        let mut open = [(0.0, 0); DEEPEST];
        let mut num_open = 0;
        if let Some(root) = self.nodes.first() {
            open[0] = (root.distance_squared(from), 0);
            num_open = 1;
        }
        while num_open > 0 {
            num_open -= 1;
            let (square, name) = open[num_open];
            if square >= least {
                continue;
            }
            match &self.nodes[name].kind {
                Kind::Leaf(range) => {
                    let triangles = self.order[range.clone()].iter();
                    for (&triangle, corners) in triangles.zip(&self.corners[range.clone()]) {
                        let weights = nearest_weights(from, *corners);
                        let [a, b, c] = corners;
                        let point = weights[0] * a + weights[1] * b + weights[2] * c;
                        let square = point.distance_squared(from);
                        if square < least {
                            least = square;
                            best = Some(Nearest {
                                point,
                                distance: square.sqrt(),
                                triangle,
                                weights,
                            });
                        }
                    }
                }
                Kind::Inner(second) => {
                    let mut children = [name + 1, *second]
                        .map(|child| (self.nodes[child].distance_squared(from), child));
                    if children[0].0 < children[1].0 {
                        children.reverse();
                    }
                    // The nearer one is on top.
                    for child in children.into_iter().filter(|child| child.0 < least) {
                        open[num_open] = child;
                        num_open += 1;
                    }
                }
            }
        }
        best
    }
}

impl Node {
    fn distance_squared(&self, from: DVec3) -> f64 {
        from.clamp(self.low, self.high).distance_squared(from)
    }
}

fn bounds(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    })
}

/// Barycentric coordinates of the point of a triangle that is nearest to `from`: Ericson, Real-Time Collision Detection
/// (2005), section 5.1.5.
fn nearest_weights(from: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(from - a), ac.dot(from - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (d3, d4) = (ab.dot(from - b), ac.dot(from - b));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    let (d5, d6) = (ab.dot(from - c), ac.dot(from - c));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let total = va + vb + vc;
    [va / total, vb / total, vc / total]
}
