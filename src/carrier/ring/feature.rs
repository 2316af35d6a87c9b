//! The feature of a ring: what the quantizer modulates.

use crate::mesh::{Edges, Mesh, Rings};
use glam::DVec3;

/// The mesh with consistent winding, and its rings: what does not change while vertices move a little.
pub struct Neighbourhoods {
    pub triangles: Vec<[u32; 3]>,
    pub rings: Rings,
}

impl Neighbourhoods {
    pub fn new(mesh: &Mesh) -> Neighbourhoods {
        let edges = Edges::new(mesh);
        let flips = edges.winding().flips;
        let turn = |(&[a, b, c], flip): (&[u32; 3], bool)| if flip { [a, c, b] } else { [a, b, c] };
        Neighbourhoods {
            triangles: mesh.triangles.iter().zip(flips).map(turn).collect(),
            rings: edges.rings(mesh.positions.len()),
        }
    }
}

/// Features of V vertices at given positions.
pub struct Features {
    /// `f = (v - mean of the ring) . n / l`, dimensionless; meaningless where the vertex is not in `usable`.
    pub offsets: Vec<f64>,
    /// Unit vector `n` along the ring's area vector; zero where that vanishes.
    pub normals: Vec<DVec3>,
    /// `l`, the square root of the length of the area vector, in scene units.
    pub sizes: Vec<f64>,
    /// Vertices with a closed ring of positive area, ascending.
    pub usable: Vec<u32>,
}

impl Features {
    pub fn new(positions: &[DVec3], neighbourhoods: &Neighbourhoods) -> Features {
        let rings = &neighbourhoods.rings;
        let areas = ring_areas(positions, &neighbourhoods.triangles);
        let sizes: Vec<f64> = areas.iter().map(|area| area.length().sqrt()).collect();
        let normals: Vec<DVec3> = areas.iter().map(|area| area.normalize_or_zero()).collect();
        let offsets: Vec<f64> = (0..positions.len())
            .map(|v| {
                (positions[v] - ring_mean(positions, rings.neighbours(v))).dot(normals[v])
                    / sizes[v]
            })
            .collect();
        let usable =
            (0..positions.len()).filter(|&v| rings.is_closed(v) && (offsets[v] as f32).is_finite());
        Features {
            usable: usable.map(|v| v as u32).collect(),
            offsets,
            normals,
            sizes,
        }
    }
}

/// Half the sum of the cross products of successive spokes: independent of the vertex itself where its ring is closed.
fn ring_areas(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut areas = vec![DVec3::ZERO; positions.len()];
    for &triangle in triangles {
        let [a, b, c] = triangle.map(|v| positions[v as usize]);
        let area = (b - a).cross(c - a) * 0.5;
        for vertex in triangle {
            areas[vertex as usize] += area;
        }
    }
    areas
}

fn ring_mean(positions: &[DVec3], neighbours: &[u32]) -> DVec3 {
    neighbours
        .iter()
        .map(|&n| positions[n as usize])
        .sum::<DVec3>()
        / neighbours.len().max(1) as f64
}
