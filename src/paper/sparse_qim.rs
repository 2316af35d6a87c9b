//! Sparse quantization index modulation: equations 5 to 7 of Vasic 2012, with a keyed projection and a keyed dither, and soft
//! output.

use crate::carrier::qim::quantize;
use crate::key::{Key, Prf, unit};
use std::f64::consts::TAU;

/// Standard deviation of what disturbs a projection, in steps: about that of a smoothing that still can be read through.
const DISTURBANCE: f64 = 0.2;

/// Spreads each symbol over L elements of a vector, by a unit vector that the key chooses for that symbol.
pub struct SparseQim {
    projections: Prf,
    dithers: Prf,
    elements: usize,
    step: f64,
}

impl SparseQim {
    /// Quantizers with a step for symbols of `elements` elements; both in the elements' unit.
    pub fn new(key: &Key, elements: usize, step: f64) -> SparseQim {
        SparseQim {
            projections: key.prf("osveta/projection"),
            dithers: key.prf("osveta/dither"),
            elements,
            step,
        }
    }

    /// Eq. 6: `y = x + (Q_u(x.p) - x.p) p` for the elements of a symbol that is to hold a bit.
    pub fn embed(&self, x: &[f64], symbol: usize, bit: bool) -> Vec<f64> {
        let p = self.projection(symbol);
        let projected = dot(x, &p);
        let dither = self.dither(symbol);
        let moved = quantize(projected - dither, bit, self.step) + dither - projected;
        x.iter().zip(&p).map(|(x, p)| x + moved * p).collect()
    }

    /// Eq. 7, softly: `ln P(0) / P(1)` of a symbol whose elements were received as `r`, under Gaussian disturbance. Its sign is
    /// the bit with the nearest point: negative for a 1.
    pub fn evidence(&self, r: &[f64], symbol: usize) -> f64 {
        let projected = dot(r, &self.projection(symbol)) - self.dither(symbol);
        let [zero, one] = [false, true].map(|bit| {
            let error = (projected - quantize(projected, bit, self.step)) / self.step;
            error * error
        });
        (one - zero) / (2.0 * DISTURBANCE * DISTURBANCE)
    }

    /// The unit vector p of a symbol: independent normal numbers (Box and Muller 1958), brought to length 1.
    fn projection(&self, symbol: usize) -> Vec<f64> {
        let normal = |element: usize| {
            let address = symbol * self.elements + element;
            let (a, b) = self.projections.at(address as u64);
            let radius = (-2.0 * libm::log(1.0 - unit(a))).sqrt();
            radius * libm::cos(TAU * unit(b))
        };
        let vector: Vec<f64> = (0..self.elements).map(normal).collect();
        let length = dot(&vector, &vector).sqrt();
        vector.iter().map(|element| element / length).collect()
    }

    fn dither(&self, symbol: usize) -> f64 {
        unit(self.dithers.at(symbol as u64).0) * self.step
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
