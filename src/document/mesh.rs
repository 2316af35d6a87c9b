//! Meshes and the triangles of their primitives (glTF 2.0 specification section 3.7.2).

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::Mode;

use super::accessor::{Accessor, bytes_at, is_index, unsigned};
use super::buffer::Storage;
use super::json::escaped;
use super::schema::{self, Root};
use super::{DocumentError, item};

/// The most elements of all accessors together that are stored nowhere, so that no data bounds their number. They are all the
/// origin, or the first vertex: no model needs them, and a legal one has some under a sparse accessor.
pub const MAX_UNBACKED: u64 = 1 << 20;

/// The most positions of all accessors together, each accessor counted once: every one of them is looked at when a document is
/// read and written, and many accessors may share the same bytes. Four times what the largest scene shows.
const MAX_POSITIONS: u64 = 1 << 26;

/// A set of primitives, placed by nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// The parts of the mesh.
    pub primitives: Vec<Primitive>,
}

/// A part of a mesh that is drawn at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Primitive {
    /// The accessor of the vertex positions. A primitive without is not drawn.
    pub position: Option<usize>,
    /// What the vertices form.
    pub mode: Mode,
    /// The accessor of the vertex indices.
    pub indices: Option<usize>,
    /// Whether the primitive has morph targets, whose displacements add to the positions.
    pub has_morph_targets: bool,
}

/// The meshes of the file.
pub(super) fn read(root: &Root, accessors: &[Accessor]) -> Result<Vec<Mesh>, DocumentError> {
    let mut allowance = Allowance::new(accessors.len());
    let meshes = root.meshes.iter().enumerate().map(|(index, mesh)| {
        let primitives = mesh.primitives.iter().enumerate().map(|(part, primitive)| {
            read_primitive(
                primitive,
                accessors,
                &mut allowance,
                &format!("/meshes/{index}/primitives/{part}"),
            )
        });
        Ok(Mesh {
            primitives: primitives.collect::<Result<_, _>>()?,
        })
    });
    meshes.collect()
}

fn read_primitive(
    primitive: &schema::Primitive,
    accessors: &[Accessor],
    allowance: &mut Allowance,
    pointer: &str,
) -> Result<Primitive, DocumentError> {
    let accessor = |index: u64, property: &str| {
        item(
            accessors,
            index,
            "accessors",
            format_args!("{pointer}/{property}"),
        )
        .map(|(_, accessor)| accessor)
    };
    for (target, attributes) in primitive.targets.iter().enumerate() {
        for (name, &index) in attributes {
            accessor(index, &format!("targets/{target}/{}", escaped(name)))?;
        }
    }
    let mut position = None;
    for (name, &index) in &primitive.attributes {
        let accessor = accessor(index, &format!("attributes/{}", escaped(name)))?;
        if name == "POSITION" {
            check_position(accessor)?;
            allowance.take(accessor, true)?;
            position = Some(accessor.index);
        }
    }
    let indices = match primitive.indices {
        Some(index) => {
            let indices = accessor(index, "indices")?;
            check_indices(indices)?;
            allowance.take(indices, false)?;
            Some(indices.index)
        }
        None => None,
    };
    Ok(Primitive {
        position,
        mode: primitive.mode,
        indices,
        has_morph_targets: !primitive.targets.is_empty(),
    })
}

fn check_position(accessor: &Accessor) -> Result<(), DocumentError> {
    if accessor.kind != Type::Vec3 || !accessor.format.is_position() {
        return Err(DocumentError::BadAccessor {
            pointer: accessor.pointer(),
            detail: "positions must have three components that are floats or 8- or 16-bit integers"
                .into(),
        });
    }
    Ok(())
}

fn check_indices(accessor: &Accessor) -> Result<(), DocumentError> {
    if accessor.kind != Type::Scalar || !is_index(accessor.format.component) {
        return Err(DocumentError::BadAccessor {
            pointer: accessor.pointer(),
            detail: "vertex indices must be unsigned integers".into(),
        });
    }
    Ok(())
}

/// What the accessors of positions and indices have taken of what all of them may have together.
struct Allowance {
    is_taken: Vec<bool>,
    positions: u64,
    unbacked: u64,
}

impl Allowance {
    fn new(num_accessors: usize) -> Self {
        Self {
            is_taken: vec![false; num_accessors],
            positions: 0,
            unbacked: 0,
        }
    }

