//! The rounds of an embedding, by majorise-minimise on the detector's own statistic, with every vertex free to move in space.
//!
//! Each round linearizes the windows' fluxes in the displacement, weighs each window by how near its lattice it is (see
//! RING's embedder), and solves the ridge problem ([`Problem`]). The frame is measured again in every round.

use super::cluster::clusters;
use super::freedom::{freedoms, typical};
use super::lattice::{Lattice, Placement};
use super::pitch::{AREAS, PITCHES, pitches};
use super::problem::Problem;
use super::quantizer::{STEPS, cosine};
use super::window::{Window, windows};
use crate::carrier::Host;
use crate::carrier::qim::curvature;
use crate::code::Codeword;
use crate::detection::Statistic;
use crate::geometry::{Pose, oriented, rounded_for_web};
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress, Stage};
use glam::DVec3;

const ROUNDS: usize = 8;
/// Rounds where the ridge is known that keeps to the limit. Of the bunny they reach 95 % of what all rounds do.
const ROUNDS_AGAIN: usize = 3;
/// Weight that is left to a window half a step from its lattice.
const LEAST_WEIGHT: f64 = 0.02;

/// Rounds after which an attempt is given up that has not begun to reach anything.
const FIRST_ROUNDS: usize = 3;

/// A host's mesh in its own frame.
pub struct Ground {
    /// Oriented.
    pub mesh: Mesh,
    boundary: Vec<(u32, u32)>,
    pub pose: Pose,
    /// The pitch that a detector gathers clusters for, whichever it reads: sheets that share a cell show other fluxes.
    finest: f64,
    freedom: Vec<f64>,
    /// RMS freedom.
    pub typical: f64,
}

impl Ground {
    /// Where no vertex is to go farther than `clamp` times its freedom; none where the surface has no frame.
    pub fn of(host: &Host, clamp: f64) -> Option<Ground> {
        let (mesh, boundary) = oriented(host.mesh);
        let pose = Pose::of_oriented(&mesh, &boundary)?;
        let freedom = freedoms(&mesh, &boundary, host, clamp);
        Some(Ground {
            finest: pitches(area(&mesh, &pose), AREAS).fold(f64::INFINITY, f64::min),
            typical: typical(&freedom),
            freedom,
            boundary,
            pose,
            mesh,
        })
    }

    /// The area of the surface in units of its frame.
    pub fn area(&self) -> f64 {
        area(&self.mesh, &self.pose)
    }

    /// The lattice's windows that see enough of the surface, without a mark.
    pub fn windows(&self, placement: &Placement) -> Vec<Window> {
        windows(&clusters(&self.mesh, &self.pose, self.finest), placement)
    }

    /// The linear problem of those windows.
    pub fn problem(&self, placement: &Placement, active: &[Window]) -> Problem<'_> {
        Problem::new(&self.mesh, &self.pose, placement, active, &self.freedom)
    }
}

fn area(mesh: &Mesh, pose: &Pose) -> f64 {
    mesh.area() / (pose.size * pose.size)
}

/// Tells windows what is to be added to their phases so that whole numbers carry their symbols.
pub fn dither(active: &mut [Window], lattice: &Lattice, codeword: &Codeword) {
    for window in active {
        let (dither, symbol) = lattice.at(window.index);
        let coset = if codeword.sign(symbol) > 0.0 {
            0.0
        } else {
            0.5
        };
        window.dither = dither - coset;
    }
}

/// What one attempt is made with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Choice {
    /// Of the lattice, in units of the frame.
    pub pitch: f64,
    /// Of the quantizer, in units of the frame.
    pub step: f64,
    /// No vertex moves more than so many times the limit.
    pub clamp: f64,
    /// RMS limit in scene units.
    pub limit: f64,
    /// What a displacement costs in the linear problem so that it keeps to the limit.
    pub ridge: f64,
}

impl Choice {
    /// Whether an embedder can have made it: others may ask for lattices of any number of points.
    pub fn is_possible(&self) -> bool {
        PITCHES.contains(&self.pitch) && STEPS.contains(&self.step)
    }
}

/// What one attempt reaches, once a web pipeline has rounded the positions: small steps reach more, and stand less of that.
#[derive(Default)]
pub struct Attempt {
    pub exponent: f64,
    pub displacement: Vec<DVec3>,
    pub choice: Choice,
}

/// Attempts to embed with a lattice.
pub struct Rounds<'a> {
    pub host: &'a Host<'a>,
    pub ground: &'a Ground,
    pub placement: &'a Placement,
    pub problem: &'a Problem<'a>,
    /// What is to be marked.
    pub active: &'a [Window],
}

