//! A mesh under operations on its edges: what simplification and re-meshing have in common.

use crate::mesh::Mesh;
use glam::DVec3;
use std::collections::BTreeMap;

/// How far a face may turn when a vertex of it moves: the cosine of the largest angle.
const LARGEST_TURN: f64 = 0.2;
/// Twice a face's area over its longest side's square: what is below this is no face.
const THINNEST: f64 = 1e-4;
/// A vertex with more faces stays where it is, for every change at it goes through all of them: a fan of 20 000 triangles took six
/// minutes to simplify. What people make has poles of some hundreds.
const MANY_FACES: usize = 1024;

/// Vertices that know their faces. Accepts any mesh; what cannot be edited without making an edge of more than two faces
/// stays as it is.
pub(super) struct Editable {
    pub positions: Vec<DVec3>,
    faces: Vec<Option<[u32; 3]>>,
    /// Of vertices with many faces, those that are gone too.
    faces_at: Vec<Vec<u32>>,
    /// How many are gone in such a list.
    gone: BTreeMap<u32, usize>,
    num_faces: usize,
}

impl Editable {
    pub fn new(mesh: &Mesh) -> Editable {
        let mut num_faces_at = vec![0; mesh.positions.len()];
        let corners = mesh.triangles.iter().flatten();
        corners.for_each(|&v| num_faces_at[v as usize] += 1);
        let mut faces_at: Vec<Vec<u32>> =
            num_faces_at.into_iter().map(Vec::with_capacity).collect();
        for (name, &face) in (0..).zip(&mesh.triangles) {
            face.iter().for_each(|&v| faces_at[v as usize].push(name));
        }
        Editable {
            positions: mesh.positions.clone(),
            faces: mesh.triangles.iter().copied().map(Some).collect(),
            faces_at,
            gone: BTreeMap::new(),
            num_faces: mesh.triangles.len(),
        }
    }

    /// The mesh, without vertices that have no face.
    pub fn mesh(&self) -> Mesh {
        let mut names = vec![0; self.positions.len()];
        let mut positions = Vec::new();
        for (v, position) in self.positions.iter().enumerate() {
            names[v] = positions.len() as u32;
            if self.faces_at(v as u32).next().is_some() {
                positions.push(*position);
            }
        }
        let faces = self.faces.iter().flatten();
        Mesh {
            positions,
            triangles: faces.map(|face| face.map(|v| names[v as usize])).collect(),
        }
    }

    pub fn num_faces(&self) -> usize {
        self.num_faces
    }

