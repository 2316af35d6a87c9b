//! Isotropic re-meshing.

use super::editing::Editable;
use crate::geometry::{Surface, diagonal};
use crate::mesh::Mesh;
use glam::DVec3;
use std::collections::BinaryHeap;

/// Rounds, as MeshLab's filter has in attacks on watermarks.
const ROUNDS: u32 = 5;
/// Cosine of the angle between two faces, 30 degrees, at which the edge between them is a crease: MeshLab's default.
const CREASE: f64 = 0.866_025_403_784_438_6;

/// Other triangles on the same surface, their edges about `length` times the bounding box's diagonal long: edges that are too
/// long are split, those that are too short collapsed, valences evened by flips, vertices moved within the surface and put
/// back onto it (Botsch and Kobbelt 2004), five times. Borders and creases of more than 30 degrees keep their places.
pub fn remesh(mesh: &Mesh, length: f64) -> Mesh {
    let length = length * diagonal(&mesh.positions);
    let surface = Surface::new(mesh);
    let mut editable = Editable::new(mesh);
    for _ in 0..ROUNDS {
        split_long(&mut editable, 4.0 / 3.0 * length);
        collapse_short(&mut editable, 4.0 / 5.0 * length, 4.0 / 3.0 * length);
        even_valences(&mut editable);
        relax(&mut editable, &surface);
    }
    editable.mesh()
}

/// The longest edge first: in another order triangles grow ever thinner, and far too many.
fn split_long(editable: &mut Editable, longest: f64) {
    // Lengths are not negative, so their bits are in their order.
    let entry = |editable: &Editable, a: u32, b: u32| (editable.length(a, b).to_bits(), a, b);
    let mut heap: BinaryHeap<_> = editable
        .edges()
        .into_iter()
        .map(|[a, b]| entry(editable, a, b))
        .collect();
    while let Some((length, a, b)) = heap.pop() {
        if f64::from_bits(length) <= longest {
            break;
        }
        let apexes: Vec<u32> = editable.apexes(a, b).collect();
        let middle = editable.split(a, b);
        for &end in [a, b].iter().chain(&apexes) {
            heap.push(entry(editable, end, middle));
        }
    }
}

fn collapse_short(editable: &mut Editable, shortest: f64, longest: f64) {
    for [a, b] in editable.edges() {
        if editable.apexes(a, b).next().is_none() || editable.length(a, b) >= shortest {
            continue;
        }
        let along = editable.is_crease(a, b, CREASE);
        // A vertex without creases goes to one with them; along a crease, a plain one to a corner.
        let (kept, lost, to) = match (place(editable, a), place(editable, b)) {
            (Place::Smooth, Place::Smooth) => (a, b, editable.at(a).midpoint(editable.at(b))),
            (_, Place::Smooth) => (a, b, editable.at(a)),
            (Place::Smooth, _) => (b, a, editable.at(b)),
            (_, Place::Line) if along => (a, b, editable.at(a)),
            (Place::Line, _) if along => (b, a, editable.at(b)),
            _ => continue,
        };
        let ends = [editable.neighbours(kept), editable.neighbours(lost)].concat();
        if ends.iter().all(|&v| editable.at(v).distance(to) <= longest) {
            editable.collapse(kept, lost, to);
        }
    }
}

/// Flips edges where that brings valences nearer to 6, or 4 on a border.
fn even_valences(editable: &mut Editable) {
    for [a, b] in editable.edges() {
        let Some([c, d]) = editable.opposite(a, b) else {
            continue;
        };
        if editable.is_crease(a, b, CREASE) {
            continue;
        }
        let excess = |v: u32| {
            let ideal = if editable.is_border(v) { 4 } else { 6 };
            editable.neighbours(v).len() as i64 - ideal
        };
        let before = [a, b, c, d].map(excess);
        let after = [before[0] - 1, before[1] - 1, before[2] + 1, before[3] + 1];
        let deviation = |excess: [i64; 4]| excess.iter().map(|e| e * e).sum::<i64>();
        if deviation(after) < deviation(before) {
            editable.flip(a, b);
        }
    }
}

/// Moves vertices that are on no crease to the means of their neighbours, within the surface.
fn relax(editable: &mut Editable, surface: &Surface) {
    let moved = |vertex: u32| -> Option<DVec3> {
        let neighbours = editable.neighbours(vertex);
        if neighbours.is_empty() || place(editable, vertex) != Place::Smooth {
            return None;
        }
        let normal = editable
            .faces_at(vertex)
            .map(|face| editable.normal(face))
            .sum::<DVec3>()
            .normalize_or_zero();
        let sum: DVec3 = neighbours.iter().map(|&n| editable.at(n)).sum();
        let step = sum / neighbours.len() as f64 - editable.at(vertex);
        let tangential = editable.at(vertex) + step - normal * normal.dot(step);
        Some(surface.nearest(tangential)?.point)
    };
    let positions: Vec<DVec3> = (0..editable.positions.len() as u32)
        .map(|v| moved(v).unwrap_or(editable.at(v)))
        .collect();
    editable.positions = positions;
}

/// Where a vertex is.
#[derive(PartialEq)]
enum Place {
    Smooth,
    /// In the course of a crease.
    Line,
    /// Where creases meet, end or turn.
    Corner,
}

fn place(editable: &Editable, vertex: u32) -> Place {
    let mut creases = editable.neighbours(vertex);
    creases.retain(|&n| editable.is_crease(vertex, n, CREASE));
    let along = |n: u32| (editable.at(n) - editable.at(vertex)).normalize_or_zero();
    match creases[..] {
        [] => Place::Smooth,
        [a, b] if along(a).dot(along(b)) < -CREASE => Place::Line,
        _ => Place::Corner,
    }
}
