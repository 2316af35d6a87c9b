//! Extraction of the surface again, from samples of its signed distance.

use crate::geometry::{Nearest, Surface, diagonal, outward};
use crate::mesh::Mesh;
use glam::DVec3;
use std::collections::BTreeMap;

/// The six tetrahedra of a cube that lie about its diagonal from corner 0 to corner 7, of equal division on opposite faces
/// (Kuhn 1960). Bit 0 of a corner is its x, bit 1 its y, bit 2 its z.
const TETRAHEDRA: [[usize; 4]; 6] = [
    [0, 1, 3, 7],
    [0, 1, 5, 7],
    [0, 2, 3, 7],
    [0, 2, 6, 7],
    [0, 4, 5, 7],
    [0, 4, 6, 7],
];
/// How near a vertex may come to a sample, as a fraction of their edge: nearer ones would make faces without area.
const NEAREST: f64 = 1e-3;
/// What rounding may add to distances.
const ROUNDING: f64 = 1e-9;
/// Cells on the side of the blocks of samples about a piece of a triangle; larger triangles are taken in pieces.
const LARGEST_BLOCK: usize = 8;
/// No sample.
const NONE: u32 = u32::MAX;

/// A surface made anew from its signed distance on a grid of cells of `cell` times the bounding box's diagonal, by marching
/// tetrahedra (Doi and Koide 1991): as marching cubes, with an unambiguous result. The sign is that of the nearest point's
/// angle-weighted normal (Baerentzen and Aanaes 2005), right on closed surfaces. Borders end within a cell of where they were;
/// walls that are thinner than a cell are lost in part. Re-extraction removes most marks (FuncEvade, in the evaluation of
/// FuncMark).
pub fn resample(mesh: &Mesh, cell: f64) -> Mesh {
    let size = cell * diagonal(&mesh.positions);
    if mesh.triangles.is_empty() || size <= 0.0 {
        return Mesh::default();
    }
    let mesh = Mesh {
        positions: mesh.positions.clone(),
        triangles: outward(mesh),
    };
    let mut grid = Grid::around(&mesh, size);
    let (samples, distances) = grid.sample(&mesh);
    let mut vertices = Vertices {
        grid: &grid,
        names: Default::default(),
        positions: Vec::new(),
    };
    let mut triangles = Vec::new();
    for &point in &samples {
        let corners: [usize; 8] = std::array::from_fn(|corner| point + grid.offset(corner));
        if corners
            .iter()
            .any(|&c| c >= grid.index.len() || grid.index[c] == NONE)
        {
            continue;
        }
        let value = |corner: usize| distances[grid.index[corners[corner]] as usize];
        for tetrahedron in TETRAHEDRA {
            march(
                tetrahedron.map(|corner| (corners[corner], value(corner))),
                &mut vertices,
                &mut triangles,
            );
        }
    }
    Mesh {
        positions: vertices.positions,
        triangles,
    }
}

/// The triangles of one tetrahedron, wound so that they face the samples outside.
fn march(corners: [(usize, f64); 4], vertices: &mut Vertices, triangles: &mut Vec<[u32; 3]>) {
    let inside: Vec<_> = corners.iter().filter(|c| c.1 < 0.0).copied().collect();
    let outside: Vec<_> = corners.iter().filter(|c| c.1 >= 0.0).copied().collect();
    let mut crossings = Vec::with_capacity(4);
    for &a in &inside {
        for &b in &outside {
            // Across a surface both distances fit into the edge; where they do not, the nearest surface has changed.
            let length = vertices.grid.place(a.0).distance(vertices.grid.place(b.0));
            if b.1 - a.1 > length * (1.0 + ROUNDING) {
                return;
            }
            crossings.push((a, b));
        }
    }
    // Four crossings, of two corners with two, go around as 0, 1, 3, 2.
    let faces: &[[usize; 3]] = match crossings.len() {
        3 => &[[0, 1, 2]],
        4 => &[[0, 1, 3], [0, 3, 2]],
        _ => return,
    };
    let middle = |name: usize| {
        let (a, b) = crossings[name];
        vertices.grid.place(a.0).midpoint(vertices.grid.place(b.0))
    };
    let outwards = vertices.grid.place(outside[0].0) - vertices.grid.place(inside[0].0);
    let [a, b, c] = faces[0].map(middle);
    let is_outward = (b - a).cross(c - a).dot(outwards) > 0.0;
    for &[a, b, c] in faces {
        let face = if is_outward { [a, b, c] } else { [a, c, b] };
        triangles.push(face.map(|name| vertices.name(crossings[name].0, crossings[name].1)));
    }
}

/// The vertices on the edges of the grid, each once.
struct Vertices<'a> {
    grid: &'a Grid,
    names: BTreeMap<(usize, usize), u32>,
    positions: Vec<DVec3>,
}

impl Vertices<'_> {
    fn name(&mut self, inside: (usize, f64), outside: (usize, f64)) -> u32 {
        let (grid, positions) = (self.grid, &mut self.positions);
        *self.names.entry((inside.0, outside.0)).or_insert_with(|| {
            let fraction = inside.1 / (inside.1 - outside.1);
            let fraction = fraction.clamp(NEAREST, 1.0 - NEAREST);
            positions.push(grid.place(inside.0).lerp(grid.place(outside.0), fraction));
            positions.len() as u32 - 1
        })
    }
}

