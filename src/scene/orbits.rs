//! Which vertices must move together, and which cannot move.

use super::Placement;
use super::uses::uses;
use crate::document::{Document, DocumentError};
use crate::mesh::{Admissible, Orbit};
use crate::order::order_by;
use glam::DMat3;
use std::collections::BTreeMap;

/// Relative difference at which two ways to the same displacement count as one.
const TOLERANCE: f64 = 1e-9;

/// A displacement `d` of one vertex goes with `map d` of another.
#[derive(Clone, Copy)]
struct Link {
    from: u32,
    to: u32,
    map: DMat3,
}

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
    let mut visited = vec![false; num_vertices];
    for &Link { from: root, .. } in &links {
        if is_set(&visited, root) {
            continue;
        }
        let (members, consistent) = orbit(root, &links);
        let vertices = || members.iter().map(|&(vertex, _)| vertex);
        vertices().for_each(|vertex| set(&mut visited, vertex));
        if !consistent || vertices().any(|vertex| is_set(&fixed, vertex)) {
            vertices().for_each(|vertex| set(&mut fixed, vertex));
        } else if members.len() > 1 {
            orbits.push(Orbit { members });
        }
    }
    let fixed = fixed.iter().zip(0..).filter(|(fixed, _)| **fixed);
    Ok(Admissible {
        orbits,
        fixed: fixed.map(|(_, vertex)| vertex).collect(),
    })
}

/// For each vertex, whether an element of it cannot be written.
fn unwritable(
    document: &Document,
    placements: &[Placement],
    num_vertices: usize,
) -> Result<Vec<bool>, DocumentError> {
    let mut fixed = vec![false; num_vertices];
    for placement in placements {
        let held = document.fixed_elements(placement.accessor)?;
        for (vertex, held) in placement.vertices.iter().zip(held) {
            if let Some(vertex) = *vertex
                && (held || placement.to_local.is_none())
            {
                set(&mut fixed, vertex);
            }
        }
    }
    Ok(fixed)
}

fn is_set(flags: &[bool], vertex: u32) -> bool {
    flags.get(vertex as usize) == Some(&true)
}

fn set(flags: &mut [bool], vertex: u32) {
    if let Some(flag) = flags.get_mut(vertex as usize) {
        *flag = true;
    }
}

/// The links between vertices that share an element's bytes, both ways, those from one vertex side by side.
fn links(document: &Document, placements: &[Placement]) -> Result<Vec<Link>, DocumentError> {
    let mut links: Vec<Link> = Vec::new();
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
            links.push(Link {
                from: first.vertex,
                to: other.vertex,
                map: other_to_world * to_local,
            });
            links.push(Link {
                from: other.vertex,
                to: first.vertex,
                map: to_world * other_to_local,
            });
        }
    }
    let order = order_by(links.iter().map(|link| u64::from(link.from))).into_iter();
    Ok(order
        .filter_map(|(_, index)| links.get(index as usize).copied())
        .collect())
}

/// All vertices that are linked to a root, each once and with its map, and whether their links agree.
fn orbit(root: u32, links: &[Link]) -> (Vec<(u32, DMat3)>, bool) {
    let mut maps = BTreeMap::from([(root, DMat3::IDENTITY)]);
    let mut open = vec![root];
    let mut consistent = true;
    while let Some(vertex) = open.pop() {
        let map = maps.get(&vertex).copied().unwrap_or_default();
        let first = links.partition_point(|link| link.from < vertex);
        let from_here = links.get(first..).unwrap_or_default();
        for link in from_here.iter().take_while(|link| link.from == vertex) {
            let reached = link.map * map;
            match maps.get(&link.to) {
                Some(known) => consistent &= agree(known, &reached),
                None => {
                    maps.insert(link.to, reached);
                    open.push(link.to);
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
