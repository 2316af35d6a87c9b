//! A pose.

use crate::mesh::Mesh;
use glam::{DMat3, DVec3};

/// The part of the length over which the bones share the vertices.
const JOINT: f64 = 0.3;

/// Bends a model by an angle, degrees, about a joint in the middle of its bounding box's longest axis: a skeleton of two bones, with linear
/// blend skinning and smooth weights.
pub fn bend(mesh: &Mesh, degrees: f64) -> Mesh {
    let first = mesh.positions.first().copied().unwrap_or_default();
    let positions = mesh.positions.iter();
    let (low, high) = positions.fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
    let axis = (high - low).max_position();
    let joint = low.midpoint(high);
    let length = (high - low).max_element();
    let turn = [
        DMat3::from_rotation_z,
        DMat3::from_rotation_x,
        DMat3::from_rotation_y,
    ][axis](degrees.to_radians());
    let posed = |&p: &DVec3| {
        let along = ((p - joint)[axis] / (JOINT * length) + 0.5).clamp(0.0, 1.0);
        let weight = along * along * (3.0 - 2.0 * along);
        p.lerp(joint + turn * (p - joint), weight)
    };
    if length > 0.0 {
        mesh.with_positions(mesh.positions.iter().map(posed).collect())
    } else {
        mesh.clone()
    }
}
