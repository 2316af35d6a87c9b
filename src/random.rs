//! The pseudo-random stream of generated shapes and seeded attacks. Not for secrets: those come from [`crate::key`].

use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::TAU;

/// SplitMix64 (Steele, Lea and Flood 2014).
pub struct Random(u64);

impl Random {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// 64 uniform bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let x = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let x = (x ^ x >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^ x >> 31
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Nearly normal, of mean 0 and variance 1: the sum of twelve uniform numbers.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        let (z, azimuth) = (2.0 * self.unit() - 1.0, TAU * self.unit());
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * libm::cos(azimuth), radius * libm::sin(azimuth), z)
    }

    /// A rotation by a uniform angle about a uniform axis.
    pub fn rotation(&mut self) -> DMat3 {
        let (axis, half) = (self.direction(), TAU / 2.0 * self.unit());
        let vector = axis * libm::sin(half);
        DMat3::from_quat(DQuat::from_xyzw(
            vector.x,
            vector.y,
            vector.z,
            libm::cos(half),
        ))
    }

    /// The numbers below `count` in random order (Fisher and Yates).
    pub fn permutation(&mut self, count: usize) -> Vec<u32> {
        let mut order: Vec<u32> = (0..count as u32).collect();
        for last in (1..count).rev() {
            order.swap(last, (self.bits() % (last as u64 + 1)) as usize);
        }
        order
    }
}
