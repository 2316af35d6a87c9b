//! Subdivision, one round of each scheme. The V vertices of the mesh keep their indices, and the new ones follow: who knows V can
//! trace any vertex. Boundary edges and edges of more than two faces are creases: they are divided at
//! their middles, and all schemes but Loop's keep the vertices on them.

use crate::mesh::Mesh;
use glam::DVec3;
use std::f64::consts::TAU;

/// Every triangle becomes four, the surface stays. V' = V + E, F' = 4 F.
pub fn midpoint(mesh: &Mesh) -> Mesh {
    let polygons = Polygons::new(mesh.positions.len(), &mesh.triangles);
    let mut positions = mesh.positions.clone();
    positions.extend(polygons.edges.iter().map(|edge| edge.middle(mesh)));
    Mesh {
        positions,
        triangles: polygons.quartered(),
    }
}

/// Loop's scheme (Loop 1987), with his limits for boundaries. V' = V + E, F' = 4 F.
pub fn loop_scheme(mesh: &Mesh) -> Mesh {
    let polygons = Polygons::new(mesh.positions.len(), &mesh.triangles);
    let at = |vertex: u32| mesh.positions[vertex as usize];
    let edge_point = |edge: &Edge| match edge.faces[..] {
        [left, right] => {
            let corners = [left, right].map(|face| mesh.triangles[face as usize].map(at));
            let all: DVec3 = corners.iter().flatten().sum();
            // Both faces have both ends: 3/8 of each end, 1/8 of each opposite corner.
            (all + edge.ends.map(at).iter().sum::<DVec3>()) / 8.0
        }
        _ => edge.middle(mesh),
    };
    let vertex_point = |(v, around): (usize, &Around)| {
        let position = mesh.positions[v];
        if around.crease.is_empty() && !around.smooth.is_empty() {
            let valence = around.smooth.len() as f64;
            let cosine = 0.375 + 0.25 * libm::cos(TAU / valence);
            let pull = 0.625 - cosine * cosine;
            let mean = around.smooth.iter().map(|&n| at(n)).sum::<DVec3>() / valence;
            position.lerp(mean, pull)
        } else if let [a, b] = around.crease[..] {
            0.75 * position + 0.125 * (at(a) + at(b))
        } else {
            position
        }
    };
    let around = polygons.around();
    let mut positions: Vec<DVec3> = around.iter().enumerate().map(vertex_point).collect();
    positions.extend(polygons.edges.iter().map(edge_point));
    Mesh {
        positions,
        triangles: polygons.quartered(),
    }
}

/// The square root of 3 scheme (Kobbelt 2000): a vertex in the middle of every triangle, every edge between two of them
/// turned. V' = V + F, F' = 3 F.
pub fn sqrt3(mesh: &Mesh) -> Mesh {
    let polygons = Polygons::new(mesh.positions.len(), &mesh.triangles);
    let at = |vertex: u32| mesh.positions[vertex as usize];
    let first = mesh.positions.len() as u32;
    let vertex_point = |(v, around): (usize, &Around)| {
        if !around.crease.is_empty() || around.smooth.is_empty() {
            return mesh.positions[v];
        }
        let valence = around.smooth.len() as f64;
        let pull = (4.0 - 2.0 * libm::cos(TAU / valence)) / 9.0;
        let mean = around.smooth.iter().map(|&n| at(n)).sum::<DVec3>() / valence;
        mesh.positions[v].lerp(mean, pull)
    };
    let around = polygons.around();
    let mut positions: Vec<DVec3> = around.iter().enumerate().map(vertex_point).collect();
    positions.extend(
        mesh.triangles
            .iter()
            .map(|&t| mesh.corners(t).iter().sum::<DVec3>() / 3.0),
    );
    let mut triangles = Vec::with_capacity(3 * mesh.triangles.len());
    for (face, corners) in (0u32..).zip(&mesh.triangles) {
        for (corner, &edge) in polygons.edges_of[face as usize].iter().enumerate() {
            let (from, to) = (corners[corner], corners[(corner + 1) % 3]);
            triangles.push(match polygons.edges[edge as usize].faces[..] {
                [a, b] => [from, first + if a == face { b } else { a }, first + face],
                _ => [from, to, first + face],
            });
        }
    }
    Mesh {
        positions,
        triangles,
    }
}

/// Catmull and Clark's scheme (1978), `rounds` times, and its quads split into triangles: what a modelling program's
/// "MeshSmooth" or "subdivision surface" makes of a triangle mesh. V' = V + E + F in each round: the vertices, then a vertex for
/// every edge, then one for every face.
pub fn catmull_clark(mesh: &Mesh, rounds: u32) -> Mesh {
    if rounds == 0 {
        return mesh.clone();
    }
    let (mut positions, mut quads) = catmull_clark_round(&mesh.positions, &mesh.triangles);
    for _ in 1..rounds {
        (positions, quads) = catmull_clark_round(&positions, &quads);
    }
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Mesh {
        positions,
        triangles: triangles.collect(),
    }
}

