//! Windows that hold a mark already, for whoever moves the same surface next.

use super::cluster::clusters;
use super::lattice::{Lattice, Placement};
use super::objects::{Chosen, vertices_of};
use super::window::{Window, windows};
use crate::geometry::{Pieces, Pose, oriented};
use crate::key::Key;
use crate::mesh::Mesh;
use glam::DMat3;

/// The windows of one marked frame.
pub struct Held {
    /// In scene units.
    pub placement: Placement,
    pub windows: Vec<Window>,
    /// What they see, outwards, by the mesh's own vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Of the quantizer, in pitches.
    pub step: f64,
}

/// The windows of every frame that an embedding chose in a mesh.
pub fn held(mesh: &Mesh, key: &Key, chosen: &[Chosen]) -> Vec<Held> {
    let lattice = Lattice::of(key);
    let objects = match chosen.iter().any(|frame| frame.object.is_some()) {
        true => Pieces::stable_objects(mesh),
        false => Vec::new(),
    };
    let in_frame = |Chosen { object, choice }: &Chosen| {
        let placement = lattice.placed(DMat3::IDENTITY, choice.pitch);
        let part = match object {
            None => mesh.triangles.clone(),
            Some(number) => objects.get(*number as usize)?.to_vec(),
        };
        let vertices = vertices_of(&part);
        let (part, boundary) = oriented(&mesh.part(part));
        let pose = Pose::of_oriented(&part, &boundary)?;
        let name = |vertex: u32| vertices[vertex as usize];
        Some(Held {
            placement: Placement {
                rotation: pose.axes * placement.rotation,
                origin: pose.centre + pose.axes * placement.origin * pose.size,
                pitch: placement.pitch * pose.size,
            },
            windows: windows(&clusters(&part, &pose, choice.pitch), &placement),
            triangles: part.triangles.iter().map(|t| t.map(name)).collect(),
            step: choice.step / choice.pitch,
        })
    };
    chosen.iter().filter_map(in_frame).collect()
}
