//! The flux at every point of the frame, interpolated: what a lattice sees in any of thousands of turns.
//!
//! The flux does not depend on how a lattice lies, so it is taken once at a fine grid, and read off between its points. That is
//! for lists of keys, each with a lattice of its own; and for scans: shapes of revolution do not say how far they were
//! turned about their axis, nor do near-spheres say how they stand at all.

use super::flux::{Cluster, Grid, Placement, RADIUS, Window, ceil, floor, weight};
use super::measurement::Axes;
use super::{Lattice, STEPS, cosine, phase};
use crate::code::Symbol;
use crate::progress::Cancelled;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// Grid points in a pitch. The error of what is read between them is then 0.2 % of the largest step, as RMS, and 1 % of the
/// smallest.
const FINENESS: f64 = 7.0;

/// The energy in a grid cell below which none of its points has a weight.
const LEAST_ENERGY: f32 = 0.1;

/// The flux and the energy of a window about any point, for one pitch: both as coefficients of cubic B-splines.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    pitch: f64,
    /// In units: a table half as large is twice as near.
    grid: Grid<[i16; 2]>,
    units: [f32; 2],
    /// The grid in blocks, and a bit for each of their points: whether there is energy.
    blocks: Vec<u64>,
}

/// Grid points along a block's edge.
const BLOCK: usize = 4;

impl Field {
    /// The field of a surface.
    pub fn new(clusters: &[Cluster], pitch: f64) -> Field {
        let scale = FINENESS / pitch;
        let positions = clusters.iter().map(|cluster| cluster.centre * scale);
        let mut sums = Grid::about(positions, FINENESS * RADIUS + 2.0, [0.0f32; 2]);
        let per_area = 1.0 / (pitch * pitch);
        for cluster in clusters {
            let piece = Cluster {
                centre: cluster.centre * scale,
                area: cluster.area * (per_area / FINENESS),
                moment: cluster.moment * per_area / pitch,
                weight: cluster.weight * per_area,
            };
            add(&piece, &mut sums);
        }
        interpolate(&mut sums);
        let units = [0, 1].map(|part| {
            let sizes = sums.values.iter().map(|value| value[part].abs());
            sizes.fold(1e-30, f32::max) / f32::from(i16::MAX)
        });
        let rounded =
            |value: &[f32; 2]| [0, 1].map(|part| (value[part] / units[part]).round() as i16);
        let mut field = Field {
            pitch,
            grid: Grid {
                low: sums.low,
                size: sums.size,
                values: sums.values.iter().map(rounded).collect(),
            },
            units,
            blocks: vec![0; sums.size.map(|size| size.div_ceil(BLOCK)).iter().product()],
        };
        for (place, value) in sums.values.iter().enumerate() {
            if value[1] > LEAST_ENERGY {
                let index = sums.index(place);
                let offset = std::array::from_fn(|axis| (index[axis] - sums.low[axis]) as usize);
                let (block, bit) = field.block(offset);
                field.blocks[block] |= bit;
            }
        }
        field
    }

    /// The block of a grid point and its bit there, by its distance from the lowest.
    fn block(&self, [i, j, k]: [usize; 3]) -> (usize, u64) {
        let [_, y, z] = self.grid.size.map(|size| size.div_ceil(BLOCK));
        let block = (i / BLOCK * y + j / BLOCK) * z + k / BLOCK;
        let bit = (i % BLOCK * BLOCK + j % BLOCK) * BLOCK + k % BLOCK;
        (block, 1 << bit)
    }

    /// Points of its table.
    pub fn len(&self) -> usize {
        self.grid.values.len()
    }

    /// The pitch that the field is for.
    pub fn pitch(&self) -> f64 {
        self.pitch
    }

    /// A point of the frame in units of the grid.
    fn scaled(&self, point: DVec3) -> DVec3 {
        point * (FINENESS / self.pitch)
    }

    /// The grid point below a scaled point, if what is needed to interpolate there is within the grid.
    fn below(&self, scaled: DVec3) -> Option<usize> {
        let index = scaled.to_array().map(floor);
        let offset: [usize; 3] =
            std::array::from_fn(|axis| index[axis].wrapping_sub(self.grid.low[axis]) as usize);
        if !(0..3).all(|axis| (1..self.grid.size[axis] - 2).contains(&offset[axis])) {
            return None;
        }
        let (block, bit) = self.block(offset);
        (self.blocks[block] & bit != 0).then(|| self.grid.place(index))
    }

