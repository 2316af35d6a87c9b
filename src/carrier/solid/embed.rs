//! Embedding by majorise-minimise on the detector's own statistic, with every vertex free to move in space.
//!
//! Each round linearizes the windows' fluxes in the displacement, weighs each window by how near its lattice it is (see
//! RING's embedder), and solves the ridge problem ([`Problem`]). The frame is measured again in every round.

use super::cluster::clusters;
use super::frame::is_determined;
use super::freedom::{freedoms, typical};
use super::lattice::{Lattice, Placement};
use super::pitch::{AREAS, AREAS_TO_EMBED, pitches};
use super::problem::Problem;
use super::quantizer::{cosine, steps_for};
use super::window::{Window, windows};
use crate::carrier::qim::curvature;
use crate::carrier::{Carrier, CarrierError, Embedded, Host, Mark, Needs};
use crate::detection::Statistic;
use crate::geometry::{Pose, diagonal, oriented, rounded_for_web};
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress, Stage, step};
use glam::{DMat3, DVec3};

const ROUNDS: usize = 8;
/// Weight that is left to a window half a step from its lattice.
const LEAST_WEIGHT: f64 = 0.02;
/// No vertex moves more than so many times the RMS limit, and less where its freedom is less than is typical. The second is
/// for models in which a few vertices hold up large parts.
pub(super) const CLAMPS: [f64; 2] = [3.0, 6.0];

/// Windows that a vertex can serve: it has three freedoms. Of 28 models with few vertices none held more than 0.7 nats for a vertex, so a
/// mark of so many nats needs as many vertices at least.
const WINDOWS_PER_VERTEX: usize = 3;

/// 62 would do for the payload, a chance of 10^-9 and the tests, and the decoder is right from 75 to 80 on; 29 would do for a chance of
/// 10^-9 and the tests.
const NEEDS: Needs = Needs {
    sturdy: 125.0,
    payload: 90.0,
    presence: 45.0,
};

/// The same where a detector has to scan: the pilots are spent on that, and two thirds of the symbols are left to testify.
const NEEDS_SCANNED: Needs = Needs {
    sturdy: 188.0,
    payload: 135.0,
    presence: 67.0,
};

/// What is below this part of the needed exponent after every step of a limit is given the whole limit at once, and is given up with that: of
/// 66 models that were tried, on the way to enough none was below 0.47 of it. What is below the second part after some rounds of an attempt,
/// ends the attempt. Surfaces of long needles, whose rounds take a second, so end in some seconds.
const HOPEFUL: f64 = 0.25;
const BEGUN: f64 = 1.0 / 32.0;
const FIRST_ROUNDS: usize = 3;

/// Steps smaller than the strength's own are tried until the exponent is so many times what a sturdy mark needs, so many in all.
const ENOUGH: f64 = 1.2;
const STEPS_TRIED: usize = 4;

/// Gives the host the mark in its own frame. It has to reach what is `worth` it of the exponents that are needed.
pub fn embed_in_frame(
    host: &Host,
    mark: &Mark,
    worth: fn(&Needs) -> f64,
    progress: &mut dyn Progress,
) -> Result<Embedded, CarrierError> {
    let num_vertices = host.mesh.positions.len();
    let none = |available| CarrierError::TooFewAddresses {
        carrier: Carrier::Solid,
        needed: WINDOWS_PER_VERTEX * worth(&NEEDS) as usize,
        available,
        vertices: num_vertices,
    };
    if (num_vertices as f64) < worth(&NEEDS) {
        return Err(none(WINDOWS_PER_VERTEX * num_vertices));
    }
    let (mesh, boundary) = oriented(host.mesh);
    let pose = Pose::of_oriented(&mesh, &boundary).ok_or_else(|| none(0))?;
    step(progress, Stage::Embed, 0.0)?;
    let area = mesh.area() / (pose.size * pose.size);
    let candidates: Vec<f64> = pitches(area, AREAS_TO_EMBED).collect();
    let finest = pitches(area, AREAS).fold(f64::INFINITY, f64::min);
    let whole = host.rms_rel * diagonal(&mesh.positions);
    let freedom = freedoms(&mesh, &boundary, host, CLAMPS[0]);
    let typical = typical(&freedom);
    let needs = match is_determined(&pose) {
        true => NEEDS,
        false => NEEDS_SCANNED,
    };
    let enough = ENOUGH * needs.sturdy;
    let mut embedder = Embedder {
        host,
        lattice: &Lattice::of(mark.key),
        mark,
        finest,
        limit: whole,
        freedom,
        typical,
        boundary,
        pose,
        mesh: &mesh,
    };
    let mut best = Attempt::default();
    // What is seen is better than no mark: a hidden one gets more of the limit until there is one.
    let least = if host.hidden { typical } else { 1.0 };
    let shares = std::iter::successors(Some(least), |share| Some(2.0 * share));
    let hidden = shares
        .take_while(|share| *share < 1.0)
        .map(|share| (share, CLAMPS[0]));
    let mut tried = 0.0;
    for (share, clamp) in hidden.chain(CLAMPS.map(|clamp| (1.0, clamp))) {
        let is_hopeful = tried == 0.0 || best.exponent >= HOPEFUL * worth(&needs);
        if best.exponent > needs.sturdy || (tried == 1.0 && !is_hopeful) {
            break;
        }
        if is_hopeful || share == 1.0 {
            embedder.limit = whole * share;
            embedder.at_pitches(&candidates, clamp, enough, &mut best, progress)?;
            tried = share;
        }
    }
    step(progress, Stage::Embed, 1.0)?;
    let needed = worth(&needs);
    if best.exponent < needed {
        return Err(CarrierError::TooWeak {
            carrier: Carrier::Solid,
            reached: best.exponent,
            needed,
        });
    }
    Ok(Embedded {
        displacement: best.displacement,
        carrier: Carrier::Solid,
        exponent: best.exponent,
        needs,
    })
}

