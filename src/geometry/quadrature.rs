//! Integrals over a surface: as many sample points as a given resolution needs.

use glam::DVec3;

/// One part of a triangle, seen from its centroid.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Weights of the triangle's corners at the part's centroid.
    pub weights: [f64; 3],
    /// The centroid, in scene units.
    pub point: DVec3,
}

/// Splits are no deeper than this: 4096 parts.
const DEEPEST: u32 = 6;

/// Splits triangles into parts whose edges are no longer than a limit.
pub struct Quadrature {
    max_edge: f64,
    deepest: u32,
    /// By depth, the centroids of a triangle's `4^depth` equal parts, in barycentric coordinates.
    centroids: Vec<Vec<[f64; 3]>>,
}

impl Quadrature {
    /// A quadrature with edges up to `max_edge`, in scene units.
    pub fn new(max_edge: f64) -> Quadrature {
        Quadrature {
            max_edge,
            deepest: DEEPEST,
            centroids: (0..=DEEPEST).map(centroids).collect(),
        }
    }

    /// The same for triangles that are to be no more parts than a number, or than they are: all splits are then less deep, and
    /// some edges longer. Without a limit, a few kilobytes of needles cost as much as a scanned statue.
    pub fn at_most(
        self,
        num_parts: u64,
        triangles: impl Iterator<Item = [DVec3; 3]>,
    ) -> Quadrature {
        let mut by_depth = [0u64; DEEPEST as usize + 1];
        triangles.for_each(|corners| by_depth[self.depth(corners) as usize] += 1);
        let parts = |deepest: u32| -> u64 {
            let by_depth = by_depth.iter().zip(0..);
            by_depth
                .map(|(number, depth)| number << (2 * deepest.min(depth)))
                .sum()
        };
        Quadrature {
            deepest: (1..=DEEPEST)
                .rev()
                .find(|&deepest| parts(deepest) <= num_parts)
                .unwrap_or(0),
            ..self
        }
    }

    /// How deep a triangle is split.
    fn depth(&self, [a, b, c]: [DVec3; 3]) -> u32 {
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        (0..self.deepest)
            .find(|&depth| longest <= self.max_edge * f64::from(1 << depth))
            .unwrap_or(self.deepest)
    }

    /// The samples of a triangle, one for each part, after the area that each part has, times the triangle's normal. Moments of the
    /// first order are exact in every part.
    pub fn samples(&self, [a, b, c]: [DVec3; 3]) -> (DVec3, impl Iterator<Item = Sample>) {
        let depth = self.depth([a, b, c]);
        let weights = &self.centroids[depth as usize];
        let area = (b - a).cross(c - a) * (0.5 / weights.len() as f64);
        let samples = weights.iter().map(move |&weights| Sample {
            weights,
            point: a * weights[0] + b * weights[1] + c * weights[2],
        });
        (area, samples)
    }
}

fn centroids(depth: u32) -> Vec<[f64; 3]> {
    let side = 1u32 << depth;
    let third = 1.0 / 3.0;
    let at = |i: f64, j: f64| {
        let (u, v) = (i / f64::from(side), j / f64::from(side));
        [1.0 - u - v, u, v]
    };
    let upright = (0..side)
        .flat_map(|i| (0..side - i).map(move |j| (f64::from(i) + third, f64::from(j) + third)));
    let inverted = (0..side).flat_map(|i| {
        (0..(side - i).saturating_sub(1))
            .map(move |j| (f64::from(i) + 2.0 * third, f64::from(j) + 2.0 * third))
    });
    upright.chain(inverted).map(|(i, j)| at(i, j)).collect()
}
