//! How far each vertex of a mesh may move, whatever moves it: by the part of the surface that it is in, and by its triangles.

use super::Parts;
use super::facet::{Facet, twice_area};
use crate::mesh::{Admissible, Mesh};
use glam::DVec3;
use std::borrow::Cow;

/// What nobody is to see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// How far a vertex may go, as a fraction of its part's diagonal: two vertices of a part leave each other by twice as much.
    pub part: f64,
    /// How far a triangle may turn that is no sliver, in degrees.
    pub turn: f64,
    /// How far any vertex may go, in scene units.
    pub most: f64,
}

impl Bounds {
    /// Of a movement that is to stay hidden.
    pub const HIDDEN: Bounds = Bounds {
        part: 0.005,
        turn: 10.0,
        most: f64::INFINITY,
    };
    /// Of a movement that may be seen by who looks for it.
    pub const STRONG: Bounds = Bounds {
        part: 0.01,
        turn: 20.0,
        most: f64::INFINITY,
    };

    /// So many times as wide.
    pub fn times(self, times: f64) -> Bounds {
        Bounds {
            part: self.part * times,
            turn: self.turn * times,
            ..self
        }
    }
}

/// How far a sliver may turn, in degrees: not over.
const SLIVER_TURN: f64 = 80.0;

/// What is left of a bound for rounding to a file's numbers.
const MARGIN: f64 = 0.97;

/// Movements that turn a triangle too far are made shorter by this, so often, before they are given up.
const SHORTER: f64 = 0.75;
const TIMES: usize = 12;

/// How far the V vertices of a mesh may move.
#[derive(Clone)]
pub struct Leeway<'a> {
    mesh: Cow<'a, Mesh>,
    reaches: Vec<f64>,
    facets: Vec<Facet>,
    bounds: Bounds,
}

