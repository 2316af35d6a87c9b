//! Nodes (glTF 2.0 specification section 3.5).

use super::schema::{self, Root};
use super::{DocumentError, item};

/// An object of the scene: a transform, and what hangs on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// What people call it.
    pub name: Option<String>,
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

impl Transform {
    /// What leaves everything where it is.
    pub(super) const NONE: Self = Self::Decomposed {
        translation: [0.0; 3],
        rotation: [0.0, 0.0, 0.0, 1.0],
        scale: [1.0; 3],
    };

    /// Whether it leaves everything where it is.
    pub(super) fn is_none(&self) -> bool {
        const IDENTITY: [f64; 16] = [
            1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        ];
        *self == Self::NONE || *self == Self::Matrix(IDENTITY)
    }
}

/// The nodes as the file states them: several may list the same.
pub(super) fn stated(root: &Root) -> Result<Vec<Node>, DocumentError> {
    let mut lister = vec![0; root.nodes.len()];
    let nodes = root.nodes.iter().enumerate();
    nodes
        .map(|(index, node)| read_node(root, index, node, &mut lister))
        .collect()
}

/// A node, its children once each: `lister` has the number of the last node that listed each one.
fn read_node(
    root: &Root,
    index: usize,
    node: &schema::Node,
    lister: &mut [usize],
) -> Result<Node, DocumentError> {
    let number = index.saturating_add(1);
    let mut children = Vec::with_capacity(node.children.len());
    for (place, &child) in node.children.iter().enumerate() {
        let pointer = format_args!("/nodes/{index}/children/{place}");
        let (child, _) = item(&root.nodes, child, "nodes", pointer)?;
        if let Some(last) = lister.get_mut(child).filter(|last| **last != number) {
            *last = number;
            children.push(child);
        }
    }
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
        name: node.name.clone(),
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
