//! Document -> Scene.

use super::{Count, Placement, Scene, SceneError, orbits};
use crate::document::{Document, Node, Primitive, Transform};
use crate::mesh::Mesh;
use crate::order::order_by_words;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use std::collections::BTreeMap;

impl Scene {
    /// Gathers all triangles that a document's scenes show. O(n log n) in the number of elements and triangles.
    ///
    /// # Errors
    ///
    /// [`SceneError::TooLarge`] before anything is loaded, if the scene is beyond the limits that [`Count::check`] knows; the others
    /// of [`SceneError`] after that.
    pub fn gather(document: &Document) -> Result<Scene, SceneError> {
        Gathering::of(document)?.weld(document)
    }

    /// What [`gather`](Self::gather) gathers, before it is welded: a mesh for each position accessor that a node shows, in world space.
    ///
    /// # Errors
    ///
    /// As [`gather`](Self::gather).
    pub fn pieces(document: &Document) -> Result<Vec<Mesh>, SceneError> {
        let gathering = Gathering::of(document)?;
        let mut pieces: Vec<Mesh> = gathering
            .worlds
            .into_iter()
            .map(|positions| Mesh {
                positions,
                triangles: Vec::new(),
            })
            .collect();
        for (placement, triangle) in gathering.triangles {
            if let Some(piece) = pieces.get_mut(placement as usize) {
                piece.triangles.push(triangle);
            }
        }
        Ok(pieces)
    }
}

/// A node that shows a mesh.
struct Placed {
    node: usize,
    mesh: usize,
    to_world: DAffine3,
}

/// A primitive with triangles.
struct Part {
    primitive: usize,
    /// Of its positions.
    accessor: usize,
}

/// The primitives of each mesh that have triangles: nodes pass over the others, which may be many, together.
fn drawn_parts(document: &Document) -> Vec<Vec<Part>> {
    let drawn = |(mesh, primitives): (usize, &[Primitive])| {
        let primitives = primitives.iter().enumerate();
        let parts = primitives.filter_map(|(index, primitive)| {
            (document.num_triangles(mesh, index) > 0).then_some(Part {
                primitive: index,
                accessor: primitive.position?,
            })
        });
        parts.collect()
    };
    let meshes = document.meshes().iter();
    let primitives = meshes.map(|mesh| mesh.primitives.as_slice());
    primitives.enumerate().map(drawn).collect()
}

/// Every node that shows a mesh, with its transform to world space: depth first, in the document's order.
fn placed_nodes(document: &Document) -> Vec<Placed> {
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
        if let Some(mesh) = node.mesh {
            placed.push(Placed {
                node: index,
                mesh,
                to_world: if node.skin.is_some() {
                    DAffine3::IDENTITY
                } else {
                    to_world
                },
            });
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
struct Gathering {
    placements: Vec<Placement>,
    worlds: Vec<Vec<DVec3>>,
    triangles: Vec<(u32, [u32; 3])>,
}

impl Gathering {
    fn of(document: &Document) -> Result<Gathering, SceneError> {
        let placed = placed_nodes(document);
        let count = Count::new(document, placed.iter().map(|placed| placed.mesh))?;
        count.check()?;
        let drawn = drawn_parts(document);
        let mut gathering = Gathering::with_room_for(&count);
        for placed in placed {
            let parts = drawn.get(placed.mesh).map_or(&[][..], Vec::as_slice);
            gathering.add(document, &placed, parts)?;
        }
        Ok(gathering)
    }

    /// The count was checked: nothing here is larger than a u32.
    fn with_room_for(count: &Count) -> Gathering {
        Gathering {
            placements: Vec::new(),
            worlds: Vec::new(),
            triangles: Vec::with_capacity(count.triangles as usize),
        }
    }

    fn add(
        &mut self,
        document: &Document,
        placed: &Placed,
        parts: &[Part],
    ) -> Result<(), SceneError> {
        let turn = placed.to_world.matrix3.determinant() < 0.0;
        let mut by_accessor = BTreeMap::new();
        for &Part {
            primitive,
            accessor,
        } in parts
        {
            let triangles = document.triangles(placed.mesh, primitive)?;
            let placement = match by_accessor.get(&accessor) {
                Some(&placement) => placement,
                None => {
                    let placement = self.placements.len() as u32;
                    by_accessor.insert(accessor, placement);
                    self.place(document, placed, accessor)?;
                    placement
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
        placed: &Placed,
        accessor: usize,
    ) -> Result<(), SceneError> {
        let to_world = placed.to_world;
        let worlds: Vec<DVec3> = document
            .positions(accessor)?
            .into_iter()
            .map(|p| to_world.transform_point3(DVec3::from_array(p)))
            .collect();
        if !worlds.iter().all(|world| world.is_finite()) {
            return Err(SceneError::NotFinite { node: placed.node });
        }
        self.placements.push(Placement {
            accessor,
            to_world,
            to_local: inverse(to_world.matrix3),
            vertices: vec![None; worlds.len()],
        });
        self.worlds.push(worlds);
        Ok(())
    }

    fn weld(mut self, document: &Document) -> Result<Scene, SceneError> {
        let corners = || {
            self.triangles
                .iter()
                .flat_map(|&(placement, triangle)| triangle.map(|element| (placement, element)))
        };
        let world = |(placement, element): (u32, u32)| {
            self.worlds
                .get(placement as usize)
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
                .get_mut(corner.0 as usize)
                .and_then(|used| used.get_mut(corner.1 as usize));
            if seen.is_some_and(|seen| !std::mem::replace(seen, true)) {
                order.push(corner);
            }
        }
        // What is done with makes room: a scene at the limits has 2^24 elements.
        drop(used);
        let places: Vec<[u64; 3]> = order.iter().map(|&corner| bits(world(corner))).collect();
        let place = |corner: u32| places.get(corner as usize);
        let mut first: Vec<u32> = vec![0; order.len()];
        for group in order_by_words(&places).chunk_by(|&a, &b| place(a) == place(b)) {
            for &corner in group {
                if let (Some(slot), Some(leader)) = (first.get_mut(corner as usize), group.first())
                {
                    *slot = *leader;
                }
            }
        }

        drop(places);

        let mut positions = Vec::new();
        let mut vertices: Vec<u32> = Vec::with_capacity(order.len());
        for (&element, (corner, &leader)) in order.iter().zip((0..).zip(&first)) {
            let vertex = if leader == corner {
                positions.push(world(element));
                (positions.len() - 1) as u32
            } else {
                vertices.get(leader as usize).copied().unwrap_or_default()
            };
            vertices.push(vertex);
        }
        for (&(placement, element), &vertex) in order.iter().zip(&vertices) {
            let slot = self
                .placements
                .get_mut(placement as usize)
                .and_then(|p| p.vertices.get_mut(element as usize));
            if let Some(slot) = slot {
                *slot = Some(vertex);
            }
        }
        drop((order, first, vertices, self.worlds));
        let triangles: Vec<[u32; 3]> = self
            .triangles
            .into_iter()
            .filter_map(|(placement, triangle)| {
                welded(self.placements.get(placement as usize)?, triangle)
            })
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
fn welded(placement: &Placement, [a, b, c]: [u32; 3]) -> Option<[u32; 3]> {
    let vertex = |element: u32| *placement.vertices.get(element as usize)?;
    let [a, b, c] = [vertex(a)?, vertex(b)?, vertex(c)?];
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
