//! The data structure: positions, triangles, and how they hang together. Accepts what real assets contain: holes, edges
//! with three faces and more, inconsistent winding, many components, isolated vertices.

mod admissible;
mod edges;
mod sets;
pub mod shapes;

pub use admissible::{Admissible, Orbit};
pub use edges::{Edges, Pair, Rings, Winding};
pub(crate) use sets::Sets;

use glam::DVec3;
use std::collections::BTreeMap;

/// A triangle mesh with V vertices and F triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// V positions, finite, in scene units.
    pub positions: Vec<DVec3>,
    /// F triples of distinct vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The same triangles with other positions.
    pub fn with_positions(&self, positions: Vec<DVec3>) -> Mesh {
        Mesh {
            positions,
            triangles: self.triangles.clone(),
        }
    }

    /// Moves every vertex.
    pub fn displace(&mut self, displacement: &[DVec3]) {
        for (position, d) in self.positions.iter_mut().zip(displacement) {
            *position += *d;
        }
    }

    /// Several meshes as one, not welded.
    pub fn joined(parts: impl IntoIterator<Item = Mesh>) -> Mesh {
        let mut whole = Mesh::default();
        for part in parts {
            let first = whole.positions.len() as u32;
            whole.positions.extend(part.positions);
            let triangles = part.triangles.iter();
            whole
                .triangles
                .extend(triangles.map(|triangle| triangle.map(|v| v + first)));
        }
        whole
    }

    /// One vertex for all that have the same position to the bit, without triangles that lose a corner by that. O(V log V).
    pub fn welded(&self) -> Mesh {
        let mut names = BTreeMap::new();
        let mut positions = Vec::new();
        let name_of = |position: &DVec3| {
            // Adding 0 makes one number of the two zeros.
            let bits = (*position + 0.0).to_array().map(f64::to_bits);
            *names.entry(bits).or_insert_with(|| {
                positions.push(*position);
                positions.len() as u32 - 1
            })
        };
        let renamed: Vec<u32> = self.positions.iter().map(name_of).collect();
        let triangles = self
            .triangles
            .iter()
            .map(|triangle| triangle.map(|v| renamed[v as usize]))
            .filter(|&[a, b, c]| a != b && b != c && c != a);
        Mesh {
            triangles: triangles.collect(),
            positions,
        }
    }

    /// Some of the triangles, in the order given, with those of the vertices that they need, in theirs.
    pub fn part(&self, triangles: impl IntoIterator<Item = [u32; 3]>) -> Mesh {
        let triangles: Vec<[u32; 3]> = triangles.into_iter().collect();
        let mut names = vec![None; self.positions.len()];
        let used = triangles.iter().flatten();
        used.for_each(|&vertex| names[vertex as usize] = Some(0));
        let mut positions = Vec::new();
        for (name, position) in names.iter_mut().zip(&self.positions) {
            if let Some(name) = name {
                *name = positions.len() as u32;
                positions.push(*position);
            }
        }
        let renamed = |v: u32| names[v as usize].unwrap_or(0);
        Mesh {
            triangles: triangles.iter().map(|t| t.map(renamed)).collect(),
            positions,
        }
    }

    /// The area of all triangles, in squared scene units.
    pub fn area(&self) -> f64 {
        let double = |&triangle: &[u32; 3]| {
            let [a, b, c] = self.corners(triangle);
            (b - a).cross(c - a).length()
        };
        self.triangles.iter().map(double).sum::<f64>() * 0.5
    }

    /// The mean length of a triangle's side, in scene units; 0 without triangles.
    pub fn mean_edge(&self) -> f64 {
        let perimeter = |&triangle: &[u32; 3]| {
            let [a, b, c] = self.corners(triangle);
            a.distance(b) + b.distance(c) + c.distance(a)
        };
        let perimeters = self.triangles.iter().map(perimeter);
        perimeters.sum::<f64>() / (3 * self.triangles.len()).max(1) as f64
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|vertex| self.positions[vertex as usize])
    }
}