    /// Counts an accessor, unless it was counted before.
    fn take(&mut self, accessor: &Accessor, is_position: bool) -> Result<(), DocumentError> {
        let taken = self.is_taken.get_mut(accessor.index);
        if taken.is_none_or(|taken| std::mem::replace(taken, true)) {
            return Ok(());
        }
        let positions = if is_position { accessor.count } else { 0 };
        self.positions = self.positions.saturating_add(positions as u64);
        let unbacked = accessor.num_unbacked() as u64;
        self.unbacked = self.unbacked.saturating_add(unbacked);
        let counts = [
            (
                "the number of vertices and indices without data, all accessors together,",
                self.unbacked,
                MAX_UNBACKED,
            ),
            (
                "the number of vertices of all accessors together",
                self.positions,
                MAX_POSITIONS,
            ),
        ];
        match counts.into_iter().find(|(_, value, limit)| value > limit) {
            Some((what, value, limit)) => Err(DocumentError::TooLarge {
                what,
                value,
                limit,
                pointer: Some(format!("{}/count", accessor.pointer())),
            }),
            None => Ok(()),
        }
    }
}

/// The number of triangles of a primitive, degenerate ones included; nothing is read for it.
pub(super) fn num_triangles(primitive: &Primitive, accessors: &[Accessor]) -> usize {
    let position = primitive.position.and_then(|index| accessors.get(index));
    let indices = primitive.indices.and_then(|index| accessors.get(index));
    let corners = match (position, indices) {
        (None, _) => 0,
        (Some(_), Some(indices)) => indices.count,
        (Some(position), None) => position.count,
    };
    match primitive.mode {
        Mode::Triangles => corners.checked_div(3).unwrap_or(0),
        Mode::TriangleStrip | Mode::TriangleFan => corners.saturating_sub(2),
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => 0,
    }
}

/// The triangles of a primitive as vertex indices, each below the number of vertices.
pub(super) fn triangles(
    primitive: &Primitive,
    accessors: &[Accessor],
    storages: &[Storage],
    pointer: &str,
) -> Result<Vec<[u32; 3]>, DocumentError> {
    let is_surface = matches!(
        primitive.mode,
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
    );
    let Some(position) = primitive
        .position
        .filter(|_| is_surface)
        .and_then(|index| accessors.get(index))
    else {
        return Ok(Vec::new());
    };
    let corners = match primitive.indices.and_then(|index| accessors.get(index)) {
        Some(indices) => {
            let is_list = primitive.mode == Mode::Triangles;
            indexed_corners(indices, position.count, is_list, storages, pointer)?
        }
        None => {
            let count = u32::try_from(position.count).map_err(|_| DocumentError::TooLarge {
                what: "the number of vertices",
                value: position.count as u64,
                limit: u64::from(u32::MAX),
                pointer: Some(format!("{}/count", position.pointer())),
            })?;
            (0..count).collect()
        }
    };
    Ok(assemble(primitive.mode, &corners))
}

/// The vertices that indices name. The largest value of their type ends a strip in some renderers, so glTF forbids it; older exporters
/// wrote it into lists, where every loader takes it for the vertex that it is.
fn indexed_corners(
    indices: &Accessor,
    count: usize,
    is_list: bool,
    storages: &[Storage],
    pointer: &str,
) -> Result<Vec<u32>, DocumentError> {
    let component = indices.format.component;
    let restart = match component {
        ComponentType::U8 => u32::from(u8::MAX),
        ComponentType::U16 => u32::from(u16::MAX),
        _ => u32::MAX,
    };
    let pointer = || format!("{pointer}/indices");
    let corner = |slot: Option<_>| {
        let bytes = slot.and_then(|slot| bytes_at(storages, slot, component.size()));
        let vertex = bytes
            .and_then(|bytes| unsigned(component, bytes))
            .unwrap_or(0);
        let is_vertex = u64::from(vertex) < count as u64;
        if vertex == restart && !(is_list && is_vertex) {
            return Err(DocumentError::PrimitiveRestart {
                pointer: pointer(),
                value: vertex,
            });
        }
        if !is_vertex {
            return Err(DocumentError::BadVertex {
                pointer: pointer(),
                vertex,
                count,
            });
        }
        Ok(vertex)
    };
    indices.each(storages, |_, slot| corner(slot))
}

/// Triangles in the winding of the specification; vertices left over form none.
fn assemble(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    let windows = corners
        .windows(3)
        .filter_map(|window| window.first_chunk::<3>());
    match mode {
        Mode::Triangles => corners.as_chunks().0.to_vec(),
        Mode::TriangleStrip => windows
            .enumerate()
            .map(|(place, &[a, b, c])| {
                if place.is_multiple_of(2) {
                    [a, b, c]
                } else {
                    [a, c, b]
                }
            })
            .collect(),
        Mode::TriangleFan => match corners.split_first() {
            Some((&hub, rim)) => rim
                .windows(2)
                .filter_map(|window| window.first_chunk())
                .map(|&[b, c]| [b, c, hub])
                .collect(),
            None => Vec::new(),
        },
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
    }
}
