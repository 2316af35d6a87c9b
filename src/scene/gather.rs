//! Document -> Scene.

use super::{Count, Placement, Scene, SceneError, inverse, orbits};
use crate::document::{Document, DocumentError, Node, Primitive, Transform};
use crate::geometry::{Seams, seams, without_fins, without_repeats, without_strays};
use crate::mesh::Mesh;
use crate::order::order_by_words;
use glam::{DAffine3, DMat4, DQuat, DVec3};
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

    /// Gathers one mesh as it is modelled, whether or not a scene shows it.
    ///
    /// # Errors
    ///
    /// As [`gather`](Self::gather).
    pub fn of_mesh(document: &Document, mesh: usize) -> Result<Scene, SceneError> {
        let placed = Placed {
            node: 0,
            mesh,
            to_world: DAffine3::IDENTITY,
        };
        Gathering::of_placed(document, vec![placed])?.weld(document)
    }

    /// The meshes with triangles that no scene shows: levels of detail (`MSFT_lod`), and what is left over.
    pub fn unshown(document: &Document) -> Vec<usize> {
        let mut is_shown = vec![false; document.meshes().len()];
        for placed in placed_nodes(document) {
            if let Some(shown) = is_shown.get_mut(placed.mesh) {
                *shown = true;
            }
        }
        let drawn = drawn_parts(document).into_iter().zip(is_shown).enumerate();
        drawn
            .filter(|(_, (parts, is_shown))| !parts.is_empty() && !is_shown)
            .map(|(mesh, _)| mesh)
            .collect()
    }

    /// What [`gather`](Self::gather) gathers, before it is welded: a mesh for each position accessor that a node shows, in world space, with
    /// the node's index.
    ///
    /// # Errors
    ///
    /// As [`gather`](Self::gather).
    pub fn pieces(document: &Document) -> Result<Vec<(usize, Mesh)>, SceneError> {
        let gathering = Gathering::of(document)?;
        let nodes = gathering.placements.iter().map(|placement| placement.node);
        let meshes = gathering.worlds.into_iter().map(|positions| Mesh {
            positions,
            triangles: Vec::new(),
        });
        let mut pieces: Vec<(usize, Mesh)> = nodes.zip(meshes).collect();
        for (placement, triangle) in gathering.triangles {
            if let Some((_, piece)) = pieces.get_mut(placement as usize) {
                piece.triangles.push(triangle);
            }
        }
        Ok(pieces)
    }
}

