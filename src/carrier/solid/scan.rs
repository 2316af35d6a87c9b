//! The scan over turns, where a frame does not determine its axes: shapes of revolution do not say how far they were turned about
//! their axis, nor do near-spheres say how they stand at all.

use super::cluster::Cluster;
use super::field::Field;
use super::frame::Axes;
use super::grid::Grid;
use super::lattice::{Lattice, RADIUS};
use super::quantizer::{STEPS, cosine, phase};
use crate::code::Symbol;
use crate::progress::Cancelled;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::{PI, TAU};

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
    pitch: f64,
    axes: [Axes; 2],
    lattice: &Lattice,
    report: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<Found, Cancelled> {
    let field = &Field::new(clusters, pitch);
    let turns = match axes {
        [Axes::Undetermined, Axes::Undetermined] => everywhere(),
        [Axes::Undetermined, _] => about(DVec3::Z, DVec3::X),
        [_, _] => about(DVec3::X, DVec3::Z),
    };
    let pilots = pilots(field, lattice, clusters, &turns);
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
        let found = look(field, scouts, turn);
        let place = best.partition_point(|other| other.evidence >= found.evidence);
        if place < REVIEWED {
            best.insert(place, found);
            best.truncate(REVIEWED);
        }
    }
    let reviewed = best.iter().map(|found| look(field, &pilots, found.turn));
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

/// The pilots that see the surface in a good part of the turns.
fn pilots(field: &Field, lattice: &Lattice, clusters: &[Cluster], turns: &[DMat3]) -> Vec<Pilot> {
    let reach = clusters
        .iter()
        .map(|cluster| cluster.centre.length())
        .fold(0.0, f64::max);
    let placement = lattice.placed(DMat3::IDENTITY, field.pitch);
    let corners = [-reach, reach].map(DVec3::splat).into_iter();
    let all = Grid::about(corners.map(|corner| corner / field.pitch), RADIUS + 1.0, ());
    let samples: Vec<DMat3> = (0..16).map(|part| turns[part * turns.len() / 16]).collect();
    let pilot = |place| {
        let index: [i32; 3] = all.index(place);
        let point = placement.point(DVec3::from_array(index.map(f64::from)));
        let often = samples
            .iter()
            .filter(|turn| field.sees(**turn * point))
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
fn look(field: &Field, pilots: &[Pilot], turn: DMat3) -> Found {
    let mut sums = [0.0; STEPS.len()];
    let mut energy = 0.0;
    for pilot in pilots {
        let Some((flux, weight)) = field.at(turn * pilot.point) else {
            continue;
        };
        energy += weight * weight;
        for (sum, step) in sums.iter_mut().zip(STEPS) {
            *sum += weight * cosine(phase(flux * field.pitch / step, pilot.dither));
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
