//! Where a whole copy may lie, by moments: second ones for copies that were turned and scaled, fourth ones for any affine map.

use super::points::Points;
use crate::geometry::Motion;
use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, SymmetricEigen};

/// Axes whose spreads are nearer than this may change places.
const EXCHANGEABLE: f64 = 1.35;
/// The same for fourth moments.
const ALIKE: f64 = 1.12;
/// Spreads whose ratio is smaller are of one size, as far as strewn points tell: of 6000 the roots err by some hundredths. Others were not tried.
const EQUAL: f64 = 1.05;
/// Rounds of making second moments equal by areas. A part stretched by 3 is laid right after 8; chosen on generated shapes and eight stretches.
const ROUNDS: usize = 8;

/// Second moments: mean, axes as columns with rising spreads, and the spreads' roots.
struct Moments {
    mean: DVec3,
    axes: DMat3,
    sizes: DVec3,
}

fn moments(points: &[DVec3], weights: &[f64]) -> Moments {
    let total = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let weighted = || points.iter().zip(weights);
    let mean = weighted().map(|(p, w)| *p * *w).sum::<DVec3>() / total;
    let (axes, values) = eigen(weighted().map(|(p, w)| (*p - mean, *w)));
    let sizes = (values / total).to_array().map(|v| v.max(0.0).sqrt());
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

/// Whether two spreads are equal, as they are of any shape that a third of a turn or less takes onto itself.
pub fn has_equal_spreads(points: &Points) -> bool {
    let sizes = moments(&points.positions, &as_strewn(points)).sizes;
    let [a, b, c] = sizes.to_array();
    b < EQUAL * a || c < EQUAL * b
}

/// Motions of a whole copy: axes onto axes in every sense, also with a scale for each axis.
pub fn by_axes(suspect: &Points, original: &Points) -> Vec<Motion> {
    let [s, o] = [suspect, original].map(|points| moments(&points.positions, &as_strewn(points)));
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

/// Affine motions of a whole copy, by the axes of its fourth moments once its second ones are equal (FOBI: Cardoso 1989). Unlike a signal's
/// samples, points of a surface stand for areas, which change with the map; they are weighed alike too, for a round shape may have no axes else.
pub fn by_fourth_moments(suspect: &Points, original: &Points) -> Vec<Motion> {
    let by_areas = |rounds| {
        Some([
            Whitened::of(suspect, rounds)?,
            Whitened::of(original, rounds)?,
        ])
    };
    let pairs = [0, ROUNDS].into_iter().filter_map(by_areas);
    pairs.flat_map(|[s, o]| s.onto(&o)).collect()
}

/// A cloud whose second moments are made equal. After some rounds that is so by areas as they are then, and the cloud is the same for any affine
/// image.
struct Whitened {
    mean: DVec3,
    to: DMat3,
    back: DMat3,
    axes: DMat3,
    values: DVec3,
}

impl Whitened {
    fn of(points: &Points, rounds: usize) -> Option<Whitened> {
        let mut weights = as_strewn(points);
        let mut whitening = Whitening::of(points, &weights)?;
        for _ in 0..rounds {
            weights = whitening.areas(points);
            whitening = Whitening::of(points, &weights)?;
        }
        let Whitening { mean, to, back } = whitening;
        let white = points.positions.iter().map(|p| to * (*p - mean));
        let weighted = white.zip(&weights);
        let (axes, values) = eigen(weighted.map(|(z, w)| (z, w * z.length_squared())));
        Some(Whitened {
            mean,
            to,
            back,
            axes,
            values: values / weights.iter().sum::<f64>(),
        })
    }

    /// Motions of axes onto axes, in every sense and every order that their values allow.
    fn onto(&self, o: &Whitened) -> Vec<Motion> {
        let mut motions = Vec::new();
        for (order, is_plain) in orders() {
            let alike = |i: usize| {
                let ratio = self.values[order[i]] / o.values[i];
                ratio.max(1.0 / ratio) < ALIKE
            };
            if !is_plain && !(0..3).all(alike) {
                continue;
            }
            let axes = permuted(&self.axes, order);
            for signs in senses() {
                let turn = o.axes * DMat3::from_diagonal(signs) * axes.transpose();
                motions.push(about(o.back * turn * self.to, &self.mean, &o.mean));
            }
        }
        motions
    }
}

/// What makes second moments equal, and what undoes it.
struct Whitening {
    mean: DVec3,
    to: DMat3,
    back: DMat3,
}

impl Whitening {
    fn of(points: &Points, weights: &[f64]) -> Option<Whitening> {
        let Moments { mean, axes, sizes } = moments(&points.positions, weights);
        if sizes.min_element() <= 1e-6 * sizes.max_element() {
            return None;
        }
        let along = |sizes: DVec3| axes * DMat3::from_diagonal(sizes) * axes.transpose();
        Some(Whitening {
            mean,
            to: along(sizes.recip()),
            back: along(sizes),
        })
    }

    /// What of the surface each point stands for, once it is stretched: areas go by the inverse's transpose.
    fn areas(&self, points: &Points) -> Vec<f64> {
        let normals = points.normals.iter();
        normals.map(|n| (self.back * *n).length()).collect()
    }
}

/// The weights of points as they were strewn: each stands for as much of the surface.
fn as_strewn(points: &Points) -> Vec<f64> {
    vec![1.0; points.positions.len()]
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
