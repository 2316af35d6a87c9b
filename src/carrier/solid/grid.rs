//! A box of lattice points with a value for each: what sums over a surface are gathered in.

use glam::DVec3;

/// A box of lattice points with a value for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<T> {
    pub low: [i32; 3],
    pub size: [usize; 3],
    pub values: Vec<T>,
}

impl<T: Clone> Grid<T> {
    /// A box that holds the windows of all positions.
    pub fn about(positions: impl Iterator<Item = DVec3>, margin: f64, value: T) -> Grid<T> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for y in positions {
            low = low.min(y);
            high = high.max(y);
        }
        if !(low.is_finite() && high.is_finite()) {
            (low, high) = (DVec3::ZERO, DVec3::ZERO);
        }
        let low = (low - margin).floor();
        let size = ((high + margin).ceil() - low)
            .to_array()
            .map(|extent| extent as usize + 1);
        Grid {
            low: low.to_array().map(|coordinate| coordinate as i32),
            size,
            values: vec![value; size[0] * size[1] * size[2]],
        }
    }

    /// Where the value of a lattice point is, if it is in the box.
    pub fn find(&self, index: [i32; 3]) -> Option<usize> {
        let inside = |axis: usize| {
            let offset = index[axis] - self.low[axis];
            offset >= 0 && (offset as usize) < self.size[axis]
        };
        (0..3).all(inside).then(|| self.place(index))
    }

    /// Where the value of a lattice point is that is known to be in the box.
    pub fn place(&self, index: [i32; 3]) -> usize {
        let [i, j, k] = [0, 1, 2].map(|axis| (index[axis] - self.low[axis]) as usize);
        (i * self.size[1] + j) * self.size[2] + k
    }

    /// The lattice point of a place.
    pub fn index(&self, place: usize) -> [i32; 3] {
        let [_, y, z] = self.size;
        let part = |axis: usize, offset: usize| self.low[axis] + offset as i32;
        [
            part(0, place / (y * z)),
            part(1, place / z % y),
            part(2, place % z),
        ]
    }
}

/// The smallest whole number that is not below a coordinate.
pub fn ceil(coordinate: f64) -> i32 {
    let whole = coordinate as i32;
    whole + i32::from(f64::from(whole) < coordinate)
}

/// The largest whole number that is not above a coordinate.
pub fn floor(coordinate: f64) -> i32 {
    let whole = coordinate as i32;
    whole - i32::from(f64::from(whole) > coordinate)
}
