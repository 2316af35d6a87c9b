//! The trees that nodes form.
//!
//! glTF asks for trees, and files that are none are read as loaders show them: a node that several others list, or a scene beside
//! them, is shown once each way, as a copy of its own. Instances (`EXT_mesh_gpu_instancing`) are nodes too.

use super::accessor::Accessor;
use super::buffer::Storage;
use super::instances::instances;
use super::node::{Node, stated};
use super::schema::{MAX_NODES, Root};
use super::{DocumentError, item};

/// The nodes of the file, with a copy for each further way that a node is shown, and the root nodes: those of all scenes in
/// ascending order, or all nodes without a parent if there is no scene.
pub(super) fn read(
    root: &Root,
    accessors: &[Accessor],
    storages: &[Storage],
) -> Result<(Vec<Node>, Vec<usize>), DocumentError> {
    let mut nodes = stated(root)?;
    instances(root, accessors, storages, &mut nodes)?;
    let parents = num_parents(&nodes);
    let orphans = places(&parents, |&count| count == 0);
    let order = ordered(&nodes, &parents)?;
    let roots = if root.scenes.is_empty() {
        orphans.clone()
    } else {
        listed(root, &nodes)?
    };
    let has_parent = |&node: &usize| parents.get(node).is_some_and(|&count| count > 0);
    if parents.iter().all(|&count| count <= 1) && !roots.iter().any(has_parent) {
        return Ok((nodes, roots));
    }
    let mut starts = roots.clone();
    starts.extend(
        orphans
            .iter()
            .filter(|orphan| roots.binary_search(orphan).is_err()),
    );
    check_size(&nodes, &order, &starts)?;
    Ok((trees(nodes, &starts), roots))
}

/// Where a list has what a condition asks for.
fn places<T>(list: &[T], condition: impl Fn(&T) -> bool) -> Vec<usize> {
    let list = list.iter().enumerate();
    list.filter_map(|(place, value)| condition(value).then_some(place))
        .collect()
}

/// How many nodes list each node.
fn num_parents(nodes: &[Node]) -> Vec<usize> {
    let mut parents = vec![0_usize; nodes.len()];
    for &child in nodes.iter().flat_map(|node| &node.children) {
        if let Some(count) = parents.get_mut(child) {
            *count = count.saturating_add(1);
        }
    }
    parents
}

/// The nodes, each after all that list it. Those on loops and below them have no such place.
fn ordered(nodes: &[Node], parents: &[usize]) -> Result<Vec<usize>, DocumentError> {
    let mut waits_for = parents.to_vec();
    let mut order = places(parents, |&count| count == 0);
    let mut next = 0_usize;
    while let Some(&index) = order.get(next) {
        next = next.saturating_add(1);
        for &child in nodes.get(index).map_or(&[][..], |node| &node.children) {
            if let Some(count) = waits_for.get_mut(child) {
                *count = count.saturating_sub(1);
                if *count == 0 {
                    order.push(child);
                }
            }
        }
    }
    match waits_for.iter().position(|&count| count > 0) {
        Some(node) => Err(DocumentError::CyclicNodes {
            pointer: format!("/nodes/{node}"),
            node,
        }),
        None => Ok(order),
    }
}

/// The nodes that the scenes list, ascending. A node that is reached through nodes without a transform too would be shown at the
/// same place twice: some exporters list every node of a scene.
fn listed(root: &Root, nodes: &[Node]) -> Result<Vec<usize>, DocumentError> {
    let mut is_listed = vec![false; nodes.len()];
    for (index, scene) in root.scenes.iter().enumerate() {
        for (place, &node) in scene.nodes.iter().enumerate() {
            let pointer = format_args!("/scenes/{index}/nodes/{place}");
            let (node, _) = item(&root.nodes, node, "nodes", pointer)?;
            set(&mut is_listed, node);
        }
    }
    let mut is_below = vec![false; nodes.len()];
    let mut open = places(&is_listed, |&listed| listed);
    while let Some(node) = open.pop().and_then(|index| nodes.get(index)) {
        if node.transform.is_none() {
            for &child in &node.children {
                if is_below.get(child) == Some(&false) {
                    set(&mut is_below, child);
                    open.push(child);
                }
            }
        }
    }
    let both = is_listed.iter().zip(is_below);
    let roots: Vec<bool> = both.map(|(&listed, below)| listed && !below).collect();
    Ok(places(&roots, |&root| root))
}

fn set(flags: &mut [bool], place: usize) {
    flags
        .get_mut(place)
        .into_iter()
        .for_each(|flag| *flag = true);
}

/// Refuses more nodes than a file may state, each counted as often as a way leads to it: there may be exponentially many.
fn check_size(nodes: &[Node], order: &[usize], starts: &[usize]) -> Result<(), DocumentError> {
    let mut sizes = vec![0_u64; nodes.len()];
    let sum = |places: &[usize], sizes: &[u64]| {
        let sizes = places.iter().filter_map(|&place| sizes.get(place));
        sizes.fold(0_u64, |sum, &size| sum.saturating_add(size))
    };
    for &index in order.iter().rev() {
        let children = nodes.get(index).map_or(&[][..], |node| &node.children);
        let size = sum(children, &sizes).saturating_add(1);
        if let Some(slot) = sizes.get_mut(index) {
            *slot = size;
        }
    }
    let total = sum(starts, &sizes);
    if total > MAX_NODES as u64 {
        return Err(DocumentError::TooLarge {
            what: "the number of nodes, each as often as it is shown,",
            value: total,
            limit: MAX_NODES as u64,
            pointer: Some("/nodes".to_owned()),
        });
    }
    Ok(())
}

/// Trees from nodes that several may list: the first way to a node keeps it, every other one gets a copy at the end.
fn trees(stated: Vec<Node>, starts: &[usize]) -> Vec<Node> {
    let mut nodes = stated.clone();
    let mut is_taken = vec![false; stated.len()];
    starts.iter().for_each(|&start| set(&mut is_taken, start));
    let mut open: Vec<(usize, usize)> = starts.iter().map(|&start| (start, start)).collect();
    while let Some((of, own)) = open.pop() {
        let Some(node) = stated.get(of) else { continue };
        let mut children = Vec::with_capacity(node.children.len());
        for &child in &node.children {
            let is_first = is_taken.get(child) == Some(&false);
            let own = if is_first { child } else { nodes.len() };
            if is_first {
                set(&mut is_taken, child);
            } else {
                nodes.extend(stated.get(child).cloned());
            }
            children.push(own);
            open.push((child, own));
        }
        if let Some(node) = nodes.get_mut(own) {
            node.children = children;
        }
    }
    nodes
}
