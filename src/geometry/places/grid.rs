//! Where places may be: extrema on grids, one for each octave of widths.

use super::areas::Level;
use super::tensor::Invariant;
use glam::DVec3;

/// Widths in an octave, and the smallest of them in steps of the grid. The widths of neighbouring octaves overlap, or places are lost between
/// them.
const WIDTHS: usize = 4;
const SMALLEST: f64 = 2.0;
/// What is about the surface, in largest widths.
const MARGIN: f64 = 2.2;
/// Smoothing that the grid does by itself, in squared steps: spreading areas over its points, and differences in place of derivatives.
const OWN: f64 = 1.0 / 6.0 + 1.0 / 9.0;
/// Values below this are no places.
const LEAST: f32 = 0.02;

/// An extremum on a grid.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    pub invariant: Invariant,
    /// Whether it is a maximum.
    pub is_high: bool,
    pub point: DVec3,
    pub width: f64,
}

/// A box of grid points.
struct Lattice {
    low: DVec3,
    step: f64,
    size: [usize; 3],
}

/// The extrema of all invariants for widths from one to the double of it, whose surface is at hand.
pub fn starts(level: &Level, width: f64) -> Vec<Start> {
    let lattice = Lattice::about(level, width / SMALLEST);
    let mut smoothed = lattice.spread(level);
    let mut variance = OWN;
    let mut found = Vec::new();
    let mut window: Vec<[Vec<f32>; 3]> = Vec::new();
    for number in 0..WIDTHS + 4 {
        let width = SMALLEST * octaves(number as f64 - 1.5);
        let more = width * width - variance;
        variance = width * width;
        for part in &mut smoothed {
            lattice.smooth(part, more.max(0.0).sqrt());
        }
        window.push(lattice.invariants(&smoothed, width));
        if window.len() == 3 {
            let width = SMALLEST * octaves(number as f64 - 2.5) * lattice.step;
            for invariant in Invariant::ALL {
                let layers = [0, 1, 2].map(|layer| window[layer][invariant as usize].as_slice());
                lattice.extrema(layers, |is_high, point| {
                    found.push(Start {
                        invariant,
                        is_high,
                        point,
                        width,
                    });
                });
            }
            window.remove(0);
        }
    }
    found
}

/// Two to the power of so many widths of an octave.
fn octaves(widths: f64) -> f64 {
    libm::exp2(widths / WIDTHS as f64)
}

impl Lattice {
    fn about(level: &Level, step: f64) -> Lattice {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for piece in &level.pieces {
            low = low.min(piece.point);
            high = high.max(piece.point);
        }
        let margin = (MARGIN * SMALLEST * 2.0).ceil() * step;
        let (low, high) = (low - margin, high + margin);
        Lattice {
            size: ((high - low) / step).to_array().map(|s| s as usize + 2),
            low,
            step,
        }
    }

