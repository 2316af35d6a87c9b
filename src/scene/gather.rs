//! Document -> Scene.

use super::{MAX_ELEMENTS, Placement, Scene, SceneError, orbits};
use crate::document::{Document, Node, Transform};
use crate::mesh::Mesh;
use crate::order::order_by_words;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use std::collections::BTreeMap;

impl Scene {
    /// Gathers all triangles that a document's scenes show. O(n log n) in the number of elements.
    pub fn gather(document: &Document) -> Result<Scene, SceneError> {
        let mut gathering = Gathering::default();
        for (node, to_world) in placed_nodes(document) {
            gathering.add(document, node, to_world)?;
        }
        gathering.weld(document)
    }
}

/// Every node that shows a mesh, with its transform to world space: depth first, in the document's order.
fn placed_nodes(document: &Document) -> Vec<(usize, DAffine3)> {
    let nodes = document.nodes();
    let mut placed = Vec::new();
    let mut open: Vec<(usize, DAffine3)> = document
        .roots()
        .iter()
        .rev()
        .map(|&root| (root, DAffine3::IDENTITY))
        .collect();
    while let Some((index, parent)) = open.pop() {
        let Some(node) = nodes.get(index) else {
            continue;
        };
        let to_world = parent * local_transform(node);
        if node.mesh.is_some() {
            placed.push((
                index,
                if node.skin.is_some() {
                    DAffine3::IDENTITY
                } else {
                    to_world
                },
            ));
        }
        open.extend(node.children.iter().rev().map(|&child| (child, to_world)));
    }
    placed
}

fn local_transform(node: &Node) -> DAffine3 {
    match node.transform {
        Transform::Matrix(matrix) => DAffine3::from_mat4(DMat4::from_cols_array(&matrix)),
        Transform::Decomposed {
            translation,
            rotation,
            scale,
        } => DAffine3::from_scale_rotation_translation(
            DVec3::from_array(scale),
            DQuat::from_array(rotation),
            DVec3::from_array(translation),
        ),
    }
}

/// Placements and triangles before welding. A corner is (placement, element).
#[derive(Default)]
struct Gathering {
    placements: Vec<Placement>,
    worlds: Vec<Vec<DVec3>>,
    triangles: Vec<(usize, [u32; 3])>,
}

impl Gathering {
    fn add(
        &mut self,
        document: &Document,
        node: usize,
        to_world: DAffine3,
    ) -> Result<(), SceneError> {
        let Some(mesh_index) = document.nodes().get(node).and_then(|node| node.mesh) else {
            return Ok(());
        };
        let Some(mesh) = document.meshes().get(mesh_index) else {
            return Ok(());
        };
        let turn = to_world.matrix3.determinant() < 0.0;
        let mut by_accessor = BTreeMap::new();
        for (primitive_index, primitive) in mesh.primitives.iter().enumerate() {
            let Some(accessor) = primitive.position else {
                continue;
            };
            let triangles = document.triangles(mesh_index, primitive_index)?;
            if triangles.is_empty() {
                continue;
            }
            let placement = match by_accessor.get(&accessor) {
                Some(&placement) => placement,
                None => {
                    by_accessor.insert(accessor, self.placements.len());
                    self.place(document, node, accessor, to_world)?
                }
            };
            self.triangles.extend(
                triangles
                    .into_iter()
                    .map(|[a, b, c]| (placement, if turn { [a, c, b] } else { [a, b, c] })),
            );
        }
        Ok(())
    }

    fn place(
        &mut self,
        document: &Document,
        node: usize,
        accessor: usize,
        to_world: DAffine3,
    ) -> Result<usize, SceneError> {
        let locals = document.positions(accessor)?;
        let num_elements: usize = self.worlds.iter().map(Vec::len).sum();
        if num_elements.saturating_add(locals.len()) > MAX_ELEMENTS {
            return Err(SceneError::TooLarge);
        }
        let worlds: Vec<DVec3> = locals
            .into_iter()
            .map(|p| to_world.transform_point3(DVec3::from_array(p)))
            .collect();
        if !worlds.iter().all(|world| world.is_finite()) {
            return Err(SceneError::NotFinite { node });
        }
        self.placements.push(Placement {
            accessor,
            to_world,
            to_local: inverse(to_world.matrix3),
            vertices: vec![None; worlds.len()],
        });
        self.worlds.push(worlds);
        Ok(self.placements.len() - 1)
    }