    /// Whether a window about a point sees anything to speak of.
    fn sees(&self, point: DVec3) -> bool {
        self.below(self.scaled(point)).is_some()
    }

    /// Flux and weight of the window about a point.
    fn at(&self, point: DVec3) -> Option<(f64, f64)> {
        let scaled = self.scaled(point);
        self.between(self.below(scaled)?, scaled)
    }

    /// The same at a scaled point, from the place of the grid point below it.
    fn between(&self, place: usize, scaled: DVec3) -> Option<(f64, f64)> {
        let [x, y, z] = scaled
            .to_array()
            .map(|coordinate| splines(coordinate - f64::from(floor(coordinate))));
        let (plane, row) = (self.grid.size[1] * self.grid.size[2], self.grid.size[2]);
        let mut sums = [[0.0f32; 2]; 4];
        for (i, x) in x.iter().enumerate() {
            for (j, y) in y.iter().enumerate() {
                let start = place + i * plane + j * row - plane - row - 1;
                let share = x * y;
                for (sum, value) in sums.iter_mut().zip(&self.grid.values[start..start + 4]) {
                    sum[0] += share * f32::from(value[0]);
                    sum[1] += share * f32::from(value[1]);
                }
            }
        }
        let [flux, energy] = [0, 1].map(|part| {
            let terms = sums.iter().zip(z).map(|(sum, z)| sum[part] * z);
            f64::from(self.units[part] * terms.sum::<f32>())
        });
        let weight = weight(energy.max(0.0));
        (weight > 0.0).then_some((flux, weight))
    }

    /// The windows of a lattice that see enough of the surface, those that are wanted, in increasing order of index; and about how
    /// many see enough. `wanted` is asked before a window's flux and weight are known.
    pub fn windows(
        &self,
        placement: &Placement,
        mut wanted: impl FnMut(&mut Window) -> bool,
    ) -> (Vec<Window>, usize) {
        let mut windows = Vec::new();
        let mut num_seen = 0;
        self.for_each_inside(placement, |index, scaled| {
            let Some(place) = self.below(scaled) else {
                return;
            };
            num_seen += 1;
            let mut window = Window {
                index,
                flux: 0.0,
                weight: 0.0,
                dither: 0.0,
            };
            if wanted(&mut window) {
                let seen = self.between(place, scaled);
                windows.extend(seen.map(|(flux, weight)| Window {
                    flux,
                    weight,
                    ..window
                }));
            }
        });
        (windows, num_seen)
    }

    /// Calls `visit` with the lattice points that lie within the grid, in increasing order of index, and with where they are,
    /// scaled.
    fn for_each_inside(&self, placement: &Placement, mut visit: impl FnMut([i32; 3], DVec3)) {
        let low = DVec3::from_array(self.grid.low.map(f64::from));
        let high = low + DVec3::from_array(self.grid.size.map(|size| size as f64 - 1.0));
        let [mut first, mut last] = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for corner in 0..8 {
            let side = |axis: usize| [low, high][corner >> axis & 1][axis];
            let corner = DVec3::new(side(0), side(1), side(2)) * (self.pitch / FINENESS);
            let corner = placement.lattice(corner);
            (first, last) = (first.min(corner), last.max(corner));
        }
        let ([i0, j0, k0], [i1, j1, k1]) = (
            first.to_array().map(ceil),
            last.to_array().map(|last| last as i32),
        );
        let along = self.scaled(placement.rotation.z_axis * placement.pitch);
        for i in i0..=i1 {
            for j in j0..=j1 {
                let foot = self.scaled(placement.point(DVec3::new(i.into(), j.into(), 0.0)));
                // Where the line from there on is between each two sides.
                let (a, b) = ((low - foot) / along, (high - foot) / along);
                let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
                let (enter, leave) = (enter.max(k0.into()), leave.min(k1.into()));
                let mut k = enter.ceil();
                while k <= leave {
                    visit([i, j, k as i32], foot + along * k);
                    k += 1.0;
                }
            }
        }
    }
}

