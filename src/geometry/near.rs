//! Points that are near others, in a k-d tree.

use kdtree::KdTree;
use kdtree::distance::squared_euclidean;

/// Points of N coordinates each, by their numbers.
pub struct Near<const N: usize>(KdTree<f64, u32, [f64; N]>);

impl<const N: usize> Near<N> {
    /// Sorts points; those that are not finite are left out.
    pub fn new(points: impl Iterator<Item = [f64; N]>) -> Near<N> {
        let mut tree = KdTree::with_capacity(N, 16);
        for (number, point) in (0..).zip(points) {
            // Refused is only what is not finite.
            let _ = tree.add(point, number);
        }
        Near(tree)
    }

    /// The nearest to a point, at most `count` of them, the nearest first: squared distance and number.
    pub fn nearest(&self, point: [f64; N], count: usize) -> Vec<(f64, u32)> {
        let found = self.0.nearest(&point, count, &squared_euclidean);
        let found = found.unwrap_or_default().into_iter();
        found.map(|(square, number)| (square, *number)).collect()
    }

    /// Those within a radius, the nearest first: squared distance and number.
    pub fn within(&self, point: [f64; N], radius: f64) -> Vec<(f64, u32)> {
        let found = self.0.within(&point, radius * radius, &squared_euclidean);
        let found = found.unwrap_or_default().into_iter();
        found.map(|(square, number)| (square, *number)).collect()
    }
}
