//! Point to plane: a motion that is nearly right becomes as right as the surfaces allow.

use super::points::Points;
use crate::geometry::{Motion, Surface};
use glam::{DMat3, DVec3};
use nalgebra::{SMatrix, SVector};

/// What a motion may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    /// A turn and a shift.
    Rigid,
    /// A turn, a shift and a scale.
    Similarity,
    /// Any affine map.
    Affine,
}

impl Freedom {
    fn num(self) -> usize {
        match self {
            Freedom::Rigid => 6,
            Freedom::Similarity => 7,
            Freedom::Affine => MOST,
        }
    }
}

/// Freedoms of an affine map.
const MOST: usize = 12;

/// Normals that differ by more than 60 degrees do not belong together.
const AGREE: f64 = 0.5;
/// The share of the rounds in which the distance that counts falls to its end.
const FALLING: f64 = 0.7;

/// Moves points onto a surface in so many rounds. Points farther than a distance do not count, which falls from `first` to `last`, both
/// in units of the original.
pub fn refined(
    points: &Points,
    surface: &Surface,
    start: Motion,
    freedom: Freedom,
    rounds: usize,
    [first, last]: [f64; 2],
    least_cut: f64,
) -> Motion {
    let mut motion = start;
    for round in 0..rounds {
        let fallen = (round as f64 / (FALLING * rounds as f64)).min(1.0);
        let cap = first * libm::pow(last / first, fallen);
        let Some(step) = step(points, surface, &motion, freedom, cap, least_cut) else {
            break;
        };
        motion = step.after(&motion);
    }
    motion
}

/// One round: the motion that takes the points nearest to the planes that they lie by.
fn step(
    points: &Points,
    surface: &Surface,
    motion: &Motion,
    freedom: Freedom,
    cap: f64,
    least_cut: f64,
) -> Option<Motion> {
    let turned = motion.linear.inverse().transpose();
    if !turned.is_finite() {
        return None;
    }
    let mut pairs = Vec::with_capacity(points.positions.len());
    for (position, normal) in points.positions.iter().zip(&points.normals) {
        let at = motion.of(*position);
        let Some((foot, plane)) = surface.foot(at, 2.0 * cap) else {
            continue;
        };
        if (turned * *normal).normalize_or_zero().dot(plane) > AGREE {
            pairs.push((at, plane, plane.dot(foot - at)));
        }
    }
    if pairs.len() < 3 * freedom.num() {
        return None;
    }
    let mut sizes: Vec<f64> = pairs.iter().map(|(_, _, r)| r.abs()).collect();
    let middle = sizes.len() / 2;
    let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    let cut = (4.0 * median).max(least_cut).min(cap.max(least_cut));
    let centre = pairs.iter().map(|(at, _, _)| *at).sum::<DVec3>() / pairs.len() as f64;
    let spread = pairs.iter().map(|(at, _, _)| at.distance_squared(centre));
    let size = (spread.sum::<f64>() / pairs.len() as f64)
        .sqrt()
        .max(f64::MIN_POSITIVE);
    let num = freedom.num();
    let mut products = SMatrix::<f64, MOST, MOST>::zeros();
    let mut right = SVector::<f64, MOST>::zeros();
    for (at, plane, residual) in pairs {
        let ratio = residual / cut;
        let weight = if ratio.abs() < 1.0 {
            (1.0 - ratio * ratio) * (1.0 - ratio * ratio)
        } else {
            continue;
        };
        let row = row(freedom, (at - centre) / size, plane);
        for i in 0..num {
            right[i] += weight * row[i] * residual;
            for j in 0..=i {
                products[(i, j)] += weight * row[i] * row[j];
            }
        }
    }
    let damping = 1e-6 * products.trace() / num as f64;
    for i in 0..MOST {
        // What is no freedom stays 0.
        products[(i, i)] += if i < num { damping } else { 1.0 };
        for j in 0..i {
            products[(j, i)] = products[(i, j)];
        }
    }
    let x = products.cholesky()?.solve(&right);
    let step = moved(freedom, x.as_slice(), centre, size);
    (step.linear.is_finite() && step.linear.determinant() > 0.0).then_some(step)
}

/// How the distance from a plane answers to each freedom.
fn row(freedom: Freedom, y: DVec3, plane: DVec3) -> [f64; MOST] {
    let mut row = [0.0; MOST];
    match freedom {
        Freedom::Rigid | Freedom::Similarity => {
            row[..3].copy_from_slice(&y.cross(plane).to_array());
            row[3..6].copy_from_slice(&plane.to_array());
            row[6] = y.dot(plane);
        }
        Freedom::Affine => {
            for axis in 0..3 {
                row[3 * axis..3 * axis + 3].copy_from_slice(&(y * plane[axis]).to_array());
            }
            row[9..].copy_from_slice(&plane.to_array());
        }
    }
    row
}

/// The motion by some freedoms, about a centre.
fn moved(freedom: Freedom, x: &[f64], centre: DVec3, size: f64) -> Motion {
    let (linear, shift) = match freedom {
        Freedom::Rigid | Freedom::Similarity => {
            let turn = DVec3::new(x[0], x[1], x[2]) / size;
            let angle = turn.length();
            let rotation = if angle > 1e-15 {
                rotation(turn / angle, angle)
            } else {
                DMat3::IDENTITY
            };
            (
                rotation * (1.0 + x[6] / size).max(0.5),
                DVec3::new(x[3], x[4], x[5]),
            )
        }
        Freedom::Affine => {
            let rows: [DVec3; 3] =
                std::array::from_fn(|i| DVec3::new(x[3 * i], x[3 * i + 1], x[3 * i + 2]) / size);
            let change = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
            (DMat3::IDENTITY + change, DVec3::new(x[9], x[10], x[11]))
        }
    };
    Motion {
        linear,
        translation: centre + shift - linear * centre,
    }
}

fn rotation(axis: DVec3, angle: f64) -> DMat3 {
    let (s, c) = (libm::sin(angle), libm::cos(angle));
    let turned = |v: DVec3| v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1.0 - c));
    DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z))
}