fn catmull_clark_round<const N: usize>(
    positions: &[DVec3],
    faces: &[[u32; N]],
) -> (Vec<DVec3>, Vec<[u32; 4]>) {
    let polygons = Polygons::new(positions.len(), faces);
    let at = |vertex: u32| positions[vertex as usize];
    let face_points: Vec<DVec3> = faces
        .iter()
        .map(|face| face.iter().map(|&v| at(v)).sum::<DVec3>() / N as f64)
        .collect();
    let edge_point = |edge: &Edge| {
        let ends: DVec3 = edge.ends.map(at).iter().sum();
        match edge.faces[..] {
            [a, b] => (ends + face_points[a as usize] + face_points[b as usize]) / 4.0,
            _ => ends / 2.0,
        }
    };
    let mut face_sums = vec![DVec3::ZERO; positions.len()];
    for (face, point) in faces.iter().zip(&face_points) {
        face.iter().for_each(|&v| face_sums[v as usize] += point);
    }
    let vertex_point = |(v, around): (usize, &Around)| {
        let position = positions[v];
        if !around.crease.is_empty() || around.smooth.is_empty() {
            return position;
        }
        let valence = around.smooth.len() as f64;
        let middles = around
            .smooth
            .iter()
            .map(|&n| position.midpoint(at(n)))
            .sum::<DVec3>();
        (face_sums[v] + 2.0 * middles) / (valence * valence) + position * (valence - 3.0) / valence
    };
    let around = polygons.around();
    let mut moved: Vec<DVec3> = around.iter().enumerate().map(vertex_point).collect();
    let first_edge = positions.len() as u32;
    let first_face = first_edge + polygons.edges.len() as u32;
    moved.extend(polygons.edges.iter().map(edge_point));
    moved.extend(&face_points);
    let mut quads = Vec::with_capacity(N * faces.len());
    for ((name, face), edges) in (first_face..).zip(faces).zip(&polygons.edges_of) {
        for corner in 0..N {
            let before = edges[(corner + N - 1) % N];
            quads.push([
                face[corner],
                first_edge + edges[corner],
                name,
                first_edge + before,
            ]);
        }
    }
    (moved, quads)
}

/// Faces of N corners, and the edges between them.
struct Polygons<'a, const N: usize> {
    num_vertices: usize,
    faces: &'a [[u32; N]],
    edges: Vec<Edge>,
    /// For each face the edge that begins at each of its corners.
    edges_of: Vec<[u32; N]>,
}

struct Edge {
    ends: [u32; 2],
    faces: Vec<u32>,
}

/// A vertex's neighbours, by whether the edge to them has two faces.
#[derive(Clone, Default)]
struct Around {
    smooth: Vec<u32>,
    crease: Vec<u32>,
}

impl<'a, const N: usize> Polygons<'a, N> {
    fn new(num_vertices: usize, faces: &'a [[u32; N]]) -> Self {
        let mut sides: Vec<([u32; 2], u32, usize)> = Vec::with_capacity(N * faces.len());
        for (name, face) in (0..).zip(faces) {
            sides.extend((0..N).map(|corner| {
                let (a, b) = (face[corner], face[(corner + 1) % N]);
                ([a.min(b), a.max(b)], name, corner)
            }));
        }
        sides.sort_unstable();
        let mut edges = Vec::new();
        let mut edges_of = vec![[0; N]; faces.len()];
        for (name, sides) in (0..).zip(sides.chunk_by(|a, b| a.0 == b.0)) {
            for &(_, face, corner) in sides {
                edges_of[face as usize][corner] = name;
            }
            edges.push(Edge {
                ends: sides[0].0,
                faces: sides.iter().map(|side| side.1).collect(),
            });
        }
        Polygons {
            num_vertices,
            faces,
            edges,
            edges_of,
        }
    }

    fn around(&self) -> Vec<Around> {
        let mut around = vec![Around::default(); self.num_vertices];
        for edge in &self.edges {
            let [a, b] = edge.ends;
            for (vertex, neighbour) in [(a, b), (b, a)] {
                let around = &mut around[vertex as usize];
                if edge.faces.len() == 2 {
                    around.smooth.push(neighbour);
                } else {
                    around.crease.push(neighbour);
                }
            }
        }
        around
    }
}

impl Polygons<'_, 3> {
    /// Every triangle in four, an edge's own vertex named after all those that were there.
    fn quartered(&self) -> Vec<[u32; 3]> {
        let faces = self.faces.iter().zip(&self.edges_of);
        faces
            .flat_map(|(&[a, b, c], edges)| {
                let [ab, bc, ca] = edges.map(|edge| self.num_vertices as u32 + edge);
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect()
    }
}

impl Edge {
    fn middle(&self, mesh: &Mesh) -> DVec3 {
        let [a, b] = self.ends.map(|vertex| mesh.positions[vertex as usize]);
        a.midpoint(b)
    }
}
