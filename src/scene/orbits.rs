//! Which vertices must move together, and which cannot move.

use super::Placement;
use super::uses::uses;
use crate::document::{Document, DocumentError};
use crate::mesh::{Admissible, Orbit};
use glam::DMat3;
use std::collections::BTreeMap;

/// Relative difference at which two ways to the same displacement count as one.
const TOLERANCE: f64 = 1e-9;

/// `M`: a displacement `d` of one vertex goes with `M d` of another.
type Link = (u32, DMat3);

/// The displacements that can be written: bytes that several nodes show link the instances of their vertices; vertices
/// whose links contradict each other (a mirrored copy that touches itself), or that cannot be written, are fixed.
pub fn admissible(
    document: &Document,
    placements: &[Placement],
    num_vertices: usize,
) -> Result<Admissible, DocumentError> {
    let mut fixed = unwritable(document, placements, num_vertices)?;
    let links = links(document, placements)?;
    let mut orbits = Vec::new();
    let mut visited = vec![false; if links.is_empty() { 0 } else { num_vertices }];
    for &root in links.keys() {
        if visited[root as usize] {
            continue;
        }
        match orbit(root, &links, &mut visited) {
            (members, true) if !members.iter().any(|&(vertex, _)| fixed[vertex as usize]) => {
                if members.len() > 1 {
                    orbits.push(Orbit { members });
                }
            }
            (members, _) => members
                .iter()
                .for_each(|&(vertex, _)| fixed[vertex as usize] = true),
        }
    }
    let fixed = fixed
        .iter()
        .zip(0..)
        .filter(|(fixed, _)| **fixed)
        .map(|(_, vertex)| vertex)
        .collect();
    Ok(Admissible { orbits, fixed })
}

/// For each vertex, whether one of its elements cannot be written.
fn unwritable(
    document: &Document,
    placements: &[Placement],
    num_vertices: usize,
) -> Result<Vec<bool>, DocumentError> {
    let mut fixed = vec![false; num_vertices];
    for placement in placements {
        let elements = document.fixed_elements(placement.accessor)?;
        for (element, vertex) in placement.vertices.iter().enumerate() {
            if let Some(vertex) = vertex {
                let held = elements.get(element).copied().unwrap_or(true);
                fixed[*vertex as usize] |= held || placement.to_local.is_none();
            }
        }
    }
    Ok(fixed)
}

/// For each vertex that shares an element's bytes with another, the links from it.
fn links(
    document: &Document,
    placements: &[Placement],
) -> Result<BTreeMap<u32, Vec<Link>>, DocumentError> {
    let mut links: BTreeMap<u32, Vec<Link>> = BTreeMap::new();
    for uses in uses(document, placements)?.chunk_by(|a, b| a.slot == b.slot) {
        let (a, first) = (uses[0].vertex, &placements[uses[0].placement]);
        for other in &uses[1..] {
            let (b, other) = (other.vertex, &placements[other.placement]);
            let (Some(to_first), Some(to_other)) = (first.to_local, other.to_local) else {
                continue;
            };
            links
                .entry(a)
                .or_default()
                .push((b, other.to_world.matrix3 * to_first));
            links
                .entry(b)
                .or_default()
                .push((a, first.to_world.matrix3 * to_other));
        }
    }
    Ok(links)
}

/// All vertices that are linked to a root, and whether their links agree.
fn orbit(root: u32, links: &BTreeMap<u32, Vec<Link>>, visited: &mut [bool]) -> (Vec<Link>, bool) {
    let mut maps = BTreeMap::from([(root, DMat3::IDENTITY)]);
    let mut members = vec![(root, DMat3::IDENTITY)];
    let mut consistent = true;
    let mut next = 0;
    visited[root as usize] = true;
    while let Some(&(vertex, map)) = members.get(next) {
        next += 1;
        for &(neighbour, link) in links.get(&vertex).into_iter().flatten() {
            let reached = link * map;
            match maps.get(&neighbour) {
                Some(known) => consistent &= agree(known, &reached),
                None => {
                    maps.insert(neighbour, reached);
                    members.push((neighbour, reached));
                    visited[neighbour as usize] = true;
                }
            }
        }
    }
    (members, consistent)
}

fn agree(a: &DMat3, b: &DMat3) -> bool {
    let (a, b) = (a.to_cols_array(), b.to_cols_array());
    let scale = a
        .iter()
        .fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    a.iter()
        .zip(&b)
        .all(|(a, b)| (a - b).abs() <= TOLERANCE * scale)
}
