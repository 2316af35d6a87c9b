//! Edges of a triangle soup, sorted: the equivalent of half-edges that accepts edges with any number of faces.

use super::{Mesh, Sets};

/// One side of a triangle.
#[derive(Clone, Copy, Default)]
struct Side {
    low: u32,
    high: u32,
    /// The triangle's number, doubled, and 1 more where it runs from `low` to `high`.
    direction: u32,
}

impl Side {
    fn new(from: u32, to: u32, face: u32) -> Side {
        Side {
            low: from.min(to),
            high: from.max(to),
            direction: face << 1 | u32::from(from < to),
        }
    }

    fn face(&self) -> u32 {
        self.direction >> 1
    }

    fn is_ascending(&self) -> bool {
        self.direction & 1 == 1
    }
}

/// All sides of all triangles, those of one edge side by side, in the order of their faces. Construction O(V + F log D), D the most
/// faces at a vertex; 12 bytes a side.
pub struct Edges {
    sides: Vec<Side>,
    num_faces: usize,
}

impl Edges {
    /// Collects the edges of a mesh.
    pub fn new(mesh: &Mesh) -> Edges {
        let sides = || {
            let faces = mesh.triangles.iter().zip(0..);
            faces.flat_map(|(&[a, b, c], face)| {
                [(a, b), (b, c), (c, a)].map(|(from, to)| Side::new(from, to, face))
            })
        };
        // A counting sort by the lower vertex, whose few sides are then sorted where they are.
        let mut starts = vec![0u32; mesh.positions.len()];
        for side in sides() {
            starts[side.low as usize] += 1;
        }
        let mut total = 0;
        for start in &mut starts {
            (*start, total) = (total, total + *start);
        }
        let mut sorted = vec![Side::default(); total as usize];
        for side in sides() {
            let slot = &mut starts[side.low as usize];
            sorted[*slot as usize] = side;
            *slot += 1;
        }
        for sides in sorted.chunk_by_mut(|a, b| a.low == b.low) {
            sides.sort_unstable_by_key(|side| (side.high, side.direction));
        }
        Edges {
            sides: sorted,
            num_faces: mesh.triangles.len(),
        }
    }

    fn edges(&self) -> impl Iterator<Item = &[Side]> {
        self.sides
            .chunk_by(|a, b| (a.low, a.high) == (b.low, b.high))
    }

    /// The vertices of every edge, the lower first, in rising order.
    pub fn ends(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.edges().map(|sides| [sides[0].low, sides[0].high])
    }

    /// Edges with one face only.
    pub fn num_boundary(&self) -> usize {
        self.edges().filter(|sides| sides.len() == 1).count()
    }

    /// Edges with more than two faces.
    pub fn num_non_manifold(&self) -> usize {
        self.edges().filter(|sides| sides.len() > 2).count()
    }

    /// Sets of faces that are joined by edges.
    pub fn num_components(&self) -> usize {
        let labels = self.components();
        labels.iter().max().map_or(0, |&last| last as usize + 1)
    }

    /// For each face the number of its component: those of the faces that are joined by edges, counted from the first face on.
    pub fn components(&self) -> Vec<u32> {
        let mut sets = Sets::new(self.num_faces);
        for sides in self.edges() {
            for pair in sides.windows(2) {
                sets.join(pair[0].face(), pair[1].face());
            }
        }
        let mut labels = vec![0; self.num_faces];
        let mut next = 0;
        for face in 0..self.num_faces as u32 {
            let root = sets.find(face); // the lowest, which so came first
            if root == face {
                labels[face as usize] = next;
                next += 1;
            } else {
                labels[face as usize] = labels[root as usize];
            }
        }
        labels
    }

    /// Which faces to turn over so that neighbours across two-faced edges agree, the majority of each patch keeping its
    /// winding. (The majority rather than the sign of a volume: a piece cut from a model must turn as the whole did.)
    pub fn winding(&self) -> Winding {
        // A face has at most three neighbours: each one's number, doubled, and 1 more where it is wound the other way.
        const NONE: u32 = u32::MAX;
        let mut neighbours = vec![[NONE; 3]; self.num_faces];
        let mut join = |face: u32, neighbour: u32, differ: bool| {
            let mut slots = neighbours[face as usize].iter_mut();
            let free = slots.find(|slot| **slot == NONE);
            free.into_iter()
                .for_each(|slot| *slot = neighbour << 1 | u32::from(differ));
        };
        for sides in self.edges() {
            if let [a, b] = sides {
                let differ = a.is_ascending() == b.is_ascending();
                join(a.face(), b.face(), differ);
                join(b.face(), a.face(), differ);
            }
        }
        let mut flips: Vec<Option<bool>> = vec![None; self.num_faces];
        let mut patches = vec![0; self.num_faces];
        let mut num_patches = 0;
        for seed in 0..self.num_faces {
            if flips[seed].is_some() {
                continue;
            }
            flips[seed] = Some(false);
            let mut patch = vec![seed as u32];
            let mut num_flipped = 0;
            let mut next = 0;
            while next < patch.len() {
                let face = patch[next] as usize;
                next += 1;
                let flipped = flips[face] == Some(true);
                patches[face] = num_patches as u32;
                num_flipped += usize::from(flipped);
                for neighbour in neighbours[face] {
                    if neighbour == NONE {
                        continue;
                    }
                    let flip = &mut flips[(neighbour >> 1) as usize];
                    if flip.is_none() {
                        *flip = Some(flipped ^ (neighbour & 1 == 1));
                        patch.push(neighbour >> 1);
                    }
                }
            }
            if 2 * num_flipped > patch.len() {
                for &face in &patch {
                    let flip = &mut flips[face as usize];
                    *flip = flip.map(|flipped| !flipped);
                }
            }
            num_patches += 1;
        }
        Winding {
            flips: flips.into_iter().map(|flip| flip == Some(true)).collect(),
            patches,
            num_patches,
        }
    }

