//! The linear problem of one round: which displacement takes every window to its lattice, and leaves the places where they are, at the
//! least cost.
//!
//! As SOLID's, in the dual and by conjugate gradients; but windows of several lattices have a part in it. What makes the places is
//! held by rows of its own, whose goals are 0 and whose weights are large; so are SOLID's windows, where they hold a mark.

use super::ball::{MARGIN, RADIUS};
use crate::carrier::solid::lattice::{self, Placement, for_each_near};
use crate::carrier::solid::window::{Window, sensitivity};
use crate::geometry::places::{Place, SUPPORT};
use crate::geometry::{Quadrature, conjugate_gradients};
use crate::mesh::Mesh;
use glam::DVec3;
use std::collections::BTreeMap;

const CG_STEPS: usize = 60;
const CG_TOLERANCE: f64 = 1e-4;

/// Groups of rows that hold a place: M at both widths of its frames, how it changes with the width, and along each axis.
const GROUPS: usize = 6;
/// Rows that hold a place: six entries of M in each group.
pub const ROWS_OF_PLACE: usize = 6 * GROUPS;

/// Sides of what is summed, in widths of a place and in pitches.
const EDGE_OF_PLACE: f64 = 0.2;
const EDGE_OF_WINDOW: f64 = 1.0 / 6.0;

/// How something answers to vertices that move, in units of their freedom.
type Row = Vec<(u32, DVec3)>;

pub struct Problem<'a> {
    mesh: &'a Mesh,
    freedom: &'a [f64],
    rows: Vec<Row>,
    /// The last solution of the dual: the next one is near it.
    multipliers: Vec<f64>,
}

impl<'a> Problem<'a> {
    pub fn new(mesh: &'a Mesh, freedom: &'a [f64]) -> Problem<'a> {
        Problem {
            mesh,
            freedom,
            rows: Vec::new(),
            multipliers: Vec::new(),
        }
    }

    /// Adds a row for each window of a ball.
    pub fn add_ball(&mut self, centre: DVec3, placement: &Placement, active: &[Window]) {
        let reach = (RADIUS + MARGIN) * placement.pitch;
        let triangles: Vec<[u32; 3]> = triangles_near(self.mesh, centre, reach).collect();
        self.add_windows(&triangles, placement, active);
    }

    /// Adds a row for each window, of those that see so many triangles.
    pub fn add_windows(
        &mut self,
        triangles: &[[u32; 3]],
        placement: &Placement,
        active: &[Window],
    ) {
        let pitch = placement.pitch;
        let quadrature = Quadrature::new(EDGE_OF_WINDOW * pitch);
        let numbers = active.iter().zip(0usize..);
        let row_of: BTreeMap<[i32; 3], usize> =
            numbers.map(|(window, row)| (window.index, row)).collect();
        let mut rows: Vec<BTreeMap<u32, DVec3>> = vec![BTreeMap::new(); active.len()];
        for &triangle in triangles {
            for sample in quadrature.samples(self.mesh.corners(triangle)) {
                let area = sample.area / (pitch * pitch * pitch);
                let y = placement.lattice(sample.point);
                for_each_near(y, lattice::RADIUS, |index, _, q2| {
                    if let Some(&row) = row_of.get(&index) {
                        let push = area * sensitivity(q2);
                        for (vertex, weight) in triangle.iter().zip(sample.weights) {
                            let freedom = self.freedom[*vertex as usize];
                            *rows[row].entry(*vertex).or_default() += push * (weight * freedom);
                        }
                    }
                });
            }
        }
        let rows = rows.into_iter().map(|row| row.into_iter().collect());
        self.rows.extend(rows);
    }

    /// Adds the rows that hold a place, each of a length.
    pub fn add_place(&mut self, place: &Place, length: f64) {
        let mut slots: BTreeMap<u32, usize> = BTreeMap::new();
        let mut pushes: Vec<[DVec3; ROWS_OF_PLACE]> = Vec::new();
        let quadrature = Quadrature::new(EDGE_OF_PLACE * place.width);
        let groups = groups(place);
        for triangle in triangles_near(self.mesh, place.point, 1.5 * SUPPORT * place.width) {
            let slot = triangle.map(|vertex| {
                *slots.entry(vertex).or_insert_with(|| {
                    pushes.push([DVec3::ZERO; ROWS_OF_PLACE]);
                    pushes.len() - 1
                })
            });
            for sample in quadrature.samples(self.mesh.corners(triangle)) {
                for (group, terms) in groups.iter().enumerate() {
                    let mut entries = [0.0; 6];
                    for (point, width, factor) in terms {
                        let answers = answers(sample.point - *point, *width);
                        for (entry, answer) in entries.iter_mut().zip(answers) {
                            *entry += factor * answer;
                        }
                    }
                    for (slot, weight) in slot.iter().zip(sample.weights) {
                        let rows = &mut pushes[*slot][6 * group..];
                        for (push, entry) in rows.iter_mut().zip(entries) {
                            *push += sample.area * (entry * weight);
                        }
                    }
                }
            }
        }
        let rows = (0..ROWS_OF_PLACE).map(|row| {
            let pairs = slots.iter().map(|(&vertex, &slot)| {
                let freedom = self.freedom[vertex as usize];
                (vertex, pushes[slot][row] * freedom)
            });
            let row: Row = pairs.collect();
            let square: f64 = row.iter().map(|(_, push)| push.length_squared()).sum();
            let scale = length / square.sqrt().max(f64::MIN_POSITIVE);
            row.into_iter().map(|(v, push)| (v, push * scale)).collect()
        });
        let rows: Vec<Row> = rows.collect();
        self.rows.extend(rows);
    }

    /// Each row's inner product with itself.
    pub fn diagonal(&self) -> Vec<f64> {
        let square = |row: &Row| row.iter().map(|(_, push)| push.length_squared()).sum();
        self.rows.iter().map(square).collect()
    }

    /// What a displacement of all vertices does to the rows.
    pub fn times(&self, displacement: &[DVec3]) -> Vec<f64> {
        let share = |(d, freedom): (&DVec3, &f64)| *d / *freedom;
        let x: Vec<DVec3> = displacement.iter().zip(self.freedom).map(share).collect();
        self.along(&x)
    }

    fn along(&self, x: &[DVec3]) -> Vec<f64> {
        let sum = |row: &Row| row.iter().map(|(v, push)| push.dot(x[*v as usize])).sum();
        self.rows.iter().map(sum).collect()
    }

    /// The rows times a number for each.
    fn back(&self, multipliers: &[f64]) -> Vec<DVec3> {
        let mut x = vec![DVec3::ZERO; self.freedom.len()];
        for (row, multiplier) in self.rows.iter().zip(multipliers) {
            for (vertex, push) in row {
                x[*vertex as usize] += *push * *multiplier;
            }
        }
        x
    }

    /// The displacements of all vertices that take the rows nearest to their goals.
    pub fn solve(&mut self, goals: &[f64], weights: &[f64], mu: f64) -> Vec<DVec3> {
        let mut multipliers = std::mem::take(&mut self.multipliers);
        multipliers.resize(self.rows.len(), 0.0);
        let diagonal = self.diagonal();
        let ridge: Vec<f64> = weights.iter().map(|weight| mu / weight).collect();
        let apply = |l: &[f64]| -> Vec<f64> {
            let image = self.along(&self.back(l)).into_iter();
            let own = l.iter().zip(&ridge).map(|(l, ridge)| l * ridge);
            image.zip(own).map(|(image, own)| image + own).collect()
        };
        let precondition = |r: &[f64]| -> Vec<f64> {
            let scales = diagonal.iter().zip(&ridge);
            let pairs = r.iter().zip(scales);
            pairs.map(|(r, (d, ridge))| r / (d + ridge)).collect()
        };
        conjugate_gradients(
            apply,
            precondition,
            goals,
            &mut multipliers,
            CG_TOLERANCE,
            CG_STEPS,
        );
        let mut x = self.back(&multipliers);
        x.iter_mut().zip(self.freedom).for_each(|(x, f)| *x *= *f);
        self.multipliers = multipliers;
        x
    }
}

