//! What a surface's frame leaves open: axes whose spreads are near each other may change places, or lie anywhere.

use crate::geometry::Pose;
use crate::mesh::Mesh;
use glam::{DMat3, DVec3};

/// How well two successive axes of a frame are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axes {
    /// By their spreads.
    Distinct,
    /// Hardly: an attack may have changed their places.
    Exchangeable,
    /// Not at all: they may lie anywhere in their plane.
    Undetermined,
}

/// The first and the second axis; the second and the third.
pub fn axes_of(pose: &Pose) -> [Axes; 2] {
    let apart = |larger: f64, smaller: f64| match smaller / larger {
        ratio if ratio > 0.9 => Axes::Undetermined,
        ratio if ratio > 0.85 => Axes::Exchangeable,
        _ => Axes::Distinct,
    };
    let [x, y, z] = pose.spreads.to_array();
    [apart(x, y), apart(y, z)]
}

/// Whether every axis is told apart from the others.
pub fn is_determined(pose: &Pose) -> bool {
    !axes_of(pose).contains(&Axes::Undetermined)
}

/// Whether a surface has a frame in which every axis is told apart.
pub fn has_axes(mesh: &Mesh) -> bool {
    Pose::of_surface(mesh).is_some_and(|pose| is_determined(&pose))
}

/// The rotations that take a frame into itself: 4 if its axes are known but for their signs, else 24.
pub fn turns(near: bool) -> Vec<DMat3> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut turns = Vec::new();
    for (first, second) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
        for (a, b) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let (x, y) = (axes[first] * a, axes[second] * b);
            turns.push(DMat3::from_cols(x, y, x.cross(y)));
        }
        if !near {
            break;
        }
    }
    turns
}
