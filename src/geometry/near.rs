//! Points that are near others: the nearest in a k-d tree, those within a radius in cells.

use glam::DVec3;
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
}

/// Points of space in cells as wide as a radius: what is within it is in 27 of them.
pub struct Around {
    radius: f64,
    /// Every point's cell and number, in order.
    cells: Vec<([i64; 3], u32)>,
    points: Vec<DVec3>,
}

impl Around {
    /// Sorts points.
    pub fn new(points: Vec<DVec3>, radius: f64) -> Around {
        let named = points.iter().zip(0..);
        let mut cells: Vec<_> = named
            .map(|(p, number)| (cell(*p, radius), number))
            .collect();
        cells.sort_unstable();
        Around {
            radius,
            cells,
            points,
        }
    }

    /// Those within the radius of a point: squared distance and number, cell after cell.
    pub fn of(&self, point: DVec3) -> Vec<(f64, u32)> {
        let [x, y, z] = cell(point, self.radius);
        let mut found = Vec::new();
        for (x, y) in (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| (x, y))) {
            let first = self.cells.partition_point(|(own, _)| *own < [x, y, z - 1]);
            let row = self.cells[first..].iter();
            for &(_, number) in row.take_while(|(own, _)| *own <= [x, y, z + 1]) {
                let square = self.points[number as usize].distance_squared(point);
                if square <= self.radius * self.radius {
                    found.push((square, number));
                }
            }
        }
        found
    }
}

fn cell(point: DVec3, width: f64) -> [i64; 3] {
    (point / width).floor().to_array().map(|x| x as i64)
}