/// Adds a piece of surface, its centre in units of the grid, to all windows that see it.
fn add(piece: &Cluster, sums: &mut Grid<[f32; 2]>) {
    const REACH: f64 = FINENESS * RADIUS;
    let (y, area) = (piece.centre, piece.area);
    let [x0, y0, _] = (y - REACH).to_array().map(ceil);
    for i in x0.. {
        let x = y.x - f64::from(i);
        if x <= -REACH {
            break;
        }
        for j in y0.. {
            let dy = y.y - f64::from(j);
            let left = REACH * REACH - x * x - dy * dy;
            if left <= 0.0 {
                if dy < 0.0 {
                    break;
                }
                continue;
            }
            let half = left.sqrt();
            let first = ceil(y.z - half);
            let count = (ceil(y.z + half) - first) as usize;
            let place = sums.place([i, j, first]);
            let across = (x * area.x + dy * area.y + piece.moment) as f32;
            let [left, z, z_area] = [left, y.z - f64::from(first), area.z].map(|f| f as f32);
            let weight = piece.weight as f32;
            for (k, sum) in sums.values[place..place + count].iter_mut().enumerate() {
                let z = z - k as f32;
                let inside = (left - z * z) * (1.0 / (REACH * REACH)) as f32;
                let g = inside * (7.0 * inside - 4.0);
                sum[0] += inside * inside * (across + z * z_area);
                sum[1] += weight * g * g;
            }
        }
    }
}

/// The values of the cubic B-splines about the points -1, 0, 1 and 2 at t, 0 to 1.
fn splines(t: f64) -> [f32; 4] {
    let u = 1.0 - t;
    let splines = [
        u * u * u / 6.0,
        (4.0 - 3.0 * t * t * (2.0 - t)) / 6.0,
        (4.0 - 3.0 * u * u * (2.0 - u)) / 6.0,
        t * t * t / 6.0,
    ];
    splines.map(|spline| spline as f32)
}

/// Replaces values by the coefficients of the cubic B-splines that go through them: a recursive filter there and back along
/// each axis (Unser, Aldroubi and Eden 1991). All is zero beyond the grid.
fn interpolate(grid: &mut Grid<[f32; 2]>) {
    /// The square root of 3, minus 2: the root of `z^2 + 4 z + 1` within the unit circle.
    const POLE: f32 = -0.267_949_2;
    let [nx, ny, nz] = grid.size;
    for (stride, len) in [(ny * nz, nx), (nz, ny), (1, nz)] {
        for line in grid.values.chunks_exact_mut(stride * len) {
            for place in stride..line.len() {
                let before = line[place - stride];
                let value = &mut line[place];
                *value = [0, 1].map(|part| value[part] + POLE * before[part]);
            }
            for place in (0..line.len()).rev() {
                let after = line
                    .get(place + stride)
                    .map_or([0.0; 2], |value| value.map(|v| v / 6.0));
                let value = &mut line[place];
                *value = [0, 1].map(|part| 6.0 * POLE * (after[part] - value[part]));
            }
        }
    }
}

/// What a scan found.
pub struct Found {
    /// How well the pilots agree, in nats.
    pub evidence: f64,
    pub turn: DMat3,
    pub step: f64,
}

/// A pilot's window in the frame before it is turned, and its dither.
struct Pilot {
    point: DVec3,
    dither: f64,
}

/// Angles about an axis: half a degree apart.
const ANGLES: usize = 720;
/// Rotations, spread evenly, when no axis is known: some 5 degrees apart.
const ROTATIONS: usize = 60_000;
/// Pilots that look at each rotation, and rotations that all pilots look at again.
const SCOUTS: usize = 200;
const REVIEWED: usize = 40;

