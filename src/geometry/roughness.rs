//! How rough a surface is, vertex by vertex: where a displacement will not be seen.

use super::vertex_normals;
use crate::mesh::{Mesh, Rings};
use glam::DVec3;

/// V roughnesses: the RMS angle, in radians, by which the vertex normals of a neighbourhood leave a smooth field.
///
/// A smooth field is the normals after 6 half-steps of the umbrella operator. Curvature alone does not count, and neither
/// does a lone crease: of the neighbourhoods that a vertex is in, the smoothest is taken. (Perceptual metrics such as MSDM,
/// Lavoue et al. 2006, rate distortions by the roughness that masks them.)
pub fn roughness(mesh: &Mesh, rings: &Rings) -> Vec<f64> {
    let normals = vertex_normals(mesh);
    let mut smooth = normals.clone();
    for _ in 0..6 {
        smooth = half_step(&smooth, rings, DVec3::ZERO);
    }
    let mut square: Vec<f64> = normals
        .iter()
        .zip(&smooth)
        .map(|(normal, smooth)| normal.distance_squared(smooth.normalize_or_zero()))
        .collect();
    for _ in 0..6 {
        square = half_step(&square, rings, 0.0);
    }
    for _ in 0..4 {
        square = least(&square, rings);
    }
    for _ in 0..6 {
        square = half_step(&square, rings, 0.0);
    }
    square.iter().map(|square| square.sqrt()).collect()
}

/// The least of each value and its neighbours'.
fn least(values: &[f64], rings: &Rings) -> Vec<f64> {
    let of = |v: usize| {
        let neighbours = rings.neighbours(v).iter().map(|&n| values[n as usize]);
        neighbours.fold(values[v], f64::min)
    };
    (0..values.len()).map(of).collect()
}

/// Half of each value and half of its neighbours' mean.
fn half_step<T>(values: &[T], rings: &Rings, zero: T) -> Vec<T>
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let step = |v: usize| {
        let neighbours = rings.neighbours(v);
        if neighbours.is_empty() {
            return values[v];
        }
        let sum = neighbours
            .iter()
            .fold(zero, |sum, &n| sum + values[n as usize]);
        values[v] * 0.5 + sum * (0.5 / neighbours.len() as f64)
    };
    (0..values.len()).map(step).collect()
}
