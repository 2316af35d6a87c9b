//! Angles across edges.

use crate::mesh::{Edges, Mesh};
use glam::DVec3;

/// How far a surface turns at an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dihedral {
    /// The edge's vertices, the lower first.
    pub ends: [u32; 2],
    /// The angle between the normals of its faces, -pi to pi: positive at a ridge, negative in a furrow, 0 where the surface is
    /// flat. (The angle inside the surface is pi less this.)
    pub angle: f64,
}

/// The angles at all edges with two faces, in rising order of the edges. The mesh has to be consistently wound; `areas` are its
/// [`face_areas`](super::face_areas). O(F).
pub fn dihedrals(mesh: &Mesh, edges: &Edges, areas: &[DVec3]) -> Vec<Dihedral> {
    let dihedral = |pair: crate::mesh::Pair| {
        let [a, b] = pair.faces.map(|face| areas[face as usize]);
        let apex: DVec3 = mesh
            .corners(mesh.triangles[pair.faces[1] as usize])
            .iter()
            .sum();
        let below = apex - mesh.positions[pair.ends[0] as usize] * 3.0;
        let angle = libm::atan2(a.cross(b).length(), a.dot(b));
        Dihedral {
            ends: pair.ends,
            angle: if below.dot(a) > 0.0 { -angle } else { angle },
        }
    };
    edges.pairs().map(dihedral).collect()
}