struct Embedder<'a> {
    host: &'a Host<'a>,
    mark: &'a Mark<'a>,
    lattice: &'a Lattice,
    /// The host, oriented.
    mesh: &'a Mesh,
    boundary: Vec<(u32, u32)>,
    pose: Pose,
    /// The pitch that a detector gathers clusters for, whichever it reads: sheets that share a cell show other fluxes.
    finest: f64,
    freedom: Vec<f64>,
    /// RMS freedom.
    typical: f64,
    /// RMS limit in scene units.
    limit: f64,
}

/// What one pitch and step reach, once a web pipeline has rounded the positions: small steps reach more, and stand less of that.
#[derive(Default)]
struct Attempt {
    exponent: f64,
    displacement: Vec<DVec3>,
}

impl Embedder<'_> {
    /// Embeds with one pitch after the other until the best of all attempts is enough.
    fn at_pitches(
        &self,
        pitches: &[f64],
        clamp: f64,
        enough: f64,
        best: &mut Attempt,
        progress: &mut dyn Progress,
    ) -> Result<(), Cancelled> {
        for &pitch in pitches {
            if best.exponent <= enough {
                self.at_pitch(pitch, clamp, enough, best, progress)?;
            }
        }
        Ok(())
    }

    /// Embeds with a pitch, and with smaller steps until the best of all attempts is enough.
    fn at_pitch(
        &self,
        pitch: f64,
        clamp: f64,
        enough: f64,
        best: &mut Attempt,
        progress: &mut dyn Progress,
    ) -> Result<(), Cancelled> {
        let placement = self.lattice.placed(DMat3::IDENTITY, pitch);
        let mut active = windows(&clusters(self.mesh, &self.pose, self.finest), &placement);
        if active.is_empty() {
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
        let steps = steps_for(self.limit / diagonal(&self.mesh.positions));
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
            let phases = self.phases(&self.moved(&displacement), placement, active, step);
            let exponent = exponent(&phases, active);
            if exponent > best.exponent {
                best = Attempt {
                    exponent,
                    displacement: displacement.clone(),
                };
            }
            let is_lost = round == FIRST_ROUNDS && best.exponent < BEGUN * NEEDS.sturdy;
            if round == ROUNDS || is_lost {
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
                displacement = solution.into_iter().map(|x| from_lattice * x).collect();
                // The RMS falls more slowly than the ridge grows.
                let excess = (self.rms(&displacement) / self.limit).clamp(0.05, 20.0);
                ridge *= excess * excess;
            }
            self.keep_to_limits(&mut displacement, clamp);
        }
        if !best.displacement.is_empty() {
            let rounded = rounded_for_web(&self.moved(&best.displacement));
            best.exponent = exponent(&self.phases(&rounded, placement, active, step), active);
        }
        Ok(best)
    }

    fn moved(&self, displacement: &[DVec3]) -> Mesh {
        let positions = self.mesh.positions.iter().zip(displacement);
        self.mesh
            .with_positions(positions.map(|(p, d)| *p + *d).collect())
    }

    fn keep_to_limits(&self, displacement: &mut [DVec3], clamp: f64) {
        displacement
            .iter_mut()
            .zip(&self.freedom)
            .for_each(|(d, freedom)| {
                *d = d.clamp_length_max(clamp * self.limit * (freedom / self.typical).min(1.0))
            });
        self.host.admissible.project(displacement);
        let scale = (self.limit / self.rms(displacement)).min(1.0);
        displacement.iter_mut().for_each(|d| *d *= scale);
        let (leeway, admissible) = (self.host.leeway, &self.host.admissible);
        leeway.keep(&self.mesh.positions, displacement, admissible);
    }

    /// The RMS of a displacement; where it is to be hidden, as if all vertices were as free as is typical: what rough parts
    /// cannot use is not for smooth ones to take.
    fn rms(&self, displacement: &[DVec3]) -> f64 {
        let square = |(d, freedom): (&DVec3, &f64)| {
            let share = if self.host.hidden {
                freedom / self.typical
            } else {
                1.0
            };
            d.length_squared() / (share * share)
        };
        let squares: f64 = displacement.iter().zip(&self.freedom).map(square).sum();
        (squares / displacement.len() as f64).sqrt()
    }

    /// The phases of the displaced mesh's fluxes at the active windows, in its own frame, the axes' signs as the host's: where parts
    /// are nearly symmetric the signs would turn over from round to round.
    fn phases(
        &self,
        moved: &Mesh,
        placement: &Placement,
        active: &[Window],
        step: f64,
    ) -> Vec<f64> {
        let pose = Pose::of_oriented(moved, &self.boundary)
            .map_or(self.pose, |pose| pose.aligned_with(&self.pose));
        let now = windows(&clusters(moved, &pose, self.finest), placement);
        let find = |index| {
            now.binary_search_by_key(&index, |window| window.index)
                .ok()
                .map(|found| now[found].flux)
        };
        active
            .iter()
            .map(|window| find(window.index).unwrap_or(window.flux) / step + window.dither)
            .collect()
    }
}

/// The exponent of the bound if phases are read with the right symbols.
fn exponent(phases: &[f64], active: &[Window]) -> f64 {
    let read = |(phase, window): (&f64, &Window)| (window.weight * cosine(*phase), window.weight);
    -Statistic::new(phases.iter().zip(active).map(read)).ln_p()
}

/// The weight of a window in a round: that of its parabola.
fn majorised((error, window): (f64, &Window)) -> f64 {
    window.weight * curvature(error).max(LEAST_WEIGHT)
}
