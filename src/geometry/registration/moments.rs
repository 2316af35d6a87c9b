//! Where a whole copy may lie, by moments: second ones for copies that were turned and scaled, fourth ones for any affine map.

use super::points::Points;
use crate::geometry::Motion;
use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, SymmetricEigen};

/// Axes whose spreads are nearer than this may change places.
const EXCHANGEABLE: f64 = 1.35;
/// The same for fourth moments.
const ALIKE: f64 = 1.12;

/// Second moments: mean, axes as columns with rising spreads, and the spreads' roots.
struct Moments {
    mean: DVec3,
    axes: DMat3,
    sizes: DVec3,
}

fn moments(points: &[DVec3]) -> Moments {
    let mean = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let (axes, values) = eigen(points.iter().map(|p| (*p - mean, 1.0)));
    let spread = values / points.len().max(1) as f64;
    let sizes = spread.to_array().map(|v| v.max(0.0).sqrt());
    Moments {
        mean,
        axes,
        sizes: DVec3::from_array(sizes),
    }
}

/// Eigenvectors and rising eigenvalues of the sum of weighted squares.
fn eigen(vectors: impl Iterator<Item = (DVec3, f64)>) -> (DMat3, DVec3) {
    let mut sum = Matrix3::<f64>::zeros();
    for (v, weight) in vectors {
        sum += Matrix3::from_fn(|row, column| v[row] * v[column] * weight);
    }
    let eigen = SymmetricEigen::new(sum);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let column = |i: usize| {
        let v = eigen.eigenvectors.column(order[i]);
        DVec3::new(v[0], v[1], v[2])
    };
    let values = order.map(|i| eigen.eigenvalues[i]);
    (
        DMat3::from_cols(column(0), column(1), column(2)),
        DVec3::from_array(values),
    )
}

/// Motions of a whole copy: axes onto axes in every sense, also with a scale for each axis.
pub fn by_axes(suspect: &Points, original: &Points) -> Vec<Motion> {
    let (s, o) = (moments(&suspect.positions), moments(&original.positions));
    let (total, own) = (o.sizes.length(), s.sizes.length());
    if !(total > 0.0 && own > 0.0) {
        return Vec::new();
    }
    let ratio = |a: usize, b: usize| {
        let squares = (s.sizes[a] / own, o.sizes[b] / total);
        let ratio = (squares.0 * squares.0) / (squares.1 * squares.1).max(1e-12);
        ratio.max(1.0 / ratio.max(1e-12))
    };
    let mut motions = Vec::new();
    for (order, is_plain) in orders() {
        if !is_plain && !(0..3).all(|i| ratio(order[i], i) < EXCHANGEABLE * EXCHANGEABLE) {
            continue;
        }
        let axes = permuted(&s.axes, order);
        for signs in senses() {
            let turn = o.axes * DMat3::from_diagonal(signs) * axes.transpose();
            motions.push(about(turn * (total / own), &s.mean, &o.mean));
        }
        if is_plain {
            for signs in senses() {
                let each = o.sizes / s.sizes.max(DVec3::splat(1e-9 * own));
                let linear = o.axes * DMat3::from_diagonal(signs * each) * axes.transpose();
                motions.push(about(linear, &s.mean, &o.mean));
            }
        }
    }
    motions
}

/// Affine motions of a whole copy, by the axes of its fourth moments once its second ones are equal (FOBI: Cardoso 1989).
pub fn by_fourth_moments(suspect: &Points, original: &Points) -> Vec<Motion> {
    let (Some(s), Some(o)) = (
        Whitened::of(&suspect.positions),
        Whitened::of(&original.positions),
    ) else {
        return Vec::new();
    };
    let mut motions = Vec::new();
    for (order, is_plain) in orders() {
        let alike = |i: usize| {
            let ratio = s.values[order[i]] / o.values[i];
            ratio.max(1.0 / ratio) < ALIKE
        };
        if !is_plain && !(0..3).all(alike) {
            continue;
        }
        let axes = permuted(&s.axes, order);
        for signs in senses() {
            let turn = o.axes * DMat3::from_diagonal(signs) * axes.transpose();
            motions.push(about(o.back * turn * s.to, &s.mean, &o.mean));
        }
    }
    motions
}

/// A cloud whose second moments are made equal.
struct Whitened {
    mean: DVec3,
    to: DMat3,
    back: DMat3,
    axes: DMat3,
    values: DVec3,
}

impl Whitened {
    fn of(points: &[DVec3]) -> Option<Whitened> {
        let Moments { mean, axes, sizes } = moments(points);
        if sizes.min_element() <= 1e-6 * sizes.max_element() {
            return None;
        }
        let to = axes * DMat3::from_diagonal(sizes.recip()) * axes.transpose();
        let back = axes * DMat3::from_diagonal(sizes) * axes.transpose();
        let white = points.iter().map(|p| to * (*p - mean));
        let (axes, values) = eigen(white.map(|z| (z, z.length_squared())));
        Some(Whitened {
            mean,
            to,
            back,
            axes,
            values: values / points.len() as f64,
        })
    }
}

fn about(linear: DMat3, from: &DVec3, to: &DVec3) -> Motion {
    Motion {
        linear,
        translation: *to - linear * *from,
    }
}

/// The six orders of three axes; the first leaves them alone.
fn orders() -> [([usize; 3], bool); 6] {
    [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ]
    .map(|order| (order, order == [0, 1, 2]))
}

fn senses() -> [DVec3; 8] {
    std::array::from_fn(|bits| {
        let sign = |bit: usize| if bits >> bit & 1 == 0 { 1.0 } else { -1.0 };
        DVec3::new(sign(0), sign(1), sign(2))
    })
}

fn permuted(axes: &DMat3, order: [usize; 3]) -> DMat3 {
    let [a, b, c] = order.map(|i| axes.col(i));
    DMat3::from_cols(a, b, c)
}
