//! How rough a surface is, vertex by vertex: where a displacement will not be seen.

use super::face_areas;
use crate::mesh::{Edges, Mesh};
use glam::DVec3;

/// The cosine of the angle, 40 degrees, from which on an edge is a crease: what is beyond it is another side.
const CREASE: f64 = 0.77;

/// V roughnesses of an oriented mesh: the RMS angle, in radians, by which the normals of the faces about a vertex leave a smooth
/// field.
///
/// A smooth field is the normals after 12 half-steps to the neighbours' mean. Curvature alone does not count. Neither does a crease:
/// nothing is averaged across it, and of the sides that meet at a vertex, the smoothest is taken. (Perceptual metrics such as
/// MSDM, Lavoue et al. 2006, rate distortions by the roughness that masks them.)
pub fn roughness(mesh: &Mesh, edges: &Edges) -> Vec<f64> {
    let normals: Vec<DVec3> = face_areas(mesh)
        .into_iter()
        .map(DVec3::normalize_or_zero)
        .collect();
    let pairs = edges.pairs().map(|pair| pair.faces);
    let joined: Vec<[u32; 2]> = pairs
        .filter(|[a, b]| normals[*a as usize].dot(normals[*b as usize]) > CREASE)
        .collect();
    let mut smooth = normals.clone();
    for _ in 0..12 {
        smooth = half_step(&smooth, &joined, DVec3::ZERO);
    }
    let mut square: Vec<f64> = normals
        .iter()
        .zip(&smooth)
        .map(|(normal, smooth)| normal.distance_squared(smooth.normalize_or_zero()))
        .collect();
    for _ in 0..12 {
        square = half_step(&square, &joined, 0.0);
    }
    let mut least = vec![f64::INFINITY; mesh.positions.len()];
    for (triangle, square) in mesh.triangles.iter().zip(square) {
        for &vertex in triangle {
            least[vertex as usize] = least[vertex as usize].min(square);
        }
    }
    least.into_iter().map(f64::sqrt).collect()
}

/// Half of each value and half of its neighbours' mean.
fn half_step<T>(values: &[T], joined: &[[u32; 2]], zero: T) -> Vec<T>
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let mut sums = vec![(zero, 0u32); values.len()];
    for &[a, b] in joined {
        for (face, neighbour) in [(a, b), (b, a)] {
            let (sum, number) = &mut sums[face as usize];
            *sum = *sum + values[neighbour as usize];
            *number += 1;
        }
    }
    let step = |(&value, (sum, number)): (&T, (T, u32))| match number {
        0 => value,
        _ => value * 0.5 + sum * (0.5 / f64::from(number)),
    };
    values.iter().zip(sums).map(step).collect()
}
