//! What is seen of a movement: parts that lose their shape, triangles that turn.

use super::Parts;
use super::facet::{Facet, twice_area};
use crate::mesh::Mesh;
use glam::DVec3;

/// How a movement of its vertices deforms a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deformation {
    /// Of all parts that hang together by edges: the farthest that a vertex went from where its part's mean movement would have
    /// taken it, as a fraction of the part's own diagonal.
    pub worst_part: f64,
    /// The largest angle, in degrees, by which a triangle turned that is no sliver.
    pub worst_turn: f64,
    /// Triangles that turned by more than a right angle, slivers too.
    pub num_turned_over: usize,
}

impl Deformation {
    /// Compares a mesh with itself after its V vertices went to other positions.
    pub fn between(mesh: &Mesh, parts: &Parts, after: &[DVec3]) -> Deformation {
        let mut deformation = Deformation {
            worst_part: worst_part(mesh, parts, after),
            ..Deformation::default()
        };
        for (&triangle, &part) in mesh.triangles.iter().zip(&parts.of_triangles) {
            let corners = mesh.corners(triangle);
            let facet = Facet::of(corners, parts.diagonals[part as usize]);
            if facet == Facet::Flat {
                continue;
            }
            let before = twice_area(corners);
            let after = twice_area(triangle.map(|v| after[v as usize]));
            let turn = libm::atan2(before.cross(after).length(), before.dot(after)).to_degrees();
            deformation.num_turned_over += usize::from(turn > 90.0);
            if facet == Facet::Plain {
                deformation.worst_turn = deformation.worst_turn.max(turn);
            }
        }
        deformation
    }
}

fn worst_part(mesh: &Mesh, parts: &Parts, after: &[DVec3]) -> f64 {
    // Each corner counts, so a vertex as often as it has triangles: the mean moves with the surface.
    let mut sums = vec![(DVec3::ZERO, 0.0); parts.diagonals.len()];
    let moves = || {
        let triangles = mesh.triangles.iter().zip(&parts.of_triangles);
        triangles.flat_map(|(triangle, &part)| {
            triangle.map(|v| {
                (
                    part as usize,
                    after[v as usize] - mesh.positions[v as usize],
                )
            })
        })
    };
    for (part, movement) in moves() {
        let (sum, number) = &mut sums[part];
        *sum += movement;
        *number += 1.0;
    }
    moves()
        .map(|(part, movement)| {
            let (sum, number) = sums[part];
            movement.distance(sum / number) / parts.diagonals[part]
        })
        .fold(0.0, f64::max)
}