/// A node that shows a mesh.
pub(super) struct Placed {
    node: usize,
    pub(super) mesh: usize,
    pub(super) to_world: DAffine3,
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
pub(super) fn placed_nodes(document: &Document) -> Vec<Placed> {
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
pub(super) struct Gathering {
    placements: Vec<Placement>,
    worlds: Vec<Vec<DVec3>>,
    triangles: Vec<(u32, [u32; 3])>,
}

impl Gathering {
    fn of(document: &Document) -> Result<Gathering, SceneError> {
        Gathering::of_placed(document, placed_nodes(document))
    }

    fn of_placed(document: &Document, placed: Vec<Placed>) -> Result<Gathering, SceneError> {
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
        self.placements.push(Placement {
            node: placed.node,
            accessor,
            to_world,
            to_local: inverse(to_world.matrix3),
            vertices: vec![None; worlds.len()],
        });
        self.worlds.push(worlds);
        Ok(())
    }

    /// Whose fault it is that a corner is nowhere: the file's numbers', or the node's transform.
    fn not_finite(&self, document: &Document, (placement, element): (u32, u32)) -> SceneError {
        let (placement, element) = (placement as usize, element as usize);
        let placement = self.placements.get(placement);
        let accessor = placement.map(|placement| placement.accessor);
        let locals = accessor.and_then(|accessor| document.positions(accessor).ok());
        let is_finite = |local: &[f64; 3]| local.iter().all(|component| component.is_finite());
        match (
            accessor,
            locals.and_then(|locals| locals.get(element).map(is_finite)),
        ) {
            (Some(accessor), Some(false)) => DocumentError::NonFinitePosition {
                pointer: format!("/accessors/{accessor}"),
                element,
            }
            .into(),
            _ => SceneError::NotFinite {
                node: placement.map_or(0, |placement| placement.node),
            },
        }
    }

    fn weld(self, document: &Document) -> Result<Scene, SceneError> {
        let Joined {
            mesh,
            parts,
            strays,
            placements,
        } = self.join(&|gathering, corner| gathering.not_finite(document, corner))?;
        let admissible = orbits::admissible(document, &placements, mesh.positions.len())?;
        let mut scene = Scene {
            mesh,
            admissible,
            parts,
            strays,
            placements,
        };
        if scene.parts.is_some() {
            scene.mesh.positions = scene.positions_in(document)?;
        }
        Ok(scene)
    }

    /// Makes vertices of elements; `not_finite` says what is wrong where a corner is nowhere.
    fn join(
        mut self,
        not_finite: &dyn Fn(&Gathering, (u32, u32)) -> SceneError,
    ) -> Result<Joined, SceneError> {
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
        if let Some(&corner) = order.iter().find(|&&corner| !world(corner).is_finite()) {
            return Err(not_finite(&self, corner));
        }
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
        let triangles = self.triangles.into_iter();
        let triangles = triangles.filter_map(|(placement, triangle)| {
            let placement = self.placements.get(placement as usize)?;
            renamed(triangle, |element| placement.vertex(element))
        });
        let mut mesh = Mesh {
            triangles: triangles.collect(),
            positions,
        };
        let strays = leave_out(&mut mesh, &mut self.placements);
        let parts = close_seams(&mut mesh, &mut self.placements);
        if mesh.triangles.is_empty() {
            return Err(SceneError::NoTriangles);
        }
        Ok(Joined {
            mesh,
            parts,
            strays,
            placements: self.placements,
        })
    }

    /// A surface that is no document's, in one placement.
    pub(super) fn of_surface(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Gathering {
        Gathering {
            placements: vec![Placement {
                node: 0,
                accessor: 0,
                to_world: DAffine3::IDENTITY,
                to_local: None,
                vertices: vec![None; positions.len()],
            }],
            worlds: vec![positions.iter().copied().map(DVec3::from_array).collect()],
            triangles: triangles.iter().map(|&triangle| (0, triangle)).collect(),
        }
    }

    /// The mesh of a surface: as a document with the same elements would have it.
    pub(super) fn surface(self, positions: &[[f64; 3]]) -> Result<Mesh, SceneError> {
        let joined = self.join(&|_, (_, vertex)| SceneError::NotANumber { vertex })?;
        let mut mesh = joined.mesh;
        if joined.parts.is_some() {
            let mut is_placed = vec![false; mesh.positions.len()];
            let vertices = joined.placements.iter().flat_map(|placed| &placed.vertices);
            for (vertex, position) in vertices.zip(positions) {
                let Some(vertex) = vertex.map(|vertex| vertex as usize) else {
                    continue;
                };
                if let (Some(place), Some(flag)) =
                    (mesh.positions.get_mut(vertex), is_placed.get_mut(vertex))
                    && !std::mem::replace(flag, true)
                {
                    *place = DVec3::from_array(*position);
                }
            }
        }
        Ok(mesh)
    }
}

/// What elements are once they are joined.
struct Joined {
    mesh: Mesh,
    parts: Option<Vec<u32>>,
    strays: Vec<[DVec3; 3]>,
    placements: Vec<Placement>,
}

/// Leaves out what a person does not see as the model: triangles that are there before, fins, strays. Gives back the strays.
fn leave_out(mesh: &mut Mesh, placements: &mut [Placement]) -> Vec<[DVec3; 3]> {
    if let Some(kept) = without_repeats(mesh) {
        keep(&mut mesh.triangles, &kept);
    }
    let mut is_whole = true;
    if let Some(kept) = without_fins(mesh) {
        keep(&mut mesh.triangles, &kept);
        is_whole = false;
    }
    let mut strays = Vec::new();
    if let Some(kept) = without_strays(mesh) {
        let triangles = mesh.triangles.iter().zip(&kept);
        strays.extend(
            triangles
                .filter(|(_, kept)| !**kept)
                .map(|(&t, _)| mesh.corners(t)),
        );
        keep(&mut mesh.triangles, &kept);
        is_whole = false;
    }
    if !is_whole {
        drop_unused(mesh, placements);
    }
    strays
}

fn keep<T>(items: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    items.retain(|_| kept.next() == Some(&true));
}

/// Drops the vertices that no triangle has.
fn drop_unused(mesh: &mut Mesh, placements: &mut [Placement]) {
    let mut is_used = vec![false; mesh.positions.len()];
    for &vertex in mesh.triangles.iter().flatten() {
        if let Some(is_used) = is_used.get_mut(vertex as usize) {
            *is_used = true;
        }
    }
    let mut next = 0..;
    let names: Vec<Option<u32>> = is_used
        .iter()
        .map(|&is_used| if is_used { next.next() } else { None })
        .collect();
    let name = |vertex: u32| names.get(vertex as usize).copied().flatten();
    keep(&mut mesh.positions, &is_used);
    let triangles = mesh.triangles.iter();
    mesh.triangles = triangles.filter_map(|&t| renamed(t, name)).collect();
    for vertex in placements.iter_mut().flat_map(|p| &mut p.vertices) {
        *vertex = vertex.and_then(name);
    }
}

/// Makes one vertex of those that a person sees as one; gives back the triangles' parts as they were before, where there were any.
fn close_seams(mesh: &mut Mesh, placements: &mut [Placement]) -> Option<Vec<u32>> {
    let Seams { merged, parts } = seams(mesh);
    if merged.is_empty() {
        return None;
    }
    let mut leaders: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    for (vertex, first) in merged {
        if let Some(leader) = leaders.get_mut(vertex as usize) {
            *leader = first;
        }
    }
    // A leader is no later than its vertex, so it has its new name already.
    let mut names: Vec<u32> = Vec::with_capacity(leaders.len());
    let mut positions = Vec::new();
    for ((&leader, &position), vertex) in leaders.iter().zip(&mesh.positions).zip(0..) {
        names.push(if leader == vertex {
            positions.push(position);
            positions.len() as u32 - 1
        } else {
            names.get(leader as usize).copied().unwrap_or_default()
        });
    }
    let name = |vertex: u32| names.get(vertex as usize).copied();
    let triangles = mesh.triangles.iter().zip(parts);
    let (triangles, mut parts): (_, Vec<u32>) = triangles
        .filter_map(|(&triangle, part)| Some((renamed(triangle, name)?, part)))
        .unzip();
    mesh.triangles = triangles;
    mesh.positions = positions;
    if let Some(kept) = without_repeats(mesh) {
        keep(&mut mesh.triangles, &kept);
        keep(&mut parts, &kept);
    }
    for vertex in placements.iter_mut().flat_map(|p| &mut p.vertices) {
        *vertex = vertex.and_then(name);
    }
    Some(parts)
}

/// A triangle by other names, if they are three.
fn renamed([a, b, c]: [u32; 3], name: impl Fn(u32) -> Option<u32>) -> Option<[u32; 3]> {
    let [a, b, c] = [name(a)?, name(b)?, name(c)?];
    (a != b && b != c && c != a).then_some([a, b, c])
}

/// A position's bits, with one zero.
fn bits(position: DVec3) -> [u64; 3] {
    (position + DVec3::ZERO).to_array().map(f64::to_bits)
}