/// Samples at the points of a cubic grid, x fastest, those near the surface.
struct Grid {
    origin: DVec3,
    size: f64,
    counts: [usize; 3],
    /// For each point the number of its sample, or [`NONE`].
    index: Vec<u32>,
}

impl Grid {
    fn around(mesh: &Mesh, size: f64) -> Grid {
        let bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = mesh
            .positions
            .iter()
            .fold(bounds, |(low, high), p| (low.min(*p), high.max(*p)));
        let counts = ((high - low) / size)
            .to_array()
            .map(|cells| cells.ceil() as usize + 5);
        let total = counts.iter().product();
        Grid {
            origin: low - 2.0 * size,
            size,
            counts,
            index: vec![NONE; total],
        }
    }

    fn name(&self, [x, y, z]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.counts;
        x + nx * (y + ny * z)
    }

    /// How much later a cube's corner comes than its first.
    fn offset(&self, corner: usize) -> usize {
        self.name([corner & 1, corner >> 1 & 1, corner >> 2])
    }

    fn place(&self, name: usize) -> DVec3 {
        let [nx, ny, _] = self.counts;
        let point = [name % nx, name / nx % ny, name / nx / ny].map(|n| n as f64);
        self.origin + DVec3::from(point) * self.size
    }

    /// The points within a cell or two of a triangle, in order, and their signed distances.
    fn sample(&mut self, mesh: &Mesh) -> (Vec<usize>, Vec<f64>) {
        let mut points = Vec::new();
        for &triangle in &mesh.triangles {
            let mut open = vec![mesh.corners(triangle)];
            while let Some([a, b, c]) = open.pop() {
                // The origin is two cells outside, so a cell about the piece is in the grid.
                let cells = |p: DVec3| ((p - self.origin) / self.size).to_array();
                let low = cells(a.min(b).min(c)).map(|n| n.floor() as usize - 1);
                let high = cells(a.max(b).max(c)).map(|n| n.ceil() as usize + 1);
                if (0..3).any(|axis| high[axis] - low[axis] > LARGEST_BLOCK) {
                    let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
                    open.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
                    continue;
                }
                for z in low[2]..=high[2] {
                    for y in low[1]..=high[1] {
                        for x in low[0]..=high[0] {
                            let name = self.name([x, y, z]);
                            if self.index[name] == NONE {
                                self.index[name] = 0;
                                points.push(name);
                            }
                        }
                    }
                }
            }
        }
        points.sort_unstable();
        let surface = Surface::new(mesh);
        let normals = Normals::new(mesh);
        let signed = |&point: &usize| {
            let from = self.place(point);
            let nearest = surface.nearest(from).expect("there are triangles");
            let side = (from - nearest.point).dot(normals.at(&nearest));
            nearest.distance.copysign(side)
        };
        let distances = points.iter().map(signed).collect();
        (0..)
            .zip(&points)
            .for_each(|(number, &point)| self.index[point] = number);
        (points, distances)
    }
}

/// Normals whose side tells inside from outside, wherever the nearest point is.
struct Normals<'a> {
    mesh: &'a Mesh,
    /// Of each face, of length 1.
    faces: Vec<DVec3>,
    /// Of each vertex: its faces', weighted by their angles.
    vertices: Vec<DVec3>,
    /// Of each edge: its faces'. By the edge's ends, in rising order.
    edges: BTreeMap<[u32; 2], DVec3>,
}

impl Normals<'_> {
    fn new(mesh: &Mesh) -> Normals<'_> {
        let mut normals = Normals {
            mesh,
            faces: Vec::with_capacity(mesh.triangles.len()),
            vertices: vec![DVec3::ZERO; mesh.positions.len()],
            edges: BTreeMap::new(),
        };
        for &triangle in &mesh.triangles {
            let corners = mesh.corners(triangle);
            let normal = (corners[1] - corners[0])
                .cross(corners[2] - corners[0])
                .normalize_or_zero();
            normals.faces.push(normal);
            for i in 0..3 {
                let (to_next, to_last) = (
                    corners[(i + 1) % 3] - corners[i],
                    corners[(i + 2) % 3] - corners[i],
                );
                let angle = libm::atan2(to_next.cross(to_last).length(), to_next.dot(to_last));
                normals.vertices[triangle[i] as usize] += normal * angle;
                *normals
                    .edges
                    .entry(edge(triangle, (i + 2) % 3))
                    .or_default() += normal;
            }
        }
        normals
    }

    fn at(&self, nearest: &Nearest) -> DVec3 {
        let triangle = self.mesh.triangles[nearest.triangle as usize];
        let weights = nearest.weights;
        if let Some(corner) = weights.iter().position(|&w| w == 1.0) {
            self.vertices[triangle[corner] as usize]
        } else if let Some(opposite) = weights.iter().position(|&w| w == 0.0) {
            self.edges[&edge(triangle, opposite)]
        } else {
            self.faces[nearest.triangle as usize]
        }
    }
}

/// The ends of a triangle's edge, that opposite a corner, in rising order.
fn edge(triangle: [u32; 3], opposite: usize) -> [u32; 2] {
    let (a, b) = (triangle[(opposite + 1) % 3], triangle[(opposite + 2) % 3]);
    [a.min(b), a.max(b)]
}
