//! The similarity that fits best, where it is known which point belongs to which.

use super::Motion;
use glam::{DMat3, DVec3};
use nalgebra::Matrix3;

/// Where the similarity takes points that fits best, by least squares, to as many others: rotation, reflection, scale and translation
/// (Umeyama 1991, with reflections). As they are where there is nothing to fit.
pub fn registered(points: &[DVec3], onto: &[DVec3]) -> Vec<DVec3> {
    match fitted(points, onto) {
        Some(motion) => points.iter().map(|p| motion.of(*p)).collect(),
        None => points.to_vec(),
    }
}

/// The similarity itself; `None` where there is nothing to fit.
pub fn fitted(points: &[DVec3], onto: &[DVec3]) -> Option<Motion> {
    let mean = |points: &[DVec3]| points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let (from, to) = (mean(points), mean(onto));
    let mut covariance = Matrix3::zeros();
    let mut square = 0.0;
    for (p, q) in points.iter().zip(onto) {
        let (p, q) = (*p - from, *q - to);
        covariance += Matrix3::from_fn(|row, column| q[row] * p[column]);
        square += p.length_squared();
    }
    let factors = covariance.svd(true, true);
    let (left, right) = (factors.u?, factors.v_t?);
    if square == 0.0 {
        return None;
    }
    let linear = left * right * (factors.singular_values.sum() / square);
    let column = |i: usize| DVec3::new(linear[(0, i)], linear[(1, i)], linear[(2, i)]);
    let linear = DMat3::from_cols(column(0), column(1), column(2));
    Some(Motion {
        linear,
        translation: to - linear * from,
    })
}
