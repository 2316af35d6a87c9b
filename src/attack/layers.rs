//! The same surface with more beside it that is not seen: triangles that are there more than once, shells, what lies inside, what is strewn.

use crate::geometry::{diagonal, vertex_normals};
use crate::mesh::{Mesh, shapes};
use crate::random::Random;
use glam::DVec3;

/// Writes every triangle a second time, turned over, on the same vertices: what exporters do for materials with two sides.
pub fn both_sides(mesh: &Mesh) -> Mesh {
    let turned = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]);
    Mesh {
        triangles: mesh.triangles.iter().copied().chain(turned).collect(),
        positions: mesh.positions.clone(),
    }
}

/// Copies a random share of the triangles, `times` times each, turned over or not at random, with vertices of their own that lie elsewhere by
/// up to `away` diagonals; and writes all in random order.
pub fn copies(mesh: &Mesh, share: f64, times: u32, away: f64, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let reach = away * diagonal(&mesh.positions);
    let mut parts = vec![mesh.clone()];
    for _ in 0..times {
        let chosen = mesh.triangles.iter().filter(|_| random.unit() < share);
        let mut copy = mesh.part(chosen.copied().collect::<Vec<_>>());
        for triangle in &mut copy.triangles {
            if random.unit() < 0.5 {
                triangle.swap(1, 2);
            }
        }
        for position in &mut copy.positions {
            let mut offset = || reach * (2.0 * random.unit() - 1.0);
            *position += DVec3::new(offset(), offset(), offset());
        }
        parts.push(copy);
    }
    let mut all = Mesh::joined(parts);
    let order = random.permutation(all.triangles.len());
    all.triangles = order.iter().map(|&t| all.triangles[t as usize]).collect();
    all
}

/// Adds triangles that cover nothing: at a random share of the triangles one without area, between two corners and the middle of their side,
/// and a needle of a thousandth of the side's length at its middle.
pub fn needles(mesh: &Mesh, share: f64, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let mut all = mesh.clone();
    for &triangle in &mesh.triangles {
        if random.unit() >= share {
            continue;
        }
        let [a, b, _] = triangle;
        let [p, q, r] = mesh.corners(triangle);
        let middle = p.midpoint(q);
        for tip in [middle, middle + (r - middle) * 1e-3] {
            let name = all.positions.len() as u32;
            all.positions.push(tip);
            all.triangles.push([a, name, b]);
        }
    }
    all
}

/// Lays a second shell about the model, or within it, at a distance that is a fraction of the diagonal: every vertex goes along its normal, and
/// every triangle is turned over, as outlines of drawn figures and hollowed prints have it.
pub fn hull(mesh: &Mesh, distance: f64) -> Mesh {
    Mesh::joined([mesh.clone(), shell(mesh, distance)])
}

/// The same, joined to the model by a bridge of two triangles: all hangs together by edges.
pub fn bridged_hull(mesh: &Mesh, distance: f64) -> Mesh {
    let mut all = hull(mesh, distance);
    let first = mesh.positions.len() as u32;
    if let Some(&[a, b, _]) = mesh.triangles.first() {
        let bridge = [[a, b, b + first], [a, b + first, a + first]];
        all.triangles.extend(bridge);
    }
    all
}

fn shell(mesh: &Mesh, distance: f64) -> Mesh {
    let away = distance * diagonal(&mesh.positions);
    let moved = mesh.positions.iter().zip(vertex_normals(mesh));
    Mesh {
        positions: moved.map(|(p, normal)| *p + normal * away).collect(),
        triangles: mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    }
}

/// Hides a ball in the model, at the vertices' centre, of a radius that is a fraction of the diagonal.
pub fn ball_within(mesh: &Mesh, radius: f64) -> Mesh {
    let centre = mesh.positions.iter().sum::<DVec3>() / mesh.positions.len().max(1) as f64;
    let radius = radius * diagonal(&mesh.positions);
    let ball = shapes::icosphere(3); // of radius 1
    let positions = ball.positions.iter().map(|p| centre + *p * radius);
    Mesh::joined([mesh.clone(), ball.with_positions(positions.collect())])
}

/// Leaves a triangle of a hundredth of the diagonal so many diagonals away.
pub fn stray(mesh: &Mesh, diagonals: f64) -> Mesh {
    let Some(&first) = mesh.positions.first() else {
        return Mesh::default();
    };
    let unit = diagonal(&mesh.positions);
    let start = first + DVec3::new(0.6, 0.64, 0.48) * unit * diagonals;
    let speck = Mesh {
        positions: [DVec3::ZERO, DVec3::X, DVec3::Y]
            .map(|p| start + p * 0.01 * unit)
            .to_vec(),
        triangles: vec![[0, 1, 2]],
    };
    Mesh::joined([mesh.clone(), speck])
}