impl Rounds<'_> {
    /// Embeds where nothing is known but the last solution of the dual: `choice` is without a ridge, which is found. What is below `begun`
    /// nats after some rounds is given up.
    pub fn attempt(
        &self,
        choice: Choice,
        begun: f64,
        multipliers: &mut Vec<f64>,
        progress: &mut dyn Progress,
    ) -> Result<Attempt, Cancelled> {
        let step = choice.step / self.placement.pitch;
        let mut state = State {
            displacement: vec![DVec3::ZERO; self.ground.mesh.positions.len()],
            multipliers: std::mem::take(multipliers),
            ridge: self.problem.mean_diagonal(),
        };
        let mut best = Attempt {
            choice,
            ..Attempt::default()
        };
        for round in 0..=ROUNDS {
            let fraction = round as f64 / ROUNDS as f64;
            crate::progress::step(progress, Stage::Embed, fraction)?;
            let phases = match round {
                0 => self.phases_of_host(step),
                _ => self.phases(&self.moved(&state.displacement), step),
            };
            let exponent = exponent(&phases, self.active);
            if exponent > best.exponent {
                best.exponent = exponent;
                best.displacement.clone_from(&state.displacement);
            }
            if round == ROUNDS || (round == FIRST_ROUNDS && best.exponent < begun) {
                break;
            }
            let tries = if round == 0 { 4 } else { 1 };
            self.round(&phases, &choice, tries, &mut state);
        }
        best.choice.ridge = state.ridge;
        *multipliers = state.multipliers;
        if !best.displacement.is_empty() {
            let rounded = rounded_for_web(&self.moved(&best.displacement));
            best.exponent = exponent(&self.phases(&rounded, step), self.active);
        }
        Ok(best)
    }

    /// Embeds as a choice was made before, with another message: the displacement.
    pub fn again(&self, choice: &Choice, is_thorough: bool) -> Vec<DVec3> {
        let step = choice.step / self.placement.pitch;
        let mut state = State {
            displacement: vec![DVec3::ZERO; self.ground.mesh.positions.len()],
            multipliers: vec![0.0; self.active.len()],
            ridge: choice.ridge,
        };
        let rounds = if is_thorough { ROUNDS } else { ROUNDS_AGAIN };
        for round in 0..rounds {
            let phases = match round {
                0 => self.phases_of_host(step),
                _ => self.phases(&self.moved(&state.displacement), step),
            };
            self.round(&phases, choice, 1, &mut state);
        }
        state.displacement
    }

    /// One round: the displacement that takes windows with such phases nearest to their lattice.
    fn round(&self, phases: &[f64], choice: &Choice, tries: usize, state: &mut State) {
        let (pose, placement) = (&self.ground.pose, self.placement);
        let pitch = placement.pitch;
        let axes = pose.axes * placement.rotation;
        let to_lattice = axes.transpose() * (1.0 / (pose.size * pitch));
        let from_lattice = axes * (pose.size * pitch);
        let errors = phases.iter().map(|phase| phase.round() - phase);
        let weights: Vec<f64> = errors.clone().zip(self.active).map(majorised).collect();
        let now = state.displacement.iter().map(|d| to_lattice * *d);
        let step = choice.step / pitch;
        let goals: Vec<f64> = self
            .problem
            .times(now)
            .iter()
            .zip(errors)
            .map(|(a, b)| a + b * step)
            .collect();
        for _ in 0..tries {
            let solution =
                self.problem
                    .solve(&goals, &weights, state.ridge, &mut state.multipliers);
            state.displacement = solution.into_iter().map(|x| from_lattice * x).collect();
            // The RMS falls more slowly than the ridge grows.
            let excess = (self.rms(&state.displacement) / choice.limit).clamp(0.05, 20.0);
            state.ridge *= excess * excess;
        }
        self.keep_to_limits(&mut state.displacement, choice);
    }

    fn moved(&self, displacement: &[DVec3]) -> Mesh {
        let mesh = &self.ground.mesh;
        let positions = mesh.positions.iter().zip(displacement);
        mesh.with_positions(positions.map(|(p, d)| *p + *d).collect())
    }

    fn keep_to_limits(&self, displacement: &mut [DVec3], choice: &Choice) {
        let ground = self.ground;
        let most = choice.clamp * choice.limit;
        displacement
            .iter_mut()
            .zip(&ground.freedom)
            .for_each(|(d, freedom)| {
                *d = d.clamp_length_max(most * (freedom / ground.typical).min(1.0))
            });
        self.host.admissible.project(displacement);
        let scale = (choice.limit / self.rms(displacement)).min(1.0);
        displacement.iter_mut().for_each(|d| *d *= scale);
        let (leeway, admissible) = (self.host.leeway, &self.host.admissible);
        leeway.keep(&ground.mesh.positions, displacement, admissible);
    }

    /// The RMS of a displacement; where it is to be hidden, as if all vertices were as free as is typical: what rough parts
    /// cannot use is not for smooth ones to take.
    fn rms(&self, displacement: &[DVec3]) -> f64 {
        let square = |(d, freedom): (&DVec3, &f64)| {
            let share = if self.host.hidden {
                freedom / self.ground.typical
            } else {
                1.0
            };
            d.length_squared() / (share * share)
        };
        let squares: f64 = displacement
            .iter()
            .zip(&self.ground.freedom)
            .map(square)
            .sum();
        (squares / displacement.len() as f64).sqrt()
    }

    /// The phases of the host's fluxes at the active windows.
    fn phases_of_host(&self, step: f64) -> Vec<f64> {
        let phase = |window: &Window| window.flux / step + window.dither;
        self.active.iter().map(phase).collect()
    }

    /// The phases of the displaced mesh's fluxes at the active windows, in its own frame, the axes' signs as the host's: where parts
    /// are nearly symmetric the signs would turn over from round to round.
    fn phases(&self, moved: &Mesh, step: f64) -> Vec<f64> {
        let ground = self.ground;
        let pose = Pose::of_oriented(moved, &ground.boundary)
            .map_or(ground.pose, |pose| pose.aligned_with(&ground.pose));
        let now = windows(&clusters(moved, &pose, ground.finest), self.placement);
        let find = |index| {
            now.binary_search_by_key(&index, |window| window.index)
                .ok()
                .map(|found| now[found].flux)
        };
        self.active
            .iter()
            .map(|window| find(window.index).unwrap_or(window.flux) / step + window.dither)
            .collect()
    }
}

/// Where an attempt is.
struct State {
    displacement: Vec<DVec3>,
    /// The last solution of the dual.
    multipliers: Vec<f64>,
    ridge: f64,
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