    fn place(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * self.size[1] + j) * self.size[2] + k
    }

    /// How far neighbours along each axis are from each other.
    fn strides(&self) -> [usize; 3] {
        [self.size[1] * self.size[2], self.size[2], 1]
    }

    /// The area vectors, each shared by the eight points about it, in squared steps.
    fn spread(&self, level: &Level) -> [Vec<f32>; 3] {
        let len = self.size.iter().product();
        let mut sums = [0, 1, 2].map(|_| vec![0.0f32; len]);
        for piece in &level.pieces {
            let at = (piece.point - self.low) / self.step;
            let [i, j, k] = at.to_array().map(|part| part as usize);
            let within = at - DVec3::new(i as f64, j as f64, k as f64);
            let area = (piece.area / (self.step * self.step)).to_array();
            for corner in 0..8 {
                let bits = [corner >> 2 & 1, corner >> 1 & 1, corner & 1];
                let shares = [0, 1, 2].map(|axis| match bits[axis] {
                    1 => within[axis],
                    _ => 1.0 - within[axis],
                });
                let share = shares[0] * shares[1] * shares[2];
                let place = self.place([i + bits[0], j + bits[1], k + bits[2]]);
                for (sum, area) in sums.iter_mut().zip(area) {
                    sum[place] += (share * area) as f32;
                }
            }
        }
        sums
    }

    /// Smooths by Gauss's function of a width in steps, along one axis after the other. All is zero outside.
    fn smooth(&self, values: &mut [f32], width: f64) {
        let reach = (4.0 * width).ceil() as usize;
        let weight =
            |offset: usize| libm::exp(-0.5 * (offset as f64 / width) * (offset as f64 / width));
        let total = weight(0) + 2.0 * (1..=reach).map(weight).sum::<f64>();
        let weights: Vec<f32> = (0..=reach).map(|o| (weight(o) / total) as f32).collect();
        for (axis, stride) in self.strides().into_iter().enumerate() {
            let len = self.size[axis];
            let mut line = vec![0.0f32; len + 2 * reach];
            let mut sums = vec![0.0f32; len];
            for start in 0..values.len() {
                // Only where a line along this axis begins.
                if start / stride % len != 0 {
                    continue;
                }
                for (place, value) in line[reach..].iter_mut().zip(0..len) {
                    *place = values[start + value * stride];
                }
                let middle = &line[reach..reach + len];
                for (sum, value) in sums.iter_mut().zip(middle) {
                    *sum = weights[0] * value;
                }
                for (offset, weight) in weights.iter().enumerate().skip(1) {
                    let before = &line[reach - offset..reach - offset + len];
                    let after = &line[reach + offset..reach + offset + len];
                    for ((sum, before), after) in sums.iter_mut().zip(before).zip(after) {
                        *sum += weight * (before + after);
                    }
                }
                for (place, sum) in sums.iter().enumerate() {
                    values[start + place * stride] = *sum;
                }
            }
        }
    }

    /// The invariants of M at every point that has neighbours.
    fn invariants(&self, [x, y, z]: &[Vec<f32>; 3], width: f64) -> [Vec<f32>; 3] {
        let [sx, sy, sz] = self.strides();
        let scale = (0.5 * width * width) as f32;
        let mut all = [0, 1, 2].map(|_| vec![0.0f32; x.len()]);
        let reach = sx + sy + sz;
        for place in reach..x.len() - reach {
            // A point's surface areas face outwards, and the occupancy falls that way.
            let along = |values: &[f32], stride: usize| {
                scale * (values[place + stride] - values[place - stride])
            };
            let tensor = [
                along(x, sx),
                along(y, sy),
                along(z, sz),
                0.5 * (along(x, sy) + along(y, sx)),
                0.5 * (along(x, sz) + along(z, sx)),
                0.5 * (along(y, sz) + along(z, sy)),
            ];
            let tensor = tensor.map(f64::from);
            for (values, invariant) in all.iter_mut().zip(Invariant::ALL) {
                values[place] = invariant.of(tensor) as f32;
            }
        }
        all
    }

    /// The points of the middle layer that no neighbour exceeds or equals, nor they themselves at the next widths.
    fn extrema(&self, layers: [&[f32]; 3], mut found: impl FnMut(bool, DVec3)) {
        let strides = self.strides();
        let [nx, ny, nz] = self.size;
        for i in 2..nx - 2 {
            for j in 2..ny - 2 {
                for k in 2..nz - 2 {
                    let place = self.place([i, j, k]);
                    let value = layers[1][place];
                    if value.abs() <= LEAST {
                        continue;
                    }
                    let sign = value.signum();
                    let is_above = |layer: &[f32], place: usize| sign * layer[place] < sign * value;
                    let [sx, sy, sz] = strides;
                    let corner = place - sx - sy - sz;
                    let mut about =
                        (0..27).map(|n| corner + n / 9 * sx + n / 3 % 3 * sy + n % 3 * sz);
                    // Among widths the point alone: of two extrema near each other, their neighbours would hide one on some grids.
                    let is_extremum = [0, 2].into_iter().all(|n| is_above(layers[n], place))
                        && about.all(|other| other == place || is_above(layers[1], other));
                    if is_extremum {
                        let at = DVec3::new(i as f64, j as f64, k as f64);
                        found(sign > 0.0, self.low + at * self.step);
                    }
                }
            }
        }
    }
}
