//! Instances of a mesh (`EXT_mesh_gpu_instancing`): each is a node below the one that states them.

use std::collections::BTreeMap;

use gltf::json::accessor::Type;

use super::accessor::{Accessor, bytes_at};
use super::buffer::Storage;
use super::node::{Node, Transform};
use super::schema::{MAX_NODES, Root};
use super::{DocumentError, item};

/// The attributes that place an instance.
#[derive(Clone, Copy)]
enum Attribute {
    Translation,
    Rotation,
    Scale,
}

impl Attribute {
    const ALL: [(&'static str, Self); 3] = [
        ("TRANSLATION", Self::Translation),
        ("ROTATION", Self::Rotation),
        ("SCALE", Self::Scale),
    ];

    fn num_components(self) -> usize {
        match self {
            Self::Rotation => 4,
            Self::Translation | Self::Scale => 3,
        }
    }
}

/// Gives every node that states instances a child for each of them, before its other children, and takes its mesh from it. Instances
/// at the same place are one; a mesh with a skin is shown once.
pub(super) fn instances(
    root: &Root,
    accessors: &[Accessor],
    storages: &[Storage],
    nodes: &mut Vec<Node>,
) -> Result<(), DocumentError> {
    for (index, stated) in root.nodes.iter().enumerate() {
        let Some(node) = nodes.get(index) else {
            continue;
        };
        let (Some(mesh), None) = (node.mesh, node.skin) else {
            continue;
        };
        let mut read = Vec::new();
        for (name, attribute) in Attribute::ALL {
            if let Some(&accessor) = stated.instances.get(name) {
                let pointer =
                    format!("/nodes/{index}/extensions/EXT_mesh_gpu_instancing/attributes/{name}");
                let (_, accessor) =
                    item(accessors, accessor, "accessors", format_args!("{pointer}"))?;
                check(accessor, attribute, nodes.len(), read.first(), &pointer)?;
                read.push((attribute, accessor));
            }
        }
        let Some(&(_, first)) = read.first() else {
            continue;
        };
        let transforms = transforms(&read, first.count, storages)?;
        let start = nodes.len();
        nodes.extend(transforms.into_iter().map(|transform| Node {
            name: None,
            transform,
            children: Vec::new(),
            mesh: Some(mesh),
            skin: None,
        }));
        let end = nodes.len();
        if let Some(node) = nodes.get_mut(index) {
            node.mesh = None;
            node.children.splice(0..0, start..end);
        }
    }
    Ok(())
}

/// Refuses an attribute that is of another kind, or has another length than the first one, or would make too many nodes.
fn check(
    accessor: &Accessor,
    attribute: Attribute,
    num_nodes: usize,
    first: Option<&(Attribute, &Accessor)>,
    pointer: &str,
) -> Result<(), DocumentError> {
    let bad = |detail: &str| DocumentError::BadAccessor {
        pointer: pointer.to_owned(),
        detail: detail.to_owned(),
    };
    let kind = match attribute {
        Attribute::Rotation => Type::Vec4,
        Attribute::Translation | Attribute::Scale => Type::Vec3,
    };
    if accessor.kind != kind {
        return Err(bad(
            "instances are placed by vectors of three numbers, and turned by four",
        ));
    }
    if first.is_some_and(|(_, first)| first.count != accessor.count) {
        return Err(bad("the attributes of instances have different lengths"));
    }
    let total = num_nodes.saturating_add(accessor.count);
    if total > MAX_NODES {
        return Err(DocumentError::TooLarge {
            what: "the number of nodes, instances included,",
            value: total as u64,
            limit: MAX_NODES as u64,
            pointer: Some(pointer.to_owned()),
        });
    }
    Ok(())
}

/// The transforms of the instances, each once.
fn transforms(
    attributes: &[(Attribute, &Accessor)],
    count: usize,
    storages: &[Storage],
) -> Result<Vec<Transform>, DocumentError> {
    let mut placed = vec![([0.0; 3], [0.0, 0.0, 0.0, 1.0], [1.0; 3]); count];
    for &(attribute, accessor) in attributes {
        let (format, size) = (accessor.format, accessor.format.component.size());
        let num_components = attribute.num_components();
        accessor.each(storages, |element, slot| {
            let slot =
                slot.and_then(|slot| bytes_at(storages, slot, size.saturating_mul(num_components)));
            let numbers = slot.unwrap_or_default().chunks(size);
            let numbers = numbers.filter_map(|bytes| Some(format.normalize(format.raw(bytes)?)));
            if let Some((translation, rotation, scale)) = placed.get_mut(element) {
                let stored: &mut [f64] = match attribute {
                    Attribute::Translation => translation,
                    Attribute::Rotation => rotation,
                    Attribute::Scale => scale,
                };
                stored
                    .iter_mut()
                    .zip(numbers)
                    .for_each(|(stored, number)| *stored = number);
            }
            Ok(())
        })?;
    }
    // By their bytes as characters, one for each: the module has maps of texts anyway.
    let mut known: BTreeMap<String, u64> = BTreeMap::new();
    placed.retain(|(translation, rotation, scale)| {
        let numbers = translation.iter().chain(rotation).chain(scale);
        let bytes = numbers.flat_map(|number| number.to_le_bytes());
        let key = bytes.map(char::from).collect();
        known.insert(key, 0).is_none()
    });
    let transform = |(translation, rotation, scale)| Transform::Decomposed {
        translation,
        rotation,
        scale,
    };
    Ok(placed.into_iter().map(transform).collect())
}