/// The turn of a surface's frame at which the pilots agree best: about the third axis where the first two are near, about the
/// first where the last two are, any rotation where all are.
pub fn scan(
    field: &Field,
    clusters: &[Cluster],
    axes: [Axes; 2],
    lattice: &Lattice,
    report: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<Found, Cancelled> {
    let turns = match axes {
        [Axes::Undetermined, Axes::Undetermined] => everywhere(),
        [Axes::Undetermined, _] => about(DVec3::Z, DVec3::X),
        [_, _] => about(DVec3::X, DVec3::Z),
    };
    let pilots = field.pilots(lattice, clusters, &turns);
    let scouts = if turns.len() > 4 * ANGLES {
        SCOUTS
    } else {
        pilots.len()
    };
    let scouts = &pilots[..scouts.min(pilots.len())];
    let mut best: Vec<Found> = Vec::new();
    for (number, &turn) in turns.iter().enumerate() {
        if number % 1024 == 0 {
            report(number as f64 / turns.len() as f64)?;
        }
        let found = field.look(scouts, turn);
        let place = best.partition_point(|other| other.evidence >= found.evidence);
        if place < REVIEWED {
            best.insert(place, found);
            best.truncate(REVIEWED);
        }
    }
    let reviewed = best.iter().map(|found| field.look(&pilots, found.turn));
    let nothing = Found {
        evidence: 0.0,
        turn: DMat3::IDENTITY,
        step: STEPS[0],
    };
    Ok(reviewed.fold(nothing, |best, found| {
        if found.evidence > best.evidence {
            found
        } else {
            best
        }
    }))
}

impl Field {
    /// The pilots that see the surface in a good part of the turns.
    fn pilots(&self, lattice: &Lattice, clusters: &[Cluster], turns: &[DMat3]) -> Vec<Pilot> {
        let reach = clusters
            .iter()
            .map(|cluster| cluster.centre.length())
            .fold(0.0, f64::max);
        let placement = lattice.placed(DMat3::IDENTITY, self.pitch);
        let corners = [-reach, reach].map(DVec3::splat).into_iter();
        let all = Grid::about(corners.map(|corner| corner / self.pitch), RADIUS + 1.0, ());
        let samples: Vec<DMat3> = (0..16).map(|part| turns[part * turns.len() / 16]).collect();
        let pilot = |place| {
            let index: [i32; 3] = all.index(place);
            let point = placement.point(DVec3::from_array(index.map(f64::from)));
            let often = samples
                .iter()
                .filter(|turn| self.sees(**turn * point))
                .count();
            if often < samples.len() / 4 {
                return None;
            }
            let (dither, symbol) = lattice.at(index);
            (symbol == Symbol::Pilot).then_some(Pilot { point, dither })
        };
        (0..all.values.len()).filter_map(pilot).collect()
    }

    /// How well pilots agree in a turn, with the step that suits them best.
    fn look(&self, pilots: &[Pilot], turn: DMat3) -> Found {
        let mut sums = [0.0; STEPS.len()];
        let mut energy = 0.0;
        for pilot in pilots {
            let Some((flux, weight)) = self.at(turn * pilot.point) else {
                continue;
            };
            energy += weight * weight;
            for (sum, step) in sums.iter_mut().zip(STEPS) {
                *sum += weight * cosine(phase(flux * self.pitch / step, pilot.dither));
            }
        }
        let (mut sum, mut step) = (0.0, STEPS[0]);
        for (other, other_step) in sums.into_iter().zip(STEPS) {
            if other > sum {
                (sum, step) = (other, other_step);
            }
        }
        Found {
            evidence: if sum > 0.0 { sum * sum / energy } else { 0.0 },
            turn,
            step,
        }
    }
}

/// Turns about an axis, each also with the axis turned over about another.
fn about(axis: DVec3, other: DVec3) -> Vec<DMat3> {
    let turn = |axis: DVec3, angle: f64| {
        let half = axis * libm::sin(0.5 * angle);
        DMat3::from_quat(DQuat::from_xyzw(
            half.x,
            half.y,
            half.z,
            libm::cos(0.5 * angle),
        ))
    };
    let over = [DMat3::IDENTITY, turn(other, PI)];
    (0..ANGLES)
        .flat_map(|number| {
            let about = turn(axis, TAU * number as f64 / ANGLES as f64);
            over.map(|over| about * over)
        })
        .collect()
}

/// Rotations spread evenly over SO(3): super-Fibonacci spirals (Alexa 2022, equation 3).
fn everywhere() -> Vec<DMat3> {
    const PHI: f64 = std::f64::consts::SQRT_2;
    const PSI: f64 = 1.533_751_168_755_204;
    let rotation = |number: usize| {
        let s = number as f64 + 0.5;
        let t = s / ROTATIONS as f64;
        let (r, big) = (t.sqrt(), (1.0 - t).sqrt());
        let (alpha, beta) = (TAU * s / PHI, TAU * s / PSI);
        DMat3::from_quat(DQuat::from_xyzw(
            r * libm::sin(alpha),
            r * libm::cos(alpha),
            big * libm::sin(beta),
            big * libm::cos(beta),
        ))
    };
    (0..ROTATIONS).map(rotation).collect()
}
