//! Which vertices must move together, and which cannot move.

use super::Placement;
use super::uses::uses;
use crate::document::{Document, DocumentError};
use crate::mesh::{Admissible, Orbit};
use glam::DMat3;
use std::collections::{BTreeMap, BTreeSet};

/// Relative difference at which two ways to the same displacement count as one.
const TOLERANCE: f64 = 1e-9;

/// `M`: a displacement `d` of one vertex goes with `M d` of another.
type Link = (u32, DMat3);

/// The displacements that can be written: bytes that several nodes show link the instances of their vertices; vertices
/// whose links contradict each other (a mirrored copy that touches itself), or that cannot be written, are fixed.
pub fn admissible(
    document: &Document,
    placements: &[Placement],
) -> Result<Admissible, DocumentError> {
    let mut fixed = unwritable(document, placements)?;
    let links = links(document, placements)?;
    let mut orbits = Vec::new();
    let mut visited = BTreeSet::new();
    for &root in links.keys() {
        if visited.contains(&root) {
            continue;
        }
        let (members, consistent) = orbit(root, &links);
        visited.extend(members.iter().map(|&(vertex, _)| vertex));
        if !consistent || members.iter().any(|(vertex, _)| fixed.contains(vertex)) {
            fixed.extend(members.iter().map(|&(vertex, _)| vertex));
        } else if members.len() > 1 {
            orbits.push(Orbit { members });
        }
    }
    Ok(Admissible {
        orbits,
        fixed: fixed.into_iter().collect(),
    })
}

/// The vertices of which an element cannot be written.
fn unwritable(
    document: &Document,
    placements: &[Placement],
) -> Result<BTreeSet<u32>, DocumentError> {
    let mut fixed = BTreeSet::new();
    for placement in placements {
        let held = document.fixed_elements(placement.accessor)?;
        let held = placement
            .vertices
            .iter()
            .zip(held)
            .filter(|(_, held)| *held || placement.to_local.is_none());
        fixed.extend(held.filter_map(|(vertex, _)| *vertex));
    }
    Ok(fixed)
}

/// For each vertex that shares an element's bytes with another, the links from it.
fn links(
    document: &Document,
    placements: &[Placement],
) -> Result<BTreeMap<u32, Vec<Link>>, DocumentError> {
    let mut links: BTreeMap<u32, Vec<Link>> = BTreeMap::new();
    let linear = |placement: usize| {
        let placement = placements.get(placement)?;
        Some((placement.to_world.matrix3, placement.to_local?))
    };
    for uses in uses(document, placements)?.chunk_by(|a, b| a.slot == b.slot) {
        let Some((first, others)) = uses.split_first() else {
            continue;
        };
        for other in others {
            let (Some((to_world, to_local)), Some((other_to_world, other_to_local))) =
                (linear(first.placement), linear(other.placement))
            else {
                continue;
            };
            links
                .entry(first.vertex)
                .or_default()
                .push((other.vertex, other_to_world * to_local));
            links
                .entry(other.vertex)
                .or_default()
                .push((first.vertex, to_world * other_to_local));
        }
    }
    Ok(links)
}

/// All vertices that are linked to a root, each once, and whether their links agree.
fn orbit(root: u32, links: &BTreeMap<u32, Vec<Link>>) -> (Vec<Link>, bool) {
    let mut maps = BTreeMap::from([(root, DMat3::IDENTITY)]);
    let mut open = vec![root];
    let mut consistent = true;
    while let Some(vertex) = open.pop() {
        let map = maps.get(&vertex).copied().unwrap_or_default();
        for &(neighbour, link) in links.get(&vertex).into_iter().flatten() {
            let reached = link * map;
            match maps.get(&neighbour) {
                Some(known) => consistent &= agree(known, &reached),
                None => {
                    maps.insert(neighbour, reached);
                    open.push(neighbour);
                }
            }
        }
    }
    (maps.into_iter().collect(), consistent)
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
