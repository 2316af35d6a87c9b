//! Points that stand for a surface.

use crate::geometry::scatter::scattered;
use crate::mesh::Mesh;
use glam::{DMat3, DVec3};

/// Points of a surface with their normals.
pub struct Points {
    pub positions: Vec<DVec3>,
    pub normals: Vec<DVec3>,
}

impl Points {
    /// So many, strewn by a seed.
    pub fn of(mesh: &Mesh, count: usize, seed: u64) -> Points {
        let (positions, normals) = scattered(mesh, count, seed)
            .into_iter()
            .map(|point| {
                let [a, b, c] = mesh.corners(mesh.triangles[point.triangle as usize]);
                (point.position, (b - a).cross(c - a).normalize_or_zero())
            })
            .unzip();
        Points { positions, normals }
    }

    /// Every so many-th of them.
    pub fn fewer(&self, count: usize) -> Points {
        let step = (self.positions.len() / count.max(1)).max(1);
        let few = |all: &[DVec3]| all.iter().step_by(step).copied().collect();
        Points {
            positions: few(&self.positions),
            normals: few(&self.normals),
        }
    }

    /// Their mirror image.
    pub fn mirrored(&self) -> Points {
        let mirror = |all: &[DVec3]| all.iter().map(|p| MIRROR * *p).collect();
        Points {
            positions: mirror(&self.positions),
            normals: mirror(&self.normals),
        }
    }
}

/// A mirror.
pub const MIRROR: DMat3 = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