impl<'a> Leeway<'a> {
    /// Looks at a mesh and its parts. O(V + F).
    pub fn new(mesh: &'a Mesh, parts: &Parts, bounds: Bounds) -> Leeway<'a> {
        let mut reaches = vec![bounds.most; mesh.positions.len()];
        for (triangle, &part) in mesh.triangles.iter().zip(&parts.of_triangles) {
            for &vertex in triangle {
                let reach = &mut reaches[vertex as usize];
                *reach = reach.min(bounds.part * parts.diagonals[part as usize]);
            }
        }
        let facet = |(&triangle, &part): (&[u32; 3], &u32)| {
            Facet::of(mesh.corners(triangle), parts.diagonals[part as usize])
        };
        Leeway {
            mesh: Cow::Borrowed(mesh),
            reaches,
            facets: (mesh.triangles.iter().zip(&parts.of_triangles))
                .map(facet)
                .collect(),
            bounds,
        }
    }

    /// The same for some of the vertices, and the mesh that they make.
    pub fn of<'b>(&self, mesh: &'b Mesh, vertices: &[u32]) -> Leeway<'b> {
        let reach = |&vertex: &u32| self.reaches[vertex as usize];
        Leeway {
            reaches: vertices.iter().map(reach).collect(),
            ..Leeway::new(mesh, &Parts::new(mesh), self.bounds)
        }
    }

    /// The same, which needs nobody else's memory.
    pub fn into_owned(self) -> Leeway<'static> {
        Leeway {
            mesh: Cow::Owned(self.mesh.into_owned()),
            ..self
        }
    }

    /// How far each vertex may go from where it is in the mesh, in scene units.
    pub fn reaches(&self) -> &[f64] {
        &self.reaches
    }

    /// Makes displacements of vertices, which are elsewhere already, shorter where they would go too far or turn a triangle too far, and
    /// keeps them admissible.
    pub fn keep(&self, before: &[DVec3], displacement: &mut [DVec3], admissible: &Admissible) {
        let places = self.mesh.positions.iter().zip(before).zip(&*displacement);
        let mut shares: Vec<f64> = places
            .zip(&self.reaches)
            .map(|(((home, before), d), reach)| share_within(*before - *home, *d, MARGIN * reach))
            .collect();
        let turns = self.least_cosines(MARGIN);
        let mut is_new = vec![true; shares.len()];
        for time in 0.. {
            agree(&mut shares, admissible, &mut is_new);
            let moved = |vertex: u32| {
                let vertex = vertex as usize;
                before[vertex] + displacement[vertex] * shares[vertex]
            };
            let turned = self.turned(moved, &turns, |vertex| is_new[vertex as usize]);
            is_new.fill(false);
            for vertex in turned.into_iter().map(|vertex| vertex as usize) {
                if shares[vertex] > 0.0 && !is_new[vertex] {
                    shares[vertex] *= if time < TIMES { SHORTER } else { 0.0 };
                    is_new[vertex] = true;
                }
            }
            if !is_new.contains(&true) {
                break;
            }
        }
        displacement
            .iter_mut()
            .zip(shares)
            .for_each(|(d, share)| *d *= share);
    }

    /// The vertices that went too far, or whose triangles turned too far, by rounding.
    pub fn beyond(&self, after: &[DVec3]) -> Vec<u32> {
        let turns = self.least_cosines(1.0);
        let mut beyond = self.turned(|vertex| after[vertex as usize], &turns, |_| true);
        let places = self.mesh.positions.iter().zip(after).zip(&self.reaches);
        let is_far = |((a, b), reach): ((&DVec3, &DVec3), &f64)| a.distance(*b) > *reach;
        let far = places.map(is_far).zip(0..).filter(|(is_far, _)| *is_far);
        beyond.extend(far.map(|(_, vertex)| vertex));
        beyond.retain(|&v| after[v as usize] != self.mesh.positions[v as usize]);
        beyond.sort_unstable();
        beyond.dedup();
        beyond
    }

    /// The cosines of the largest turns: of plain triangles, and of slivers.
    fn least_cosines(&self, margin: f64) -> [f64; 2] {
        let turns = [self.bounds.turn.min(SLIVER_TURN), SLIVER_TURN];
        turns.map(|turn| libm::cos((margin * turn).to_radians()))
    }

    /// The corners of the triangles that are turned too far, of those with a corner that is asked for.
    fn turned(
        &self,
        moved: impl Fn(u32) -> DVec3,
        least_cosines: &[f64; 2],
        is_asked: impl Fn(u32) -> bool,
    ) -> Vec<u32> {
        let mut turned = Vec::new();
        for (&triangle, facet) in self.mesh.triangles.iter().zip(&self.facets) {
            let least = match facet {
                Facet::Plain => least_cosines[0],
                Facet::Sliver => least_cosines[1],
                Facet::Flat => continue,
            };
            if !triangle.iter().any(|&vertex| is_asked(vertex)) {
                continue;
            }
            let before = twice_area(self.mesh.corners(triangle));
            let after = twice_area(triangle.map(&moved));
            let cosine = before.dot(after);
            if cosine <= 0.0
                || cosine * cosine
                    < least * least * before.length_squared() * after.length_squared()
            {
                turned.extend(triangle);
            }
        }
        turned
    }
}

/// The largest share, up to 1, of a displacement that leaves what is at `from` within a distance of the origin, where it is now.
fn share_within(from: DVec3, displacement: DVec3, reach: f64) -> f64 {
    let square = displacement.length_squared();
    if (from + displacement).length_squared() <= reach * reach || square == 0.0 {
        return 1.0;
    }
    let along = from.dot(displacement);
    let left = (reach * reach - from.length_squared()).max(0.0);
    (((along * along + square * left).sqrt() - along) / square).clamp(0.0, 1.0)
}

/// Gives all members of an orbit the least of their shares, and says whose is new.
fn agree(shares: &mut [f64], admissible: &Admissible, is_new: &mut [bool]) {
    for orbit in &admissible.orbits {
        let members = || orbit.members.iter().map(|&(vertex, _)| vertex as usize);
        let least = members().map(|vertex| shares[vertex]).fold(1.0, f64::min);
        for vertex in members() {
            is_new[vertex] |= shares[vertex] != least;
            shares[vertex] = least;
        }
    }
}
