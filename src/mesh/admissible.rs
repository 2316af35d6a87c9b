//! Which displacements a scene can show: instances move together, fixed vertices not at all.

use glam::{DMat3, DVec3};

/// Vertices that one displacement moves, each through a linear map of its own: the instances of a shared vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// (vertex, M): a displacement `d` of the orbit moves the vertex by `M d`. Every M is invertible.
    pub members: Vec<(u32, DMat3)>,
}

/// The linear space of displacements that can be written back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Admissible {
    /// Disjoint; a vertex in none of them is free.
    pub orbits: Vec<Orbit>,
    /// Vertices that cannot move, ascending.
    pub fixed: Vec<u32>,
}

impl Admissible {
    /// Replaces V displacements by the nearest admissible ones (least squares over each orbit).
    pub fn project(&self, displacement: &mut [DVec3]) {
        for orbit in &self.orbits {
            let normal: DMat3 = orbit.members.iter().map(|(_, m)| m.transpose() * *m).sum();
            let pulled: DVec3 = orbit
                .members
                .iter()
                .map(|&(v, m)| m.transpose() * displacement[v as usize])
                .sum();
            let shared = normal.inverse() * pulled;
            for &(vertex, map) in &orbit.members {
                displacement[vertex as usize] = map * shared;
            }
        }
        for &vertex in &self.fixed {
            displacement[vertex as usize] = DVec3::ZERO;
        }
    }

    /// A number for each of V vertices, equal for those that move together.
    pub fn instances(&self, num_vertices: usize) -> Vec<u32> {
        let mut numbers: Vec<u32> = (0..num_vertices as u32).collect();
        for orbit in &self.orbits {
            for &(vertex, _) in &orbit.members {
                numbers[vertex as usize] = orbit.members[0].0;
            }
        }
        numbers
    }
}
