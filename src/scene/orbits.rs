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

/// A displacement `d` of one vertex, as a placement shows it, goes with one of another. There are up to two for each element of a
/// scene, so a link says whose its map is, and not the map.
#[derive(Clone, Copy)]
struct Link {
    from: u32,
    to: u32,
    /// The placements of the two.
    placements: [u32; 2],
}

impl Link {
    /// The displacement of the second vertex is this map of the first one's; `None` where the first placement has no inverse.
    fn map(&self, placements: &[Placement]) -> Option<DMat3> {
        let [from, to] = self.placements.map(|index| placements.get(index as usize));
        Some(to?.to_world.matrix3 * from?.to_local?)
    }
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
        let (members, consistent) = orbit(root, &links, placements);
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
    // The placements of one accessor side by side: what is fixed in it is asked once, however often it is shown.
    let order = order_by(placements.iter().map(|shown| shown.accessor as u64));
    for shown in order.chunk_by(|a, b| a.0 == b.0) {
        let mut shown = shown
            .iter()
            .filter_map(|&(_, index)| placements.get(index as usize))
            .peekable();
        let Some(first) = shown.peek() else { continue };
        let held = document.fixed_elements(first.accessor)?;
        for placement in shown {
            for (vertex, held) in placement.vertices.iter().zip(&held) {
                if let Some(vertex) = *vertex
                    && (*held || placement.to_local.is_none())
                {
                    set(&mut fixed, vertex);
                }
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
    let has_inverse = |placement: u32| {
        let placement = placements.get(placement as usize);
        placement.is_some_and(|placement| placement.to_local.is_some())
    };
    for uses in uses(document, placements)?.chunk_by(|a, b| a.slot == b.slot) {
        let Some((first, others)) = uses.split_first() else {
            continue;
        };
        for other in others {
            if has_inverse(first.placement) && has_inverse(other.placement) {
                links.extend([(first, other), (other, first)].map(|(from, to)| Link {
                    from: from.vertex,
                    to: to.vertex,
                    placements: [from.placement, to.placement],
                }));
            }
        }
    }
    let order = order_by(links.iter().map(|link| u64::from(link.from))).into_iter();
    Ok(order
        .filter_map(|(_, index)| links.get(index as usize).copied())
        .collect())
}

/// All vertices that are linked to a root, each once and with its map, and whether their links agree.
fn orbit(root: u32, links: &[Link], placements: &[Placement]) -> (Vec<(u32, DMat3)>, bool) {
    let mut maps = BTreeMap::from([(root, DMat3::IDENTITY)]);
    let mut open = vec![root];
    let mut consistent = true;
    while let Some(vertex) = open.pop() {
        let map = maps.get(&vertex).copied().unwrap_or_default();
        let first = links.partition_point(|link| link.from < vertex);
        let from_here = links.get(first..).unwrap_or_default();
        for link in from_here.iter().take_while(|link| link.from == vertex) {
            let Some(step) = link.map(placements) else {
                continue;
            };
            let reached = step * map;
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
