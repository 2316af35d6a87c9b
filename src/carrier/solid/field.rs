//! The flux at every point of the frame, interpolated: what a lattice sees in any of thousands of turns.
//!
//! Shapes of revolution do not say how far they were turned about their axis, nor do near-spheres say how they stand at all.
//! The flux does not depend on how the lattice lies, so it is taken once at a fine grid; a turn then costs an interpolation
//! for each pilot.

use super::flux::{Cluster, Grid, RADIUS, for_each_near, sensitivity, weight};
use super::measurement::Axes;
use super::{Lattice, STEPS, cosine};
use crate::code::Symbol;
use crate::progress::Cancelled;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// Grid points in a pitch.
const FINENESS: f64 = 5.0;

/// The flux and the energy of a window about any point, for one pitch.
pub struct Field {
    spacing: f64,
    grid: Grid<[f32; 2]>,
}

impl Field {
    /// The field of a surface.
    pub fn new(clusters: &[Cluster], pitch: f64) -> Field {
        let spacing = pitch / FINENESS;
        let positions = clusters.iter().map(|cluster| cluster.centre / spacing);
        let mut grid = Grid::about(positions, FINENESS * RADIUS + 2.0, [0.0; 2]);
        let per_area = 1.0 / (pitch * pitch);
        for cluster in clusters {
            let (area, moment) = (cluster.area * per_area, cluster.moment * per_area / pitch);
            for_each_near(
                cluster.centre / spacing,
                FINENESS * RADIUS,
                |index, offset, q2| {
                    let place = grid.place(index);
                    let [flux, energy] = &mut grid.values[place];
                    let (window, g) = ((1.0 - q2) * (1.0 - q2), sensitivity(q2));
                    *flux += (window * ((offset / FINENESS).dot(area) + moment)) as f32;
                    *energy += (cluster.weight * per_area * g * g) as f32;
                },
            );
        }
        Field { spacing, grid }
    }

    /// The grid point below a point of the frame, if what is needed to interpolate there is within the grid.
    fn below(&self, scaled: DVec3) -> Option<usize> {
        let index = scaled
            .floor()
            .to_array()
            .map(|coordinate| coordinate as i32);
        let inside = (0..3).all(|axis| {
            let offset = i64::from(index[axis]) - i64::from(self.grid.low[axis]);
            offset >= 1 && offset + 2 < self.grid.size[axis] as i64
        });
        inside.then(|| self.grid.place(index))
    }

    /// Whether a window about a point sees anything to speak of.
    fn sees(&self, point: DVec3) -> bool {
        let seen = self
            .below(point / self.spacing)
            .map(|place| self.grid.values[place][1]);
        seen.is_some_and(|energy| weight(f64::from(energy)) > 0.0)
    }

    /// Flux, by cubics through four grid points along each axis, and weight of the window about a point.
    pub fn at(&self, point: DVec3) -> Option<(f64, f64)> {
        let scaled = point / self.spacing;
        let place = self.below(scaled)?;
        let [x, y, z] = (scaled - scaled.floor()).to_array().map(cubic);
        let (plane, row) = (self.grid.size[1] * self.grid.size[2], self.grid.size[2]);
        let (mut flux, mut energy) = (0.0, 0.0);
        for (i, x) in x.iter().enumerate() {
            for (j, y) in y.iter().enumerate() {
                let start = place + i * plane + j * row - plane - row - 1;
                for (value, z) in self.grid.values[start..start + 4].iter().zip(z) {
                    let share = x * y * z;
                    flux += share * f64::from(value[0]);
                    energy += share * f64::from(value[1]);
                }
            }
        }
        let weight = weight(energy.max(0.0));
        (weight > 0.0).then_some((flux, weight))
    }
}

/// Lagrange's weights of the points -1, 0, 1 and 2 at t, 0 to 1.
fn cubic(t: f64) -> [f64; 4] {
    let (a, b, c) = (t + 1.0, t - 1.0, t - 2.0);
    [
        -t * b * c / 6.0,
        a * b * c / 2.0,
        -a * t * c / 2.0,
        a * t * b / 6.0,
    ]
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
    clusters: &[Cluster],
    axes: [Axes; 2],
    lattice: &Lattice,
    pitch: f64,
    report: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<Found, Cancelled> {
    let field = Field::new(clusters, pitch);
    let turns = match axes {
        [Axes::Undetermined, Axes::Undetermined] => everywhere(),
        [Axes::Undetermined, _] => about(DVec3::Z, DVec3::X),
        [_, _] => about(DVec3::X, DVec3::Z),
    };
    let pilots = field.pilots(lattice, pitch, clusters, &turns);
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
        let found = field.look(scouts, turn, pitch);
        let place = best.partition_point(|other| other.evidence >= found.evidence);
        if place < REVIEWED {
            best.insert(place, found);
            best.truncate(REVIEWED);
        }
    }
    let reviewed = best
        .iter()
        .map(|found| field.look(&pilots, found.turn, pitch));
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
    fn pilots(
        &self,
        lattice: &Lattice,
        pitch: f64,
        clusters: &[Cluster],
        turns: &[DMat3],
    ) -> Vec<Pilot> {
        let reach = clusters
            .iter()
            .map(|cluster| cluster.centre.length())
            .fold(0.0, f64::max);
        let placement = lattice.placed(DMat3::IDENTITY, pitch);
        let corners = [-reach, reach].map(DVec3::splat).into_iter();
        let all = Grid::about(corners.map(|corner| corner / pitch), RADIUS + 1.0, ());
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
    fn look(&self, pilots: &[Pilot], turn: DMat3, pitch: f64) -> Found {
        let mut sums = [0.0; STEPS.len()];
        let mut energy = 0.0;
        for pilot in pilots {
            let Some((flux, weight)) = self.at(turn * pilot.point) else {
                continue;
            };
            energy += weight * weight;
            for (sum, step) in sums.iter_mut().zip(STEPS) {
                *sum += weight * cosine(flux * pitch / step + pilot.dither);
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
