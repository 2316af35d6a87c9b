//! Salient places of a surface: points with a size and a frame of their own that depend on what lies near them alone.
//!
//! A place is an extremum, in position and in width, of an invariant of M ([`tensor`]): a bump, a pit, a limb, a saddle. Moving,
//! turning or scaling a model takes its places along; other triangles hardly move them; and cutting away what lies beyond their support
//! changes nothing. Nothing here needs a key.
//!
//! | file | idea |
//! |---|---|
//! | `areas` | a surface in cells of several sizes |
//! | `tensor` | what is seen of it about a point |
//! | `grid` | where places may be |
//! | `mod` | where they are exactly, and how they lie |
//!
//! Scale-normalised extrema: Lindeberg 1998. That they are taken of a mesh's occupancy, by its vector areas, is this project's own
//! (docs/REFERENCES.md, "Places").

mod areas;
mod grid;
mod tensor;

pub use areas::{Areas, Level, Piece};
pub use tensor::{Invariant, SUPPORT, Tensor, near, tensor};

use super::linear::symmetric_eigen;
use super::pose::eigen;
use crate::mesh::Mesh;
use crate::order::order_by;
use glam::{DMat3, DVec3};
use grid::{Start, starts};
use std::ops::Range;

/// A place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// What it is an extremum of.
    pub invariant: Invariant,
    /// Whether it is a maximum.
    pub is_high: bool,
    /// Where it is, in scene units.
    pub point: DVec3,
    /// The width at which it is one, in scene units.
    pub width: f64,
    /// How sharply it is one: the least curvature of the invariant, in widths and their logarithm. Above 0.
    pub sharpness: f64,
    /// Its frames: by M at its own width, and at one and a half of it.
    pub frames: [Frame; 2],
}

/// The axes of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Eigenvectors of M as columns, by decreasing eigenvalue, right-handed. Turning two of them over gives as good a frame.
    pub axes: DMat3,
    /// How well they are told apart: the smallest difference of two eigenvalues, as a share of the largest.
    pub gap: f64,
}

/// Widths that frames are taken at, in the place's own.
const FRAMES: [f64; 2] = [1.0, 1.5];

/// Cells are so many times smaller than the smallest width that they serve, at least.
const CELLS_PER_WIDTH: f64 = 2.5;

/// Steps of Newton's method at most, and what ends it, in widths and logarithms.
const STEPS: usize = 7;
const SMALL_STEP: f64 = 2e-3;
/// The largest step, and how far all steps may lead: in widths, and in their logarithm.
const LARGEST_STEP: f64 = 0.35;
const FARTHEST: f64 = 1.0;
const FARTHEST_LN: f64 = 0.4;
/// Steps of difference quotients: in widths, and in their logarithm.
const APART: [f64; 4] = [0.15, 0.15, 0.15, 0.1];
/// Curvatures less than this do not lengthen a step further.
const LEAST_CURVATURE: f64 = 0.003;

/// Places of one kind that are nearer than this, in widths and their logarithm, are one.
const SAME: f64 = 0.15;
const SAME_LN: f64 = 0.08;

/// The areas that places of some widths need, in scene units, of a mesh whose triangles face outwards.
pub fn areas(mesh: &Mesh, widths: &Range<f64>) -> Areas {
    let num_octaves = octaves(widths).count();
    Areas::new(mesh, widths.start / CELLS_PER_WIDTH, num_octaves)
}

/// The smallest width of each octave.
fn octaves(widths: &Range<f64>) -> impl Iterator<Item = f64> + use<> {
    let end = widths.end;
    std::iter::successors(Some(widths.start), |width| Some(2.0 * width))
        .take_while(move |width| *width < end)
}

/// All places of some widths, the sharpest first.
pub fn places(areas: &Areas, widths: &Range<f64>) -> Vec<Place> {
    let mut all = Vec::new();
    for (width, level) in octaves(widths).zip(areas.levels()) {
        let found = starts(level, width);
        all.extend(found.iter().filter_map(|start| exact(areas, start)));
    }
    let order = order_by(all.iter().map(|place: &Place| !place.sharpness.to_bits()));
    let mut kept: Vec<Place> = Vec::new();
    for (_, index) in order {
        let place = all[index as usize];
        if !kept.iter().any(|other| other.is_same(&place)) {
            kept.push(place);
        }
    }
    kept
}

