//! The scan over turns, where a frame does not determine its axes: shapes of revolution do not say how far they were turned about
//! their axis, nor do near-spheres say how they stand at all.

use super::cluster::Cluster;
use super::field::Field;
use super::frame::Axes;
use super::grid::Grid;
use super::lattice::{Lattice, RADIUS};
use super::quantizer::{STEPS, cosines, phase};
use crate::code::Symbol;
use crate::order::order_by;
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

/// So many pilots look at the turns that are left, and leave so many of them, those in which they agree best.
type Stage = (usize, usize);
const ALL_AT_ONCE: &[Stage] = &[(usize::MAX, 1)];
/// The more turns there are, the fewer pilots look at most of them: the first, which lie near each other, so that they agree in a wide range
/// of turns. Of 18 marks in spheres these stages find what 200 pilots at once do; pilots strewn over the surface lose four of them.
const BY_STAGES: &[Stage] = &[(100, 6_000), (200, 40), (usize::MAX, 1)];

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
    let (turns, stages) = match axes {
        [Axes::Undetermined, Axes::Undetermined] => (everywhere(), BY_STAGES),
        [Axes::Undetermined, _] => (about(DVec3::Z, DVec3::X), ALL_AT_ONCE),
        [_, _] => (about(DVec3::X, DVec3::Z), ALL_AT_ONCE),
    };
    let pilots = pilots(field, lattice, clusters, &turns);
    let mut left = turns;
    let mut best = Found {
        evidence: 0.0,
        turn: DMat3::IDENTITY,
        step: STEPS[0],
    };
    for (stage, &(scouts, number)) in stages.iter().enumerate() {
        let scouts = &pilots[..scouts.min(pilots.len())];
        let mut looks = Vec::with_capacity(left.len());
        for (number, &turn) in left.iter().enumerate() {
            if number % 1024 == 0 {
                let part = number as f64 / left.len() as f64;
                report((stage as f64 + part) / stages.len() as f64)?;
            }
            looks.push(look(field, scouts, turn));
        }
        let by_evidence = order_by(looks.iter().map(|found| !found.evidence.to_bits()));
        let kept = by_evidence.iter().take(number);
        left = kept.map(|&(_, place)| looks[place as usize].turn).collect();
        if let Some(&(_, place)) = by_evidence.first() {
            best = looks.swap_remove(place as usize);
        }
    }
    Ok(best)
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
    let per_flux = STEPS.map(|step| field.pitch / step);
    let mut sums = [0.0; STEPS.len()];
    let mut energy = 0.0;
    for pilot in pilots {
        let Some((flux, weight)) = field.at(turn * pilot.point) else {
            continue;
        };
        energy += weight * weight;
        let phases = per_flux.map(|steps| phase(flux * steps, pilot.dither));
        for (sum, cosine) in sums.iter_mut().zip(cosines(phases)) {
            *sum += weight * cosine;
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
