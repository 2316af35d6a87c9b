//! Mean curvature flow.

use crate::geometry::{conjugate_gradients, cotangents, unconditioned};
use crate::mesh::{Edges, Mesh};
use glam::DVec3;

const CG_TOLERANCE: f64 = 1e-8;
const CG_STEPS: usize = 1000;

/// Moves every vertex against its normal by its mean curvature, `steps` times, each for a `time` that is given in squares of the
/// mesh's mean edge: implicit fairing (Desbrun, Meyer, Schroder and Barr 1999), stable for any time. Each step solves
/// (A + t L) x' = A x for lumped areas A and the cotangent operator L of the mesh as the step finds it, by conjugate gradients.
/// A sphere stays a sphere, of a radius that falls by 2 t / r. Vertices whose rings are not closed stay.
pub fn mean_curvature_flow(mesh: &Mesh, time: f64, steps: u32) -> Mesh {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let mut flowing = mesh.clone();
    for _ in 0..steps {
        let edge = flowing.mean_edge();
        let system = System::new(&flowing, time * edge * edge, |v| rings.is_closed(v));
        for axis in 0..3 {
            let values: Vec<f64> = flowing.positions.iter().map(|p| p[axis]).collect();
            let moves = system.moves(&values);
            let moved = flowing.positions.iter_mut().zip(moves);
            moved.for_each(|(position, by)| position[axis] += by);
        }
    }
    flowing
}

/// A + t L over the vertices that are free, scaled on both sides so that its diagonal is 1.
struct System {
    /// Ends and t times half the cotangent, for every side of every face.
    springs: Vec<([u32; 2], f64)>,
    areas: Vec<f64>,
    /// The scale: 0 for vertices that stay.
    scale: Vec<f64>,
}

impl System {
    fn new(mesh: &Mesh, time: f64, is_free: impl Fn(usize) -> bool) -> System {
        let mut springs = Vec::with_capacity(3 * mesh.triangles.len());
        let mut areas = vec![0.0; mesh.positions.len()];
        for &triangle in &mesh.triangles {
            let corners: [DVec3; 3] = mesh.corners(triangle);
            let area = (corners[1] - corners[0])
                .cross(corners[2] - corners[0])
                .length()
                / 2.0;
            for (i, cotangent) in cotangents(corners).into_iter().enumerate() {
                areas[triangle[i] as usize] += area / 3.0;
                let ends = [triangle[(i + 1) % 3], triangle[(i + 2) % 3]];
                springs.push((ends, time * cotangent / 2.0));
            }
        }
        let mut diagonal = areas.clone();
        for &(ends, spring) in &springs {
            ends.iter()
                .for_each(|&end| diagonal[end as usize] += spring);
        }
        let scale = |(v, &entry): (usize, &f64)| {
            if is_free(v) && entry > 0.0 {
                1.0 / entry.sqrt()
            } else {
                0.0
            }
        };
        System {
            scale: diagonal.iter().enumerate().map(scale).collect(),
            springs,
            areas,
        }
    }

    /// t L x.
    fn pulled(&self, x: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; x.len()];
        for &([a, b], spring) in &self.springs {
            let pull = spring * (x[a as usize] - x[b as usize]);
            sums[a as usize] += pull;
            sums[b as usize] -= pull;
        }
        sums
    }

    /// x' - x.
    fn moves(&self, x: &[f64]) -> Vec<f64> {
        let scaled = |values: &[f64]| -> Vec<f64> {
            values
                .iter()
                .zip(&self.scale)
                .map(|(value, scale)| value * scale)
                .collect()
        };
        let apply = |y: &[f64]| {
            let y = scaled(y);
            let mut sums = self.pulled(&y);
            let own = sums.iter_mut().zip(&y).zip(&self.areas);
            own.for_each(|((sum, y), area)| *sum += area * y);
            scaled(&sums)
        };
        let mut target = scaled(&self.pulled(x));
        target.iter_mut().for_each(|value| *value = -*value);
        let mut moves = vec![0.0; target.len()];
        conjugate_gradients(
            apply,
            unconditioned,
            &target,
            &mut moves,
            CG_TOLERANCE,
            CG_STEPS,
        );
        scaled(&moves)
    }
}
