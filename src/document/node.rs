//! Nodes, and the tree they form (glTF 2.0 specification section 3.5).

use super::schema::{self, Root};
use super::{DocumentError, item};

/// An object of the scene: a transform, and what hangs on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// From the node's coordinates to its parent's.
    pub transform: Transform,
    /// The nodes placed relative to this one. No node is the child of two, none its own descendant.
    pub children: Vec<usize>,
    /// The mesh shown at this node.
    pub mesh: Option<usize>,
    /// The skin that deforms the mesh.
    pub skin: Option<usize>,
}

/// A node's transform as the file states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transform {
    /// A 4x4 matrix in column-major order.
    Matrix([f64; 16]),
    /// Scale, then rotation, then translation.
    Decomposed {
        /// The translation.
        translation: [f64; 3],
        /// The rotation as a quaternion (x, y, z, w), not necessarily of unit length.
        rotation: [f64; 4],
        /// The scale along each axis.
        scale: [f64; 3],
    },
}

/// The nodes of the file, and its root nodes: those of all scenes in ascending order, or all nodes
/// without a parent if there is no scene.
pub(super) fn read(root: &Root) -> Result<(Vec<Node>, Vec<usize>), DocumentError> {
    let nodes = root.nodes.iter().enumerate();
    let nodes: Vec<Node> = nodes
        .map(|(index, node)| read_node(root, index, node))
        .collect::<Result<_, _>>()?;
    let orphans = parentless(&nodes)?;
    check_acyclic(&nodes, &orphans)?;

    let mut is_root = vec![false; nodes.len()];
    for (index, scene) in root.scenes.iter().enumerate() {
        for (place, &node) in scene.nodes.iter().enumerate() {
            let pointer = format_args!("/scenes/{index}/nodes/{place}");
            let (node, _) = item(&nodes, node, "nodes", pointer)?;
            if orphans.binary_search(&node).is_err() {
                return Err(DocumentError::NotARoot {
                    pointer: pointer.to_string(),
                    node,
                });
            }
            is_root
                .get_mut(node)
                .into_iter()
                .for_each(|flag| *flag = true);
        }
    }
    let roots = if root.scenes.is_empty() {
        orphans
    } else {
        places(&is_root, true)
    };
    Ok((nodes, roots))
}

/// Where a list of flags has this value.
fn places(flags: &[bool], value: bool) -> Vec<usize> {
    let flags = flags.iter().enumerate();
    flags
        .filter_map(|(place, flag)| (*flag == value).then_some(place))
        .collect()
}

fn read_node(root: &Root, index: usize, node: &schema::Node) -> Result<Node, DocumentError> {
    let children = node.children.iter().enumerate().map(|(place, &child)| {
        let pointer = format_args!("/nodes/{index}/children/{place}");
        Ok(item(&root.nodes, child, "nodes", pointer)?.0)
    });
    let children = children.collect::<Result<_, DocumentError>>()?;
    let mesh = node.mesh.map(|mesh| {
        item(
            &root.meshes,
            mesh,
            "meshes",
            format_args!("/nodes/{index}/mesh"),
        )
    });
    let skin = node.skin.map(|skin| {
        item(
            &root.skins,
            skin,
            "skins",
            format_args!("/nodes/{index}/skin"),
        )
    });
    Ok(Node {
        transform: match node.matrix {
            Some(matrix) => Transform::Matrix(matrix),
            None => Transform::Decomposed {
                translation: node.translation.unwrap_or([0.0; 3]),
                rotation: node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
                scale: node.scale.unwrap_or([1.0; 3]),
            },
        },
        children,
        mesh: mesh.transpose()?.map(|(mesh, _)| mesh),
        skin: skin.transpose()?.map(|(skin, _)| skin),
    })
}

/// The nodes without a parent, ascending. An error if a node has two.
fn parentless(nodes: &[Node]) -> Result<Vec<usize>, DocumentError> {
    let mut has_parent = vec![false; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for (place, &child) in node.children.iter().enumerate() {
            let seen = has_parent
                .get_mut(child)
                .map(|flag| std::mem::replace(flag, true));
            if seen == Some(true) {
                return Err(DocumentError::SharedNode {
                    pointer: format!("/nodes/{index}/children/{place}"),
                    node: child,
                });
            }
        }
    }
    Ok(places(&has_parent, false))
}

/// With at most one parent each, the nodes on loops and below them are those no root leads to.
fn check_acyclic(nodes: &[Node], roots: &[usize]) -> Result<(), DocumentError> {
    let mut reached = vec![false; nodes.len()];
    let mut pending = roots.to_vec();
    while let Some(index) = pending.pop() {
        if let (Some(flag), Some(node)) = (reached.get_mut(index), nodes.get(index)) {
            *flag = true;
            pending.extend_from_slice(&node.children);
        }
    }
    match reached.iter().position(|reached| !reached) {
        Some(node) => Err(DocumentError::CyclicNodes {
            pointer: format!("/nodes/{node}"),
            node,
        }),
        None => Ok(()),
    }
}
