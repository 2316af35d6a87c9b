//! Merging points that are near each other, in one place.

use crate::order::order_by;
use glam::DVec3;

/// Merges points into the first that is near, if that one was not merged itself.
///
/// `points` are some of the positions, by their indices, in rising order, each with its class: the number of its reach in `reaches`, which
/// rise. Two points are near if their distance is at most the smaller of their reaches, and `may` allows it. What is given back are the
/// merged points, each with the one that it is merged into. O(n log n): of a cell, the last points alone are looked at.
pub fn merged(
    positions: &[DVec3],
    points: &[(u32, u8)],
    reaches: &[f64],
    may: impl Fn(u32, u32) -> bool,
) -> Vec<(u32, u32)> {
    let grid = |(class, &reach): (usize, &f64)| {
        let members = points.iter().filter(|(_, own)| usize::from(*own) >= class);
        Grid::new(
            reach,
            members.map(|&(vertex, _)| positions[vertex as usize]),
        )
    };
    let mut grids: Vec<Grid> = reaches.iter().enumerate().map(grid).collect();
    let mut merged = Vec::new();
    for &(vertex, class) in points {
        let position = positions[vertex as usize];
        let own = &mut grids[..=usize::from(class)];
        let near = own.iter().flat_map(|grid| {
            let near = grid.around(position);
            let is_near = |other: &u32| positions[*other as usize].distance(position) <= grid.reach;
            near.filter(is_near).filter(|&other| may(vertex, other))
        });
        match near.min() {
            Some(first) => merged.push((vertex, first)),
            None => own
                .iter_mut()
                .for_each(|grid| grid.insert(position, vertex)),
        }
    }
    merged
}

/// Points that are looked at in a cell before what is in it counts as near.
const FEW: usize = 8;

/// Positions that are not alone, in rising order: others are within `reach` of them. Where they are many, some that are alone are among
/// them. O(n).
pub fn crowded(positions: &[DVec3], reach: f64) -> Vec<u32> {
    let size = 4.0 * reach;
    let mask = (2 * positions.len()).next_power_of_two() as u64 - 1;
    let place = |cell: u64| (cell & mask) as usize;
    let mut last = vec![NONE; mask as usize + 1];
    let mut before = vec![NONE; positions.len()];
    for ((position, before), vertex) in positions.iter().zip(&mut before).zip(0..) {
        let last = &mut last[place(hash(cell(*position, size)))];
        (*before, *last) = (*last, vertex);
    }
    let is_crowded = |vertex: &u32| {
        let position = positions[*vertex as usize];
        let square = reach * reach;
        cells_around(position, reach, size).any(|cell| {
            let mut other = last[place(cell)];
            for _ in 0..FEW {
                if other == NONE {
                    return false;
                }
                let is_near = positions[other as usize].distance_squared(position) <= square;
                if other != *vertex && is_near {
                    return true;
                }
                other = before[other as usize];
            }
            true
        })
    };
    (0..positions.len() as u32).filter(is_crowded).collect()
}

/// Cells of four reaches, and the points in each.
struct Grid {
    reach: f64,
    /// Of each cell its hash, in rising order, and its last point's place in `points`.
    cells: Vec<(u64, u32)>,
    /// Each with the place of the one before it in its cell.
    points: Vec<(u32, u32)>,
}

/// Points that are looked at in a cell: for files that are made to cost much.
const MOST: usize = 128;

const NONE: u32 = u32::MAX;

impl Grid {
    /// An empty grid with the cells of these positions.
    fn new(reach: f64, positions: impl Iterator<Item = DVec3>) -> Grid {
        let cells = order_by(positions.map(|position| hash(cell(position, 4.0 * reach))));
        let mut cells: Vec<(u64, u32)> = cells.into_iter().map(|(cell, _)| (cell, NONE)).collect();
        cells.dedup();
        Grid {
            reach,
            cells,
            points: Vec::new(),
        }
    }

    fn find(&self, cell: u64) -> Option<usize> {
        self.cells
            .binary_search_by_key(&cell, |&(cell, _)| cell)
            .ok()
    }

    fn insert(&mut self, position: DVec3, point: u32) {
        if let Some(found) = self.find(hash(cell(position, 4.0 * self.reach))) {
            let last = &mut self.cells[found].1;
            self.points.push((point, *last));
            *last = self.points.len() as u32 - 1;
        }
    }

    /// The points that may be within reach of a position.
    fn around(&self, position: DVec3) -> impl Iterator<Item = u32> {
        let cells = cells_around(position, self.reach, 4.0 * self.reach);
        cells
            .filter_map(|cell| self.find(cell))
            .flat_map(move |found| {
                let mut place = self.cells[found].1;
                std::iter::from_fn(move || {
                    let &(point, before) = self.points.get(place as usize)?;
                    place = before;
                    Some(point)
                })
                .take(MOST)
            })
    }
}

fn cell(position: DVec3, size: f64) -> [i64; 3] {
    (position / size).to_array().map(|x| x.floor() as i64)
}

/// Equal hashes of different cells do no harm: distances are looked at.
fn hash(cell: [i64; 3]) -> u64 {
    cell.iter().fold(0, |hash: u64, &x| {
        let mixed = (hash ^ x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        mixed ^ mixed >> 29
    })
}

/// The hashes of the cells, up to eight, that a ball smaller than half a cell reaches into.
fn cells_around(position: DVec3, reach: f64, size: f64) -> impl Iterator<Item = u64> {
    let (low, high) = (cell(position - reach, size), cell(position + reach, size));
    let axes = [0, 1, 2].map(|axis| low[axis]..=high[axis]);
    let [x, y, z] = axes;
    x.flat_map(move |x| {
        let z = z.clone();
        y.clone()
            .flat_map(move |y| z.clone().map(move |z| hash([x, y, z])))
    })
}