    fn weld(mut self, document: &Document) -> Result<Scene, SceneError> {
        let corners = || {
            self.triangles
                .iter()
                .flat_map(|&(placement, triangle)| triangle.map(|element| (placement, element)))
        };
        let world = |(placement, element): (usize, u32)| {
            self.worlds
                .get(placement)
                .and_then(|worlds| worlds.get(element as usize))
                .copied()
                .unwrap_or_default()
        };
        // Corners that name the same element are the same; the others weld by position.
        let mut used: Vec<Vec<bool>> = self
            .worlds
            .iter()
            .map(|worlds| vec![false; worlds.len()])
            .collect();
        let mut order = Vec::new();
        for corner in corners() {
            let seen = used
                .get_mut(corner.0)
                .and_then(|used| used.get_mut(corner.1 as usize));
            if seen.is_some_and(|seen| !std::mem::replace(seen, true)) {
                order.push(corner);
            }
        }
        let places: Vec<[u64; 3]> = order.iter().map(|&corner| bits(world(corner))).collect();
        let place = |corner: u32| places.get(corner as usize);
        let mut first = vec![0; order.len()];
        for group in order_by_words(&places).chunk_by(|&a, &b| place(a) == place(b)) {
            for &corner in group {
                if let (Some(slot), Some(leader)) = (first.get_mut(corner as usize), group.first())
                {
                    *slot = *leader as usize;
                }
            }
        }

        let mut positions = Vec::new();
        let mut vertices: Vec<u32> = Vec::with_capacity(order.len());
        for (&(placement, element), (corner, &leader)) in order.iter().zip(first.iter().enumerate())
        {
            let vertex = if leader == corner {
                positions.push(world((placement, element)));
                (positions.len() - 1) as u32
            } else {
                vertices.get(leader).copied().unwrap_or_default()
            };
            vertices.push(vertex);
        }
        for (&(placement, element), &vertex) in order.iter().zip(&vertices) {
            let slot = self
                .placements
                .get_mut(placement)
                .and_then(|p| p.vertices.get_mut(element as usize));
            if let Some(slot) = slot {
                *slot = Some(vertex);
            }
        }
        let triangles: Vec<[u32; 3]> = self
            .triangles
            .iter()
            .filter_map(|corners| welded(&self.placements, corners))
            .collect();
        if triangles.is_empty() {
            return Err(SceneError::NoTriangles);
        }
        let admissible = orbits::admissible(document, &self.placements, positions.len())?;
        Ok(Scene {
            mesh: Mesh {
                positions,
                triangles,
            },
            admissible,
            placements: self.placements,
        })
    }
}

/// The triangle's vertices, if they are three.
fn welded(
    placements: &[Placement],
    &(placement, triangle): &(usize, [u32; 3]),
) -> Option<[u32; 3]> {
    let vertex = |element: u32| *placements.get(placement)?.vertices.get(element as usize)?;
    let [a, b, c] = [
        vertex(triangle[0])?,
        vertex(triangle[1])?,
        vertex(triangle[2])?,
    ];
    (a != b && b != c && c != a).then_some([a, b, c])
}

/// A position's bits, with one zero.
fn bits(position: DVec3) -> [u64; 3] {
    (position + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// The inverse of a matrix that has a usable one.
fn inverse(matrix: DMat3) -> Option<DMat3> {
    let scale = matrix
        .to_cols_array()
        .iter()
        .fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    let inverse = matrix.inverse();
    (matrix.determinant().abs() > 1e-12 * scale * scale * scale && inverse.is_finite())
        .then_some(inverse)
}
