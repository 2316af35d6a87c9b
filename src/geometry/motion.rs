//! Affine maps of space: how a copy lies on its original.

use crate::mesh::Mesh;
use glam::{DMat3, DVec3};

/// An affine map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Turn, scale, shear and reflection.
    pub linear: DMat3,
    /// Where the origin goes.
    pub translation: DVec3,
}

impl Motion {
    /// Nothing moves.
    pub const IDENTITY: Motion = Motion {
        linear: DMat3::IDENTITY,
        translation: DVec3::ZERO,
    };

    /// Where a point goes.
    pub fn of(&self, point: DVec3) -> DVec3 {
        self.linear * point + self.translation
    }

    /// Where a normal goes: the side that it shows stays that side, in a mirror image too. Not of unit length.
    pub fn of_normal(&self, normal: DVec3) -> DVec3 {
        self.linear.inverse().transpose() * normal
    }

    /// Whether a mirror image comes of it.
    pub fn is_mirrored(&self) -> bool {
        self.linear.determinant() < 0.0
    }

    /// First `before`, then this.
    pub fn after(&self, before: &Motion) -> Motion {
        Motion {
            linear: self.linear * before.linear,
            translation: self.of(before.translation),
        }
    }

    /// A mesh that is moved; its triangles are turned over in a mirror image, so that they show the side that they showed.
    pub fn of_mesh(&self, mesh: &Mesh) -> Mesh {
        let positions = mesh.positions.iter().map(|p| self.of(*p)).collect();
        let mut moved = mesh.with_positions(positions);
        if self.is_mirrored() {
            moved.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        moved
    }
}