impl Place {
    /// The same place on a surface that changed a little: the nearest extremum of its kind.
    pub fn again(&self, areas: &Areas) -> Option<Place> {
        let start = Start {
            invariant: self.invariant,
            is_high: self.is_high,
            point: self.point,
            width: self.width,
        };
        exact(areas, &start)
    }

    fn is_same(&self, other: &Place) -> bool {
        self.invariant == other.invariant
            && self.is_high == other.is_high
            && self.point.distance(other.point) < SAME * self.width
            && libm::log(self.width / other.width).abs() < SAME_LN
    }
}

/// The extremum that a start leads to, by Newton's method in position and width.
fn exact(areas: &Areas, start: &Start) -> Option<Place> {
    let level = areas.level(start.width / CELLS_PER_WIDTH);
    let (mut point, mut width) = (start.point, start.width);
    let sign = if start.is_high { 1.0 } else { -1.0 };
    for _ in 0..STEPS {
        let support = SUPPORT * libm::exp(APART[3]) + APART[0];
        let pieces = near(&level.pieces, point, support * width);
        let value = |at: [f64; 4]| {
            let shift = DVec3::new(at[0], at[1], at[2]) * width;
            sign * start
                .invariant
                .of(tensor(&pieces, point + shift, width * libm::exp(at[3])))
        };
        let (gradient, hessian) = derivatives(value);
        let (curvatures, directions) = symmetric_eigen(hessian);
        let mut step = [0.0; 4];
        for (curvature, direction) in curvatures.iter().zip(&directions) {
            let slope: f64 = gradient.iter().zip(direction).map(|(g, d)| g * d).sum();
            let along = slope / curvature.abs().max(LEAST_CURVATURE);
            step.iter_mut()
                .zip(direction)
                .for_each(|(s, d)| *s += along * d);
        }
        let length = step.iter().map(|s| s * s).sum::<f64>().sqrt();
        let share = (LARGEST_STEP / length).min(1.0);
        point += DVec3::new(step[0], step[1], step[2]) * (share * width);
        width *= libm::exp(share * step[3]);
        let is_near = point.distance(start.point) <= FARTHEST * start.width
            && libm::log(width / start.width).abs() <= FARTHEST_LN;
        if !is_near {
            return None;
        }
        if length < SMALL_STEP {
            let sharpness = -curvatures.into_iter().fold(f64::NEG_INFINITY, f64::max);
            return (sharpness > 0.0).then(|| Place {
                invariant: start.invariant,
                is_high: start.is_high,
                point,
                width,
                sharpness,
                frames: FRAMES.map(|widths| frame(level, point, widths * width)),
            });
        }
    }
    None
}

/// The gradient and the Hessian at 0, by difference quotients in units of [`APART`].
fn derivatives(value: impl Fn([f64; 4]) -> f64) -> ([f64; 4], [[f64; 4]; 4]) {
    let at = |steps: &[(usize, f64)]| {
        let mut point = [0.0; 4];
        for &(axis, sign) in steps {
            point[axis] = sign * APART[axis];
        }
        value(point)
    };
    let middle = at(&[]);
    let (mut gradient, mut hessian, mut bends) = ([0.0; 4], [[0.0; 4]; 4], [0.0; 4]);
    for a in 0..4 {
        let [up, down] = [1.0, -1.0].map(|sign| at(&[(a, sign)]));
        gradient[a] = (up - down) / (2.0 * APART[a]);
        bends[a] = up + down - 2.0 * middle;
        hessian[a][a] = bends[a] / (APART[a] * APART[a]);
        for b in 0..a {
            // Two points for each pair of axes, where four are usual: the rest is known from the axes themselves.
            let [up, down] = [1.0, -1.0].map(|sign| at(&[(a, sign), (b, sign)]));
            let both = up + down - 2.0 * middle;
            hessian[a][b] = (both - bends[a] - bends[b]) / (2.0 * APART[a] * APART[b]);
            hessian[b][a] = hessian[a][b];
        }
    }
    (gradient, hessian)
}

/// The frame of M at a point and a width.
fn frame(level: &Level, point: DVec3, width: f64) -> Frame {
    let pieces = near(&level.pieces, point, SUPPORT * width);
    let [xx, yy, zz, xy, xz, yz] = tensor(&pieces, point, width);
    let (values, axes) = eigen(DMat3::from_cols_array(&[
        xx, xy, xz, xy, yy, yz, xz, yz, zz,
    ]));
    let largest = values.abs().max_element();
    Frame {
        axes,
        gap: (values.x - values.y).min(values.y - values.z) / largest,
    }
}
