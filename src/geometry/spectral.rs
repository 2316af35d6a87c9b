//! Undoing what smoothing did: inverse low-pass filters as Chebyshev polynomials of the umbrella operator.
//!
//! Smoothing multiplies the components of a mesh's spectrum by powers of a known factor; as long as none is lost in
//! rounding, dividing brings them back. The eigenvalues x of the averaging operator W = D^-1 A lie in [-1, 1]; with
//! kappa = 1 - x, k steps of Laplacian smoothing by lambda leave (1 - lambda kappa)^k. The inverse is limited to a greatest
//! gain. Vertices that were held are rows of the identity in W: its eigenvalues stay real and within [-1, 1]. All filters
//! share the polynomials T_n(W) X, which are computed once. O(degree * (edges + filters * V)).

use crate::mesh::Rings;
use glam::DVec3;
use std::f64::consts::PI;

/// Degree of the polynomials.
const DEGREE: usize = 60;

/// Polynomials that are at hand at a time: each result is passed over once for each block of them.
const BLOCK: usize = 4;

/// A smoothing to undo.
#[derive(Clone, Copy, Debug)]
pub struct InverseFilter {
    /// Steps of smoothing, of any real number.
    pub steps: f64,
    /// What one step leaves of a component of frequency kappa, 0 to 2.
    pub step: fn(f64) -> f64,
    /// The greatest gain.
    pub gain: f64,
}

/// One step of Laplacian smoothing with lambda = 0.1.
pub fn laplacian(kappa: f64) -> f64 {
    1.0 - 0.1 * kappa
}

/// One step of Taubin smoothing with lambda = 0.5, mu = -0.53.
pub fn taubin(kappa: f64) -> f64 {
    (1.0 - 0.5 * kappa) * (1.0 + 0.53 * kappa)
}

impl InverseFilter {
    /// The gain at a frequency: `a / sqrt(1 + a^2 / gain^2)` with the exact inverse `a`.
    fn at(&self, kappa: f64) -> f64 {
        let left = libm::pow((self.step)(kappa).abs().max(1e-12), self.steps);
        1.0 / (left * left + 1.0 / (self.gain * self.gain)).sqrt()
    }

    /// Chebyshev coefficients by interpolation, scaled so that a constant stays what it is.
    fn coefficients(&self) -> Vec<f64> {
        let num_nodes = DEGREE + 1;
        let angle = |node: usize| PI * (node as f64 + 0.5) / num_nodes as f64;
        let values: Vec<f64> = (0..num_nodes)
            .map(|node| self.at(1.0 - libm::cos(angle(node))))
            .collect();
        let coefficient = |n: usize| {
            let sum: f64 = values
                .iter()
                .enumerate()
                .map(|(node, v)| v * libm::cos(n as f64 * angle(node)))
                .sum();
            sum * if n == 0 { 1.0 } else { 2.0 } / num_nodes as f64
        };
        let coefficients: Vec<f64> = (0..num_nodes).map(coefficient).collect();
        let at_zero: f64 = coefficients.iter().sum();
        coefficients.iter().map(|c| c / at_zero).collect()
    }
}

/// V positions as each filter leaves them, of a smoothing that moved the vertices for which `moves` is true.
pub fn filtered(
    positions: &[DVec3],
    rings: &Rings,
    filters: &[InverseFilter],
    moves: &[bool],
) -> Vec<Vec<DVec3>> {
    let average = |x: &[DVec3]| -> Vec<DVec3> {
        let mean = |v: usize| {
            let neighbours = rings.neighbours(v);
            let sum: DVec3 = neighbours.iter().map(|&n| x[n as usize]).sum();
            if neighbours.is_empty() || !moves[v] {
                x[v]
            } else {
                sum / neighbours.len() as f64
            }
        };
        (0..x.len()).map(mean).collect()
    };
    let coefficients: Vec<Vec<f64>> = filters.iter().map(InverseFilter::coefficients).collect();
    let mut results = vec![vec![DVec3::ZERO; positions.len()]; filters.len()];
    let mut previous = positions.to_vec();
    let mut current = average(positions);
    for first in (0..=DEGREE).step_by(BLOCK) {
        let block: Vec<Vec<DVec3>> = (first..(first + BLOCK).min(DEGREE + 1))
            .map(|_| {
                let averaged = average(&current);
                let next = averaged
                    .iter()
                    .zip(&previous)
                    .map(|(next, x)| *next * 2.0 - *x);
                let next = next.collect();
                std::mem::replace(&mut previous, std::mem::replace(&mut current, next))
            })
            .collect();
        for (result, coefficients) in results.iter_mut().zip(&coefficients) {
            for (vertex, sum) in result.iter_mut().enumerate() {
                for (x, c) in block.iter().zip(&coefficients[first..]) {
                    *sum += x[vertex] * *c;
                }
            }
        }
    }
    results
}
