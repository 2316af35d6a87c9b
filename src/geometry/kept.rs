//! Vertices that a suspect kept from an original: where they went says more than the surface between them.

use super::Motion;
use super::near::Near;
use super::registration::Original;
use super::residual::{Observation, median};
use crate::mesh::Mesh;
use glam::DVec3;
use nalgebra::{Matrix4, Vector4};

/// A vertex that is farther from one of the original's than this share of the diagonal is none of them.
const FARTHEST: f64 = 0.004;
/// The least number of vertices, and the least share of the suspect's, that have to be the original's.
const LEAST: usize = 40;
const LEAST_SHARE: f64 = 0.3;
/// What is left of the movement is mostly the mark; noise is taken for this part of it.
const NOISE: f64 = 0.1;
/// Movements beyond so many deviations count as so many.
const CLIP: f64 = 4.0;
const ROUNDS: usize = 5;

/// What a suspect kept of an original's V vertices.
pub struct Kept {
    /// Where they went, without what moved them all alike.
    pub observations: Vec<Observation>,
    /// V positions, in the original's scene units: where the suspect, laid on the original, has them; no numbers for what it has not.
    pub positions: Vec<DVec3>,
}

/// What a suspect kept of an original's vertices; `None` where it kept next to none.
pub fn kept(original: &Original, suspect: &Mesh, motion: &Motion) -> Option<Kept> {
    let reach = FARTHEST * original.diagonal;
    let near = Near::new(original.mesh.positions.iter().map(|p| p.to_array()));
    // For each vertex of the original the nearest of the suspect's.
    let mut nearest = vec![(f64::INFINITY, DVec3::ZERO); original.mesh.positions.len()];
    for position in &suspect.positions {
        let at = motion.of(*position);
        if let Some(&(square, name)) = near.nearest(at.to_array(), 1).first()
            && square < nearest[name as usize].0
        {
            nearest[name as usize] = (square, at);
        }
    }
    let positions: Vec<DVec3> = nearest
        .iter()
        .map(|&(square, at)| {
            if square < reach * reach {
                at
            } else {
                DVec3::NAN
            }
        })
        .collect();
    let pairs: Vec<(u32, DVec3, DVec3)> = (0..)
        .zip(original.mesh.positions.iter().zip(&positions))
        .filter(|(_, (_, at))| at.is_finite())
        .map(|(name, (from, at))| (name, *from, *at))
        .collect();
    if pairs.len() < LEAST || (pairs.len() as f64) < LEAST_SHARE * suspect.positions.len() as f64 {
        return None;
    }
    let left = without_motion(&pairs, original.diagonal);
    let mut sizes: Vec<f64> = left.iter().map(|d| d.length()).collect();
    let scale = median(&mut sizes) + 1e-7 * original.diagonal;
    let precision = 1.0 / (NOISE * NOISE * scale * scale);
    let observe = |(&(name, ..), left): (&(u32, DVec3, DVec3), &DVec3)| {
        let left = left.clamp_length_max(CLIP * scale);
        [DVec3::X, DVec3::Y, DVec3::Z].map(|direction| Observation {
            vertices: [name; 3],
            weights: [1.0, 0.0, 0.0],
            direction,
            value: left.dot(direction),
            precision,
        })
    };
    Some(Kept {
        observations: pairs.iter().zip(&left).flat_map(observe).collect(),
        positions,
    })
}

/// Movements of vertices without the affine map that explains most of them, in rounds that give what does not fit less weight.
fn without_motion(pairs: &[(u32, DVec3, DVec3)], diagonal: f64) -> Vec<DVec3> {
    let origin = pairs.iter().map(|pair| pair.1).sum::<DVec3>() / pairs.len() as f64;
    let row = |from: DVec3| {
        let y = (from - origin) / diagonal;
        Vector4::new(y.x, y.y, y.z, 1.0)
    };
    let mut left: Vec<DVec3> = pairs.iter().map(|(_, from, to)| *to - *from).collect();
    let all = left.clone();
    let mut weights = vec![1.0; pairs.len()];
    for _ in 0..ROUNDS {
        let mut products = Matrix4::<f64>::identity() * 1e-12;
        let mut right = [Vector4::<f64>::zeros(); 3];
        for (((_, from, _), moved), weight) in pairs.iter().zip(&all).zip(&weights) {
            let row = row(*from);
            products += row * row.transpose() * *weight;
            for axis in 0..3 {
                right[axis] += row * (*weight * moved[axis]);
            }
        }
        let Some(factor) = products.cholesky() else {
            break;
        };
        let x = right.map(|right| factor.solve(&right));
        for ((left, moved), (_, from, _)) in left.iter_mut().zip(&all).zip(pairs) {
            let row = row(*from);
            *left = *moved - DVec3::new(x[0].dot(&row), x[1].dot(&row), x[2].dot(&row));
        }
        let scale = 2.0 * median(&mut left.iter().map(|d| d.length()).collect::<Vec<_>>());
        for (weight, left) in weights.iter_mut().zip(&left) {
            let ratio = left.length() / (scale + 1e-9 * diagonal);
            *weight = 1.0 / ((1.0 + ratio * ratio) * (1.0 + ratio * ratio));
        }
    }
    left
}