    /// The edges with one face, in that face's direction; `triangles` are the mesh's, some perhaps turned over.
    pub fn boundary<'a>(
        &'a self,
        triangles: &'a [[u32; 3]],
    ) -> impl Iterator<Item = (u32, u32)> + 'a {
        let alone = self.edges().filter(|sides| sides.len() == 1);
        alone.map(|sides| {
            let (low, high) = (sides[0].low, sides[0].high);
            let [a, b, c] = triangles[sides[0].face() as usize];
            if [(a, b), (b, c), (c, a)].contains(&(low, high)) {
                (low, high)
            } else {
                (high, low)
            }
        })
    }

    /// The edges with two faces.
    pub fn pairs(&self) -> impl Iterator<Item = Pair> + '_ {
        self.edges().filter_map(|sides| match sides {
            [first, second] => Some(Pair {
                ends: [first.low, first.high],
                faces: [first.face(), second.face()],
                agree: first.is_ascending() != second.is_ascending(),
            }),
            _ => None,
        })
    }

    /// The one-rings.
    pub fn rings(&self, num_vertices: usize) -> Rings {
        let mut valences = vec![0u32; num_vertices];
        let mut closed = vec![true; num_vertices];
        for sides in self.edges() {
            for vertex in [sides[0].low as usize, sides[0].high as usize] {
                valences[vertex] += 1;
                closed[vertex] &= sides.len() == 2;
            }
        }
        let mut starts = Vec::with_capacity(num_vertices + 1);
        starts.push(0);
        starts.extend(valences.iter().scan(0, |total, &valence| {
            *total += valence;
            Some(*total)
        }));
        let mut neighbours = vec![0; starts[num_vertices] as usize];
        let mut next = starts.clone();
        for sides in self.edges() {
            let (low, high) = (sides[0].low, sides[0].high);
            for (vertex, neighbour) in [(low, high), (high, low)] {
                let slot = &mut next[vertex as usize];
                neighbours[*slot as usize] = neighbour;
                *slot += 1;
            }
        }
        // Every face at a vertex has two of the vertex's sides, so with two faces an edge there are as many faces as edges.
        let closed = closed
            .iter()
            .zip(&valences)
            .map(|(&closed, &valence)| closed && valence >= 3)
            .collect();
        Rings {
            starts,
            neighbours,
            closed,
        }
    }
}

/// An edge with two faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Its vertices, the lower first.
    pub ends: [u32; 2],
    /// Its faces, the lower first.
    pub faces: [u32; 2],
    /// Whether they are wound alike: each runs along the edge in a direction of its own.
    pub agree: bool,
}

/// How a mesh is wound.
pub struct Winding {
    /// For each face, whether it is to be turned over.
    pub flips: Vec<bool>,
    /// For each face, the number of its patch: faces joined across two-faced edges.
    pub patches: Vec<u32>,
    /// Patches.
    pub num_patches: usize,
}

/// The one-ring of every vertex: its neighbours, each once.
pub struct Rings {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    closed: Vec<bool>,
}

impl Rings {
    /// The neighbours of a vertex, in an order that depends on vertex numbers only.
    pub fn neighbours(&self, vertex: usize) -> &[u32] {
        &self.neighbours[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// Neighbours of a vertex.
    pub fn valence(&self, vertex: usize) -> usize {
        (self.starts[vertex + 1] - self.starts[vertex]) as usize
    }

    /// Whether the vertex has three faces or more and every edge at it has exactly two of them.
    pub fn is_closed(&self, vertex: usize) -> bool {
        self.closed[vertex]
    }

    /// Vertices.
    pub fn len(&self) -> usize {
        self.closed.len()
    }

    /// Whether there is no vertex.
    pub fn is_empty(&self) -> bool {
        self.closed.is_empty()
    }
}
