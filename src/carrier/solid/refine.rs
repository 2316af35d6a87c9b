//! Finding the lattice again when an attack has moved the frame: by the pilots alone, so that the other symbols, which
//! never took part in the search, can testify without a charge for it.

use super::Lattice;
use super::flux::{Cluster, Placement, windows};
use crate::code::Symbol;
use crate::order::order_by;
use crate::random::Random;
use std::f64::consts::TAU;

/// A difference quotient's step.
const EPSILON: f64 = 0.006;
/// Poses that are tried in the linear model, and those that are followed uphill.
const POSES: usize = 4000;
const FOLLOWED: usize = 40;
const CLIMBS: usize = 15;

/// A placement near the given one at which the pilots agree best.
pub fn refine(
    clusters: &[Cluster],
    start: &Placement,
    lattice: &Lattice,
    step_size: f64,
) -> Placement {
    let wide = climb(clusters, start, lattice, step_size, 0.007, [0.3, 0.8, 1.6]);
    climb(clusters, &wide, lattice, step_size, 0.003, [0.25, 0.6, 1.2])
}

/// Pilots in the linear model of a placement's neighbourhood.
struct Pilots {
    /// In steps, at the placement.
    phases: Vec<f64>,
    slopes: Vec<[f64; 7]>,
    weights: Vec<f64>,
}

fn climb(
    clusters: &[Cluster],
    start: &Placement,
    lattice: &Lattice,
    step_size: f64,
    spread: f64,
    spreads: [f64; 3],
) -> Placement {
    let pilots = Pilots::new(clusters, start, lattice, step_size);
    let mut random = Random::new(0x50_4f_53_45);
    let poses: Vec<(f64, [f64; 7])> = (0..POSES)
        .map(|number| {
            let size = if number == 0 {
                0.0
            } else {
                spread * spreads[number % 3]
            };
            let pose = std::array::from_fn(|_| size * random.normal());
            (pilots.agreement(&pose), pose)
        })
        .collect();
    // The best come first; where none is better, the start itself is followed.
    let order = order_by(poses.iter().map(|(agreement, _)| descending(*agreement)));
    let poses: Vec<_> = order
        .iter()
        .take(FOLLOWED)
        .map(|&(_, pose)| poses[pose as usize])
        .chain([poses[0]])
        .collect();
    let curvature = pilots.curvature();
    let best = poses
        .into_iter()
        .map(|(_, pose)| pilots.uphill(pose, &curvature))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(*start, |(_, pose)| start.nudged(&pose))
}

/// A key that orders numbers from the largest to the smallest.
fn descending(number: f64) -> u64 {
    let bits = number.to_bits();
    if bits >> 63 == 0 {
        !bits & !(1 << 63)
    } else {
        bits
    }
}

impl Pilots {
    fn new(clusters: &[Cluster], start: &Placement, lattice: &Lattice, step_size: f64) -> Pilots {
        let pilots: Vec<_> = windows(clusters, start)
            .into_iter()
            .filter_map(|window| {
                let (dither, symbol) = lattice.at(window.index);
                (symbol == Symbol::Pilot).then_some((window, dither))
            })
            .collect();
        let mut slopes = vec![[0.0; 7]; pilots.len()];
        for axis in 0..7 {
            let mut nudge = [0.0; 7];
            nudge[axis] = EPSILON;
            let nudged = windows(clusters, &start.nudged(&nudge));
            for ((window, _), slope) in pilots.iter().zip(&mut slopes) {
                if let Ok(found) = nudged.binary_search_by_key(&window.index, |other| other.index) {
                    slope[axis] = (nudged[found].flux - window.flux) / (EPSILON * step_size);
                }
            }
        }
        Pilots {
            phases: pilots
                .iter()
                .map(|(window, dither)| window.flux / step_size + dither)
                .collect(),
            slopes,
            weights: pilots.iter().map(|(window, _)| window.weight).collect(),
        }
    }

    fn phase(&self, pilot: usize, pose: &[f64; 7]) -> f64 {
        let slope: f64 = self.slopes[pilot]
            .iter()
            .zip(pose)
            .map(|(slope, x)| slope * x)
            .sum();
        self.phases[pilot] + slope
    }

    fn agreement(&self, pose: &[f64; 7]) -> f64 {
        (0..self.phases.len())
            .map(|p| self.weights[p] * libm::cos(TAU * self.phase(p, pose)))
            .sum()
    }

    /// The mean curvature of the agreement: half of `(2 pi)^2 sum w slope slope^T`.
    fn curvature(&self) -> [[f64; 7]; 7] {
        let mut curvature = [[0.0; 7]; 7];
        for (slope, weight) in self.slopes.iter().zip(&self.weights) {
            for (row, a) in curvature.iter_mut().zip(slope) {
                row.iter_mut()
                    .zip(slope)
                    .for_each(|(entry, b)| *entry += 0.5 * TAU * TAU * weight * a * b);
            }
        }
        curvature
    }

    /// Follows the gradient, scaled by the curvature, for a few steps.
    fn uphill(&self, mut pose: [f64; 7], curvature: &[[f64; 7]; 7]) -> (f64, [f64; 7]) {
        for _ in 0..CLIMBS {
            let mut gradient = [0.0; 7];
            for p in 0..self.phases.len() {
                let push = -TAU * self.weights[p] * libm::sin(TAU * self.phase(p, &pose));
                gradient
                    .iter_mut()
                    .zip(&self.slopes[p])
                    .for_each(|(g, slope)| *g += push * slope);
            }
            let step = solve(*curvature, gradient);
            pose.iter_mut()
                .zip(step)
                .for_each(|(x, step)| *x += 0.35 * step);
        }
        (self.agreement(&pose), pose)
    }
}

/// Gauss-Jordan elimination on a symmetric positive semidefinite matrix, with a little added to its diagonal.
fn solve(mut a: [[f64; 7]; 7], mut b: [f64; 7]) -> [f64; 7] {
    let trace: f64 = a.iter().enumerate().map(|(i, row)| row[i]).sum();
    for pivot in 0..7 {
        a[pivot][pivot] += 1e-9 * trace + 1e-300;
        let (row, known) = (a[pivot], b[pivot]);
        for (other, (entries, right)) in a.iter_mut().zip(&mut b).enumerate() {
            if other != pivot {
                let factor = entries[pivot] / row[pivot];
                entries
                    .iter_mut()
                    .zip(row)
                    .for_each(|(entry, x)| *entry -= factor * x);
                *right -= factor * known;
            }
        }
    }
    b.iter_mut().enumerate().for_each(|(i, x)| *x /= a[i][i]);
    b
}