/// Triangles with a corner within a distance of a point, or nearly.
fn triangles_near(mesh: &Mesh, point: DVec3, distance: f64) -> impl Iterator<Item = [u32; 3]> {
    mesh.triangles.iter().copied().filter(move |&triangle| {
        let [a, b, c] = mesh.corners(triangle);
        let centre = (a + b + c) / 3.0;
        let reach = [a, b, c].map(|corner| centre.distance(corner));
        centre.distance(point) < distance + reach.into_iter().fold(0.0, f64::max)
    })
}

/// Where and at what width M is taken for each group of rows, and with what factor it counts.
fn groups(place: &Place) -> [Vec<(DVec3, f64, f64)>; GROUPS] {
    const APART: f64 = 0.15;
    const WIDER: f64 = 1.1;
    let (point, width) = (place.point, place.width);
    let along = |axis: DVec3| {
        let shift = axis * (APART * width);
        vec![(point + shift, width, 1.0), (point - shift, width, -1.0)]
    };
    [
        vec![(point, width, 1.0)],
        vec![(point, 1.5 * width, 1.0)],
        vec![(point, width * WIDER, 1.0), (point, width / WIDER, -1.0)],
        along(DVec3::X),
        along(DVec3::Y),
        along(DVec3::Z),
    ]
}

/// How M, as xx, yy, zz, xy, xz, yz, answers to a surface at y from a point that moves outwards, but for a factor: the second derivatives
/// of its kernel.
fn answers(y: DVec3, width: f64) -> [f64; 6] {
    let square = (SUPPORT * width) * (SUPPORT * width);
    let left = (1.0 - y.length_squared() / square).max(0.0);
    let cube = left * left * left;
    let own = cube * cube * left / (width * width * width);
    let cross = 14.0 / square * cube * cube / (width * width * width);
    [
        own - cross * y.x * y.x,
        own - cross * y.y * y.y,
        own - cross * y.z * y.z,
        -cross * y.x * y.y,
        -cross * y.x * y.z,
        -cross * y.y * y.z,
    ]
}
