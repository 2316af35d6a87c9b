//! Affine maps of space: how a copy lies on its original.

use crate::mesh::Mesh;
use glam::{DMat3, DVec3};
use nalgebra::Matrix3;

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

    /// By what factors it stretches along three axes, the largest first, and by what angle it turns beside, 0 to pi; of a mirror image, after all
    /// axes were turned over. `None` where it flattens.
    pub fn stretch_and_turn(&self) -> Option<([f64; 3], f64)> {
        let sign = if self.is_mirrored() { -1.0 } else { 1.0 };
        let linear = Matrix3::from_fn(|row, column| sign * self.linear.col(column)[row]);
        let factors = linear.svd(true, true);
        let rotation = factors.u? * factors.v_t?;
        let cosine = (rotation.trace() - 1.0) / 2.0;
        let stretch = [0, 1, 2].map(|axis| factors.singular_values[axis]);
        (stretch[2] > 0.0).then(|| (stretch, libm::acos(cosine.clamp(-1.0, 1.0))))
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

#[cfg(test)]
mod tests {
    use super::{DMat3, DVec3, Motion};

    #[test]
    fn a_stretch_and_a_turn_are_told_apart() {
        let turn = DMat3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.5);
        for mirror in [1.0, -1.0] {
            let linear = mirror * turn * DMat3::from_diagonal(DVec3::new(1.5, 2.0, 0.5));
            let motion = Motion {
                linear,
                ..Motion::IDENTITY
            };
            let (stretch, angle) = motion.stretch_and_turn().expect("it flattens nothing");
            let error = DVec3::from_array(stretch) - DVec3::new(2.0, 1.5, 0.5);
            assert!(
                error.length() < 1e-12 && (angle - 0.5).abs() < 1e-12,
                "{stretch:?} {angle}"
            );
        }
    }
}
