//! Which vertices a person sees as one: those that rounding parted, and those that a codec or an exporter parted along a seam.
//!
//! It depends on the mesh alone, so that an embedder and a detector see one surface. No vertex reaches farther than a share of its
//! shortest side, so no triangle is lost by it; and the two sides of a thin plate stay apart, for they are one part without an edge.

use super::diagonal;
use super::merge::{crowded, merged};
use crate::mesh::{Edges, Mesh};
use std::collections::BTreeSet;

/// What any two vertices are one within, as a fraction of the diagonal ...
const ROUNDED: f64 = 1e-6;
/// ... and no more than this fraction of the mean side: something small in a large scene stays what it is.
const OF_MEAN_SIDE: f64 = 1e-2;

/// What vertices are one within, as fractions of the diagonal: the greatest of these that is within a share of their shortest sides.
const PARTED: [f64; 5] = [1.25e-5, 2.5e-5, 5e-5, 1e-4, 2e-4];
/// Less than half, so that no third vertex is near two corners of a triangle.
const SHARE: f64 = 0.45;

/// What is parted in a mesh.
#[derive(Debug, Default, PartialEq)]
pub struct Seams {
    /// The vertices that are one with an earlier vertex, each with that one, in rising order.
    pub merged: Vec<(u32, u32)>,
    /// For each triangle its part while the seams are open: a trinket that lies on a table is a thing of its own. Empty without seams.
    pub parts: Vec<u32>,
}

/// Finds the seams of a mesh. O(V log V + F log D), D the most triangles at a vertex.
pub fn seams(mesh: &Mesh) -> Seams {
    let whole = diagonal(&mesh.positions);
    let rounded = (ROUNDED * whole).min(OF_MEAN_SIDE * mesh.mean_edge());
    if rounded <= 0.0 {
        return Seams::default();
    }
    let parted = PARTED.map(|share| share * whole);
    let near = crowded(&mesh.positions, parted[parted.len() - 1]);
    if near.is_empty() {
        return Seams::default();
    }
    let shortest = shortest_sides(mesh);
    let class = |vertex: u32| {
        let fits = |reach: &&f64| **reach <= SHARE * shortest[vertex as usize];
        parted.iter().filter(fits).count() as u8
    };
    let points: Vec<(u32, u8)> = near.into_iter().map(|v| (v, class(v))).collect();
    let reaches: Vec<f64> = [rounded].into_iter().chain(parted).collect();
    let edges = Edges::new(mesh);
    let parts_of_triangles = edges.components();
    let (parts, open) = parts_and_open(mesh, &edges, &parts_of_triangles);
    let is_rounded = |vertex: u32, other: u32| {
        let [a, b] = [vertex, other].map(|v| mesh.positions[v as usize]);
        a.distance(b) <= rounded
    };
    let mut merged = merged(&mesh.positions, &points, &reaches, |vertex, other| {
        let [a, b] = [vertex as usize, other as usize];
        parts[a] != parts[b] || open[a] || open[b] || is_rounded(vertex, other)
    });
    let sheets = sheets(mesh, &merged, &parts_of_triangles);
    merged.retain(|&(vertex, first)| {
        let pair = pair(parts[vertex as usize], parts[first as usize]);
        is_rounded(vertex, first) || !sheets.contains(&pair)
    });
    Seams {
        parts: match merged.is_empty() {
            true => Vec::new(),
            false => parts_of_triangles,
        },
        merged,
    }
}

/// The pairs of parts of which a triangle would lie upon one of the other: two sheets, and no seam.
fn sheets(mesh: &Mesh, merged: &[(u32, u32)], parts_of_triangles: &[u32]) -> BTreeSet<(u32, u32)> {
    let name = |vertex: u32| match merged.binary_search_by_key(&vertex, |&(vertex, _)| vertex) {
        Ok(found) => merged[found].1,
        Err(_) => vertex,
    };
    let mut triangles: Vec<([u32; 3], u32)> = Vec::new();
    if !merged.is_empty() {
        triangles.extend(
            mesh.triangles
                .iter()
                .zip(parts_of_triangles)
                .map(|(t, &part)| {
                    let mut corners = t.map(name);
                    corners.sort_unstable();
                    (corners, part)
                }),
        );
    }
    triangles.sort_unstable();
    let upon = triangles.chunk_by(|a, b| a.0 == b.0);
    upon.flat_map(|upon| upon.windows(2).map(|two| pair(two[0].1, two[1].1)))
        .collect()
}

fn pair(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// For each vertex the first part that it is in, and whether it has an edge with one triangle.
fn parts_and_open(mesh: &Mesh, edges: &Edges, parts_of_triangles: &[u32]) -> (Vec<u32>, Vec<bool>) {
    let mut parts = vec![u32::MAX; mesh.positions.len()];
    for (triangle, part) in mesh.triangles.iter().zip(parts_of_triangles) {
        for &vertex in triangle {
            let known = &mut parts[vertex as usize];
            *known = (*known).min(*part);
        }
    }
    let mut open = vec![false; mesh.positions.len()];
    for (from, to) in edges.boundary(&mesh.triangles) {
        open[from as usize] = true;
        open[to as usize] = true;
    }
    (parts, open)
}

/// The shortest side at each vertex; infinite without triangles.
fn shortest_sides(mesh: &Mesh) -> Vec<f64> {
    let mut shortest = vec![f64::INFINITY; mesh.positions.len()];
    for &[a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)].map(|(a, b)| (a as usize, b as usize)) {
            let side = mesh.positions[from].distance(mesh.positions[to]);
            shortest[from] = shortest[from].min(side);
            shortest[to] = shortest[to].min(side);
        }
    }
    shortest
}
