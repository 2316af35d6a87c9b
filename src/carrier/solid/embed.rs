//! Embedding by majorise-minimise on the detector's own statistic, with every vertex free to move in space.
//!
//! Each round linearizes the windows' fluxes in the displacement, weighs each window by how near its lattice it is (see
//! RING's embedder), and solves the ridge problem ([`Problem`]). The frame is measured again in every round.

use super::flux::{Placement, Window, clusters, windows};
use super::measurement::{Axes, axes_of};
use super::problem::Problem;
use super::{AREAS_TO_EMBED, Lattice, cosine, pitches, pose_of, steps_for};
use crate::carrier::{Carrier, CarrierError, Host, Mark};
use crate::detection::Statistic;
use crate::geometry::{Pose, diagonal, oriented, roughness};
use crate::mesh::{Edges, Mesh};
use crate::progress::{Cancelled, Progress, Stage, step};
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

const ROUNDS: usize = 8;
/// Weight that is left to a window half a step from its lattice.
const LEAST_WEIGHT: f64 = 0.02;
/// No vertex moves more than so many times the RMS limit, and less where its freedom is less than is typical. The second is
/// for models in which a few vertices hold up large parts.
const CLAMPS: [f64; 2] = [3.0, 6.0];

/// The roughness in radians about which a displacement within the limit stays unseen.
const MASKING: f64 = 0.05;
/// The range of freedoms: 1 is that of a vertex whose surroundings are as rough as that.
const FREEDOMS: std::ops::RangeInclusive<f64> = 0.25..=1.0;
/// What an open boundary leaves of a freedom: its outline is seen against what is behind.
const BOUNDARY: f64 = 0.5;
/// Windows without which a mark of 48 bits cannot be read.
pub const NEEDED_WINDOWS: usize = 100;

/// The exponent below which a mark is left to another carrier: 62 would do for the payload, a chance of 10^-9 and the tests,
/// if nothing happened to the model.
const NEEDED_EXPONENT: f64 = 125.0;

/// Steps smaller than the strength's own are tried until the exponent is this, so many in all.
const ENOUGH: f64 = 150.0;
const STEPS_TRIED: usize = 4;

/// The displacement of all V vertices that gives the host the mark.
pub fn embed(
    host: &Host,
    mark: &Mark,
    progress: &mut dyn Progress,
) -> Result<Vec<DVec3>, CarrierError> {
    let (mesh, boundary) = oriented(host.mesh);
    let none = |available| CarrierError::TooFewAddresses {
        carrier: Carrier::Solid,
        needed: NEEDED_WINDOWS,
        available,
        vertices: mesh.positions.len(),
    };
    let pose = pose_of(&mesh, &boundary).ok_or_else(|| none(0))?;
    step(progress, Stage::Embed, 0.0)?;
    let area = mesh.area() / (pose.size * pose.size);
    let candidates: Vec<f64> = pitches(area, AREAS_TO_EMBED).collect();
    let freedom = freedoms(&mesh, &boundary);
    let typical = typical(&freedom);
    let embedder = Embedder {
        host,
        lattice: &Lattice::of(mark.key),
        mark,
        limit: host.rms_rel * diagonal(&mesh.positions),
        freedom,
        typical,
        boundary,
        pose,
        mesh: &mesh,
    };
    let steps = steps_for(host.rms_rel);
    // Where a detector has to scan, the pilots are spent on that, and two thirds of the symbols are left to testify.
    let all = if axes_of(&pose).contains(&Axes::Undetermined) {
        1.5
    } else {
        1.0
    };
    let mut best = Attempt::default();
    for clamp in CLAMPS {
        for &pitch in &candidates {
            if best.exponent <= ENOUGH * all {
                embedder.at_pitch(pitch, steps, clamp, ENOUGH * all, &mut best, progress)?;
            }
        }
        if best.exponent > NEEDED_EXPONENT * all {
            break;
        }
    }
    step(progress, Stage::Embed, 1.0)?;
    if best.exponent < NEEDED_EXPONENT * all {
        return Err(CarrierError::TooWeak {
            carrier: Carrier::Solid,
            reached: best.exponent,
            needed: NEEDED_EXPONENT * all,
        });
    }
    Ok(best.displacement)
}

