//! What an embedder of notes and a detector agree on, and embedding.

use super::sphere::Sphere;
use crate::carrier::CarrierError;
use crate::carrier::qim::quantize;
use crate::code::Block;
use crate::geometry::Pose;
use crate::key::{Key, unit};
use crate::mesh::Mesh;
use crate::order::order_by;
use glam::DVec3;

/// Cells of a bit.
const REPETITIONS: usize = 5;

/// Vertices that a bit needs to stand more than rounding.
const VERTICES_PER_BIT: usize = 16;

/// What embedder and detector agree on.
pub struct Cells {
    pub(super) block: Block,
    /// Of the quantizers, in units of the frame.
    pub(super) step: f64,
    pub(super) sphere: Sphere,
    /// The bit of each cell.
    pub(super) bits: Vec<u32>,
    /// The dither of each cell, in steps.
    pub(super) dithers: Vec<f64>,
}

/// A vertex in the frame.
pub(super) struct Ray {
    /// Distance from the centroid, in units of the frame.
    pub(super) radius: f64,
    pub(super) direction: DVec3,
}

impl Ray {
    pub(super) fn new(point: DVec3) -> Ray {
        Ray {
            radius: point.length(),
            direction: point.normalize_or(DVec3::Z),
        }
    }
}

impl Cells {
    /// The cells of a key for a code, and a step in units of the frame.
    pub fn new(key: &Key, block: Block, step: f64) -> Cells {
        let count = REPETITIONS * block.code_bits();
        let address = |cell: usize| ((count as u64) << 32) | cell as u64;
        let (places, dithers) = (key.prf("cells/place"), key.prf("cells/dither"));
        let shuffled = order_by((0..count).map(|cell| places.at(address(cell)).0));
        let mut bits = vec![0; count];
        for (place, &(_, cell)) in shuffled.iter().enumerate() {
            bits[cell as usize] = (place / REPETITIONS) as u32;
        }
        let dither = |cell| unit(dithers.at(address(cell)).0);
        Cells {
            block,
            step,
            sphere: Sphere::new(count),
            bits,
            dithers: (0..count).map(dither).collect(),
        }
    }

    /// Vertices that a block needs.
    pub fn num_vertices(block: Block) -> usize {
        VERTICES_PER_BIT * block.code_bits()
    }

    /// The longest block that a number of vertices carries.
    pub fn capacity(num_vertices: usize) -> Option<Block> {
        let fits = |block: &Block| Cells::num_vertices(*block) <= num_vertices;
        Block::ALL.into_iter().rev().find(fits)
    }

    /// The displacement of all V vertices that writes a message.
    pub fn embed(&self, mesh: &Mesh, message: &[u8]) -> Result<Vec<DVec3>, CarrierError> {
        let pose = Pose::of_surface(mesh).ok_or(CarrierError::TooFewHosts {
            needed: Cells::num_vertices(self.block),
            available: 0,
        })?;
        let word = self.block.encode(message);
        let displacement = |&position: &DVec3| {
            let ray = Ray::new(pose.canonical(position));
            let (cell, _) = self.sphere.cell(ray.direction);
            let dither = self.dithers[cell] * self.step;
            let bit = word[self.bits[cell] as usize];
            let radius = quantize(ray.radius - dither, bit, self.step) + dither;
            pose.axes * ray.direction * ((radius - ray.radius) * pose.size)
        };
        Ok(mesh.positions.iter().map(displacement).collect())
    }
}