    pub fn at(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize]
    }

    pub fn length(&self, a: u32, b: u32) -> f64 {
        self.at(a).distance(self.at(b))
    }

    /// Whether none of an edge's ends has too many faces for the edge to collapse.
    pub fn is_small(&self, ends: [u32; 2]) -> bool {
        ends.iter()
            .all(|&v| self.faces_at[v as usize].len() <= MANY_FACES)
    }

    /// The corners of the faces at a vertex.
    pub fn faces_at(&self, vertex: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.faces_at[vertex as usize]
            .iter()
            .filter_map(|&face| self.faces[face as usize])
    }

    /// Twice the area, along the normal.
    pub fn normal(&self, face: [u32; 3]) -> DVec3 {
        cross(face.map(|v| self.at(v)))
    }

    /// The neighbours of a vertex, in rising order.
    pub fn neighbours(&self, vertex: u32) -> Vec<u32> {
        let mut neighbours: Vec<u32> = self.faces_at(vertex).flatten().collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        neighbours.retain(|&n| n != vertex);
        neighbours
    }

    /// The third corners of an edge's faces.
    pub fn apexes(&self, a: u32, b: u32) -> impl Iterator<Item = u32> + '_ {
        let faces = self.faces_at(a).filter(move |face| face.contains(&b));
        faces.map(move |face| third(face, a, b))
    }

    /// Whether two vertices are an edge's. Looks at the one with fewer faces.
    pub fn is_edge(&self, a: u32, b: u32) -> bool {
        self.apexes_in_any_order(a, b).next().is_some()
    }

    /// Whether an edge has another number of faces than two.
    pub fn is_border_edge(&self, a: u32, b: u32) -> bool {
        self.apexes_in_any_order(a, b).take(3).count() != 2
    }

    /// As [`apexes`](Self::apexes), by the end with fewer faces.
    fn apexes_in_any_order(&self, a: u32, b: u32) -> impl Iterator<Item = u32> + '_ {
        let num_faces = |v: u32| self.faces_at[v as usize].len();
        if num_faces(b) < num_faces(a) {
            self.apexes(b, a)
        } else {
            self.apexes(a, b)
        }
    }

    /// The third corners of the faces of an edge that has just two.
    pub fn opposite(&self, a: u32, b: u32) -> Option<[u32; 2]> {
        let mut apexes = self.apexes(a, b);
        match (apexes.next(), apexes.next(), apexes.next()) {
            (Some(first), Some(second), None) => Some([first, second]),
            _ => None,
        }
    }

    /// Every edge once, in rising order.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let faces = self.faces.iter().flatten();
        let mut edges: Vec<[u32; 2]> = faces
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Whether an edge at the vertex has another number of faces than two.
    pub fn is_border(&self, vertex: u32) -> bool {
        let mut neighbours: Vec<u32> = self.faces_at(vertex).flatten().collect();
        neighbours.sort_unstable();
        neighbours
            .chunk_by(|a, b| a == b)
            .any(|same| same[0] != vertex && same.len() != 2)
    }

    /// Whether an edge has another number of faces than two, or two whose normals' angle has a cosine below this.
    pub fn is_crease(&self, a: u32, b: u32, cosine: f64) -> bool {
        let mut faces = self.faces_at(a).filter(|face| face.contains(&b));
        let (Some(first), Some(second), None) = (faces.next(), faces.next(), faces.next()) else {
            return true;
        };
        let (first, second) = (self.normal(first), self.normal(second));
        first.dot(second) < cosine * first.length() * second.length()
    }

    /// Makes one vertex of an edge's two, `kept` at the position `to`, if the surface stays what it is: the link condition
    /// (Dey, Edelsbrunner, Guha and Nekhayev 1999), no face turned over or gone thin, no component gone. Says whether it did.
    pub fn collapse(&mut self, kept: u32, lost: u32, to: DVec3) -> bool {
        if !self.is_small([kept, lost]) {
            return false;
        }
        let apexes: Vec<u32> = self.apexes(kept, lost).collect();
        if !self.keeps_its_kind(kept, lost, &apexes) || !self.keeps_its_faces(kept, lost, to) {
            return false;
        }
        self.positions[kept as usize] = to;
        for face in std::mem::take(&mut self.faces_at[lost as usize]) {
            let Some(corners) = self.faces[face as usize] else {
                continue;
            };
            if corners.contains(&kept) {
                self.remove(face, corners);
            } else {
                self.faces[face as usize] = Some(corners.map(|v| if v == lost { kept } else { v }));
                self.faces_at[kept as usize].push(face);
            }
        }
        true
    }

    fn keeps_its_kind(&self, a: u32, b: u32, apexes: &[u32]) -> bool {
        let others = self.neighbours(b);
        let mut common = self.neighbours(a);
        common.retain(|v| others.binary_search(v).is_ok());
        match *apexes {
            [_] => common.len() == 1 && self.faces_at(a).count() + self.faces_at(b).count() > 2,
            [c, d] => {
                let is_joined = |end: u32| self.apexes_in_any_order(c, d).any(|v| v == end);
                common.len() == 2
                    && !(is_joined(a) && is_joined(b))
                    && !(self.is_border(a) && self.is_border(b))
            }
            _ => false,
        }
    }

    fn keeps_its_faces(&self, a: u32, b: u32, to: DVec3) -> bool {
        [(a, b), (b, a)].into_iter().all(|(moved, other)| {
            let mut faces = self.faces_at(moved).filter(|face| !face.contains(&other));
            faces.all(|face| {
                let before = face.map(|v| self.at(v));
                let after = face.map(|v| if v == moved { to } else { self.at(v) });
                is_kept(cross(before), after)
            })
        })
    }

    /// Divides an edge, and its faces, at its middle. Gives the new vertex.
    pub fn split(&mut self, a: u32, b: u32) -> u32 {
        let middle = self.positions.len() as u32;
        self.positions.push(self.at(a).midpoint(self.at(b)));
        self.faces_at.push(Vec::new());
        let faces = self.faces_at[a as usize].clone();
        for face in faces {
            let Some(corners) = self.faces[face as usize].filter(|face| face.contains(&b)) else {
                continue;
            };
            self.remove(face, corners);
            self.add(corners.map(|v| if v == a { middle } else { v }));
            self.add(corners.map(|v| if v == b { middle } else { v }));
        }
        middle
    }

    /// Turns an edge of two faces into the other diagonal of their quad, if that is no edge yet and no face turns over.
    /// Says whether it did.
    pub fn flip(&mut self, a: u32, b: u32) -> bool {
        let faces: Vec<(u32, [u32; 3])> = self.faces_at[a as usize]
            .iter()
            .filter_map(|&face| Some((face, self.faces[face as usize]?)))
            .filter(|(_, corners)| corners.contains(&b))
            .collect();
        let [first, second] = faces[..] else {
            return false;
        };
        let (c, d) = (third(first.1, a, b), third(second.1, a, b));
        let normal =
            self.normal(first.1).normalize_or_zero() + self.normal(second.1).normalize_or_zero();
        // Each face's own third corner stays, and one end of the edge is replaced by the other face's.
        let turned = [
            first.1.map(|v| if v == b { d } else { v }),
            second.1.map(|v| if v == a { c } else { v }),
        ];
        let is_edge = c == d || self.is_edge(c, d);
        if is_edge
            || !turned
                .iter()
                .all(|face| is_kept(normal, face.map(|v| self.at(v))))
        {
            return false;
        }
        self.remove(first.0, first.1);
        self.remove(second.0, second.1);
        turned.into_iter().for_each(|face| self.add(face));
        true
    }

    fn remove(&mut self, name: u32, corners: [u32; 3]) {
        self.faces[name as usize] = None;
        self.num_faces -= 1;
        for vertex in corners {
            let list = &mut self.faces_at[vertex as usize];
            if list.len() <= MANY_FACES {
                list.retain(|&face| face != name);
                continue;
            }
            // Half of a long list is gone before it is gone through.
            let gone = self.gone.entry(vertex).or_default();
            *gone += 1;
            if 2 * *gone > list.len() {
                list.retain(|&face| self.faces[face as usize].is_some());
                self.gone.remove(&vertex);
            }
        }
    }

    fn add(&mut self, corners: [u32; 3]) {
        let name = self.faces.len() as u32;
        self.faces.push(Some(corners));
        self.num_faces += 1;
        for vertex in corners {
            self.faces_at[vertex as usize].push(name);
        }
    }
}

fn cross([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

fn third(face: [u32; 3], a: u32, b: u32) -> u32 {
    // The two that are known cancel.
    face[0] ^ face[1] ^ face[2] ^ a ^ b
}

/// Whether a face is one, and has not turned away from the normal that it had.
fn is_kept(before: DVec3, after: [DVec3; 3]) -> bool {
    let [a, b, c] = after;
    let normal = cross(after);
    let longest = a
        .distance_squared(b)
        .max(b.distance_squared(c))
        .max(c.distance_squared(a));
    normal.length() > THINNEST * longest
        && before.dot(normal) >= LARGEST_TURN * before.length() * normal.length()
}