/// How far each of the V vertices may move, beside others: rough surroundings hide more, and outlines less.
fn freedoms(mesh: &Mesh, boundary: &[(u32, u32)]) -> Vec<f64> {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let mut freedoms: Vec<f64> = roughness(mesh, &rings)
        .into_iter()
        .map(|roughness| (roughness / MASKING).clamp(*FREEDOMS.start(), *FREEDOMS.end()))
        .collect();
    for &(vertex, _) in boundary {
        freedoms[vertex as usize] = (freedoms[vertex as usize] * BOUNDARY).max(*FREEDOMS.start());
    }
    freedoms
}

/// The RMS freedom.
fn typical(freedoms: &[f64]) -> f64 {
    let square: f64 = freedoms.iter().map(|freedom| freedom * freedom).sum();
    (square / freedoms.len() as f64).sqrt()
}

struct Embedder<'a> {
    host: &'a Host<'a>,
    mark: &'a Mark<'a>,
    lattice: &'a Lattice,
    /// The host, oriented.
    mesh: &'a Mesh,
    boundary: Vec<(u32, u32)>,
    pose: Pose,
    freedom: Vec<f64>,
    /// RMS freedom.
    typical: f64,
    /// RMS limit in scene units.
    limit: f64,
}

/// What one pitch and step reach.
#[derive(Default)]
struct Attempt {
    exponent: f64,
    displacement: Vec<DVec3>,
}

impl Embedder<'_> {
    /// Embeds with a pitch, and with smaller steps until the best of all attempts is enough.
    fn at_pitch(
        &self,
        pitch: f64,
        steps: &[f64],
        clamp: f64,
        enough: f64,
        best: &mut Attempt,
        progress: &mut dyn Progress,
    ) -> Result<(), Cancelled> {
        let placement = self.lattice.placed(DMat3::IDENTITY, pitch);
        let mut active = windows(&clusters(self.mesh, &self.pose, pitch), &placement);
        if active.len().min(3 * self.mesh.positions.len()) < NEEDED_WINDOWS {
            return Ok(());
        }
        // What is to be added to a window's phase so that whole numbers carry its symbol.
        for window in &mut active {
            let (dither, symbol) = self.lattice.at(window.index);
            let coset = if self.mark.codeword.sign(symbol) > 0.0 {
                0.0
            } else {
                0.5
            };
            window.dither = dither - coset;
        }
        let mut problem = Problem::new(self.mesh, &self.pose, &placement, &active, &self.freedom);
        for &step in steps.iter().take(STEPS_TRIED) {
            let attempt = self.attempt(
                &mut problem,
                &placement,
                &active,
                step / pitch,
                clamp,
                progress,
            )?;
            if attempt.exponent > best.exponent {
                *best = attempt;
            }
            if best.exponent > enough {
                break;
            }
        }
        Ok(())
    }

    /// Embeds with a step in lattice coordinates.
    fn attempt(
        &self,
        problem: &mut Problem,
        placement: &Placement,
        active: &[Window],
        step: f64,
        clamp: f64,
        progress: &mut dyn Progress,
    ) -> Result<Attempt, Cancelled> {
        let pitch = placement.pitch;
        let to_lattice =
            (self.pose.axes * placement.rotation).transpose() * (1.0 / (self.pose.size * pitch));
        let from_lattice = self.pose.axes * placement.rotation * (self.pose.size * pitch);
        let mut displacement = vec![DVec3::ZERO; self.mesh.positions.len()];
        let mut best = Attempt {
            exponent: 0.0,
            displacement: Vec::new(),
        };
        let mut ridge = problem.mean_diagonal();
        for round in 0..=ROUNDS {
            crate::progress::step(progress, Stage::Embed, round as f64 / ROUNDS as f64)?;
            let fluxes = self.fluxes(&displacement, placement, active);
            let phases: Vec<f64> = fluxes
                .iter()
                .zip(active)
                .map(|(flux, window)| flux / step + window.dither)
                .collect();
            let exponent = exponent(&phases, active);
            if exponent > best.exponent {
                best = Attempt {
                    exponent,
                    displacement: displacement.clone(),
                };
            }
            if round == ROUNDS {
                break;
            }
            let errors = phases.iter().map(|phase| phase.round() - phase);
            let weights: Vec<f64> = errors.clone().zip(active).map(majorised).collect();
            let now = displacement.iter().map(|d| to_lattice * *d);
            let goals: Vec<f64> = problem
                .times(now)
                .iter()
                .zip(errors)
                .map(|(a, b)| a + b * step)
                .collect();
            let tries = if round == 0 { 4 } else { 1 };
            for _ in 0..tries {
                let solution = problem.solve(&goals, &weights, ridge);
                let square: f64 = solution.iter().map(|x| x.length_squared()).sum();
                let rms = (square / solution.len() as f64).sqrt() * self.pose.size * pitch;
                displacement = solution.into_iter().map(|x| from_lattice * x).collect();
                // The RMS falls more slowly than the ridge grows.
                let excess = (rms / self.limit).clamp(0.05, 20.0);
                ridge *= excess * excess;
            }
            self.keep_to_limits(&mut displacement, clamp);
        }
        Ok(best)
    }

    fn keep_to_limits(&self, displacement: &mut [DVec3], clamp: f64) {
        displacement
            .iter_mut()
            .zip(&self.freedom)
            .for_each(|(d, freedom)| {
                *d = d.clamp_length_max(clamp * self.limit * (freedom / self.typical).min(1.0))
            });
        self.host.admissible.project(displacement);
        let square: f64 = displacement.iter().map(|d| d.length_squared()).sum();
        let rms = (square / displacement.len() as f64).sqrt();
        let scale = (self.limit / rms).min(1.0);
        displacement.iter_mut().for_each(|d| *d *= scale);
    }

    /// The fluxes of the displaced mesh at the active windows, in its own frame, the axes' signs as the host's: where parts
    /// are nearly symmetric the signs would turn over from round to round.
    fn fluxes(&self, displacement: &[DVec3], placement: &Placement, active: &[Window]) -> Vec<f64> {
        let positions = self
            .mesh
            .positions
            .iter()
            .zip(displacement)
            .map(|(p, d)| *p + *d);
        let moved = self.mesh.with_positions(positions.collect());
        let pose =
            pose_of(&moved, &self.boundary).map_or(self.pose, |pose| pose.aligned_with(&self.pose));
        let now = windows(&clusters(&moved, &pose, placement.pitch), placement);
        let find = |index| {
            now.binary_search_by_key(&index, |window| window.index)
                .ok()
                .map(|found| now[found].flux)
        };
        active
            .iter()
            .map(|window| find(window.index).unwrap_or(window.flux))
            .collect()
    }
}

/// The exponent of the bound if phases are read with the right symbols.
fn exponent(phases: &[f64], active: &[Window]) -> f64 {
    let read = |(phase, window): (&f64, &Window)| (window.weight * cosine(*phase), window.weight);
    -Statistic::new(phases.iter().zip(active).map(read)).ln_p()
}

/// The weight of a window in the quadratic that touches its cosine from above at an error and has its minimum at 0.
fn majorised((error, window): (f64, &Window)) -> f64 {
    let angle = TAU * error.abs();
    let curvature = if angle > 0.0 {
        libm::sin(angle) / angle
    } else {
        1.0
    };
    window.weight * curvature.max(LEAST_WEIGHT)
}
