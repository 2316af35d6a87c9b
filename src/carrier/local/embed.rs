//! Embedding by majorise-minimise, as SOLID does it, for all balls of a model at once. The places are found again in every round.

use super::ball::{Ball, RADIUS, STEPS, lattice, widths, windows_of};
use super::choice::choose;
use super::problem::{Problem, ROWS_OF_PLACE};
use crate::carrier::qim::curvature;
use crate::carrier::solid::freedom::{freedoms, typical};
use crate::carrier::solid::held::{Held, held};
use crate::carrier::solid::lattice::Lattice;
use crate::carrier::solid::quantizer::{cosine, phase};
use crate::carrier::solid::window::Window;
use crate::carrier::{self, Carrier, CarrierError, Chosen, Host, Needs};
use crate::code::{Codeword, Symbol};
use crate::detection::Statistic;
use crate::geometry::places::{Areas, areas};
use crate::geometry::{diagonal, oriented, rounded_for_web};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress, Stage, step};
use glam::{DMat3, DVec3};

const ROUNDS: usize = 8;
/// Weight that is left to a window half a step from its lattice.
const LEAST_WEIGHT: f64 = 0.02;
/// No vertex moves more than so many times the RMS limit.
const CLAMP: f64 = 4.0;
/// Weight of what holds the places, in mean weights of a window.
const HOLD: f64 = 30.0;
/// What an error in a window of SOLID's costs beside one in a ball's.
const HOLD_SOLID: f64 = 1.0;
/// The step, in pitches, at the strong strength: 0.08 % of the diagonal. Others are in proportion.
const STRONG_STEP: f64 = 0.1;
const STRONG: f64 = 0.0008;

/// What a mark has to reach, in nats: twice what is found, and what is charged. SOLID's without a payload has to reach as much.
const SURE: f64 = 45.0;

/// A mark in balls.
#[derive(Debug)]
pub struct Embedded {
    /// The displacement of all V vertices.
    pub displacement: Vec<DVec3>,
    /// By ball: where it is, its radius in scene units, and the exponent of the bound if it is read alone where it is, once a web
    /// pipeline has rounded the positions.
    pub balls: Vec<(DVec3, f64, f64)>,
    /// The same of all balls together.
    pub exponent: f64,
}

/// Gives a host the mark of a key, without a payload, and leaves windows nearly as they are in which SOLID holds a mark of that key: as
/// it chose. `None` where the host has no places that come back.
pub fn embed(
    host: &Host,
    key: &Key,
    chosen: &[Chosen],
    progress: &mut dyn Progress,
) -> Result<Option<Embedded>, Cancelled> {
    step(progress, Stage::Embed, 0.0)?;
    let (mesh, boundary) = oriented(host.mesh);
    let balls = choose(&mesh);
    if balls.is_empty() {
        return Ok(None);
    }
    let freedom = freedoms(&mesh, &boundary, host, CLAMP);
    let typical = typical(&freedom);
    let unseen = if host.hidden { typical } else { 1.0 };
    let rms_rel = host.share * unseen * host.rms_rel;
    let ideal = STRONG_STEP * rms_rel / STRONG;
    let number = STEPS.partition_point(|step| *step > 1.19 * ideal);
    let embedder = Embedder {
        host,
        limit: rms_rel * diagonal(&mesh.positions),
        diagonal: diagonal(&mesh.positions),
        freedom,
        typical,
        mesh: &mesh,
        step: STEPS[number.min(STEPS.len() - 1)],
        held: held(host.mesh, key, chosen),
    };
    embedder.embed(balls, key, progress).map(Some)
}

/// The same as a carrier does it. Where the host has too few places that come back, that is refused.
#[cfg(feature = "local")]
pub fn embed_above(
    host: &Host,
    key: &Key,
    chosen: &[Chosen],
    progress: &mut dyn Progress,
) -> Result<carrier::Embedded, CarrierError> {
    let (displacement, exponent) = match embed(host, key, chosen, progress)? {
        Some(embedded) => (embedded.displacement, embedded.exponent),
        None => (Vec::new(), 0.0),
    };
    if exponent < SURE {
        return Err(CarrierError::TooWeak {
            carrier: Carrier::Local,
            reached: exponent,
            needed: SURE,
        });
    }
    Ok(carrier::Embedded {
        displacement,
        carrier: Carrier::Local,
        exponent,
        needs: Needs {
            sturdy: SURE,
            payload: f64::INFINITY,
            presence: SURE,
        },
        chosen: Vec::new(),
    })
}

/// Whether a mesh has places that come back.
pub fn suits(mesh: &Mesh) -> bool {
    !choose(&oriented(mesh).0).is_empty()
}

struct Embedder<'a> {
    host: &'a Host<'a>,
    /// The host, oriented.
    mesh: &'a Mesh,
    diagonal: f64,
    freedom: Vec<f64>,
    /// RMS freedom.
    typical: f64,
    /// RMS limit in scene units.
    limit: f64,
    /// In pitches.
    step: f64,
    /// Where SOLID holds a mark.
    held: Vec<Held>,
}

/// A ball, its lattice, and the windows in it.
struct Marked {
    ball: Ball,
    lattice: Lattice,
    windows: Vec<Window>,
}

impl Embedder<'_> {
    fn areas(&self, mesh: &Mesh) -> Areas {
        areas(mesh, &widths(self.diagonal))
    }

    fn embed(
        &self,
        balls: Vec<Ball>,
        key: &Key,
        progress: &mut dyn Progress,
    ) -> Result<Embedded, Cancelled> {
        let now = self.areas(self.mesh);
        let mark = |ball| Marked::new(ball, key, &now);
        let mut marked: Vec<Marked> = balls.into_iter().map(mark).collect();
        let mut problem = Problem::new(self.mesh, &self.freedom);
        for Marked {
            ball,
            lattice,
            windows,
        } in &marked
        {
            let placement = ball.placement(lattice, DVec3::ONE);
            problem.add_ball(ball.place.point, &placement, windows);
        }
        let diagonal = problem.diagonal();
        let num_windows = diagonal.len();
        let mean = diagonal.iter().sum::<f64>() / num_windows as f64;
        for marked in &marked {
            problem.add_place(&marked.ball.place, mean.sqrt());
        }
        let held_weights = self.hold_windows(&mut problem);
        let num_of_places = ROWS_OF_PLACE * marked.len();
        let num_rows = num_windows + num_of_places + held_weights.len();
        let mut displacement = vec![DVec3::ZERO; self.mesh.positions.len()];
        let (mut best, mut best_agreement) = (displacement.clone(), f64::NEG_INFINITY);
        let mut ridge = mean;
        for round in 0..=ROUNDS {
            step(progress, Stage::Embed, round as f64 / ROUNDS as f64)?;
            let phases = self.phases(&self.moved(&displacement), &mut marked);
            let agreement = agreement(&phases, &marked);
            if agreement > best_agreement {
                (best, best_agreement) = (displacement.clone(), agreement);
            }
            if round == ROUNDS {
                break;
            }
            let windows = marked.iter().flat_map(|marked| &marked.windows);
            let errors: Vec<f64> = phases.iter().map(|phase| phase.round() - phase).collect();
            let weigh = |(error, window): (&f64, &Window)| {
                window.weight * curvature(*error).max(LEAST_WEIGHT)
            };
            let mut weights: Vec<f64> = errors.iter().zip(windows).map(weigh).collect();
            let mean_weight = weights.iter().sum::<f64>() / num_windows as f64;
            weights.extend(std::iter::repeat_n(HOLD * mean_weight, num_of_places));
            weights.extend(&held_weights);
            let now = problem.times(&displacement).into_iter();
            let goals = now.zip(&errors).map(|(now, error)| now + error * self.step);
            let mut goals: Vec<f64> = goals.collect();
            goals.resize(num_rows, 0.0);
            let tries = if round == 0 { 4 } else { 1 };
            for _ in 0..tries {
                displacement = problem.solve(&goals, &weights, ridge);
                // The RMS falls more slowly than the ridge grows.
                let excess = (rms(&displacement) / self.limit).clamp(0.05, 20.0);
                ridge *= excess * excess;
            }
            self.keep_to_limits(&mut displacement);
        }
        let rounded = rounded_for_web(&self.moved(&best));
        let phases = self.phases(&rounded, &mut marked);
        let mut rest = phases.as_slice();
        let balls = marked.iter().map(|marked| {
            let (own, others) = rest.split_at(marked.windows.len());
            rest = others;
            let Ball { place, .. } = marked.ball;
            let exponent = exponent(own, std::slice::from_ref(marked));
            (place.point, RADIUS * marked.ball.pitch(), exponent)
        });
        Ok(Embedded {
            balls: balls.collect(),
            exponent: exponent(&phases, &marked),
            displacement: best,
        })
    }

    /// Adds the rows that hold SOLID's windows. Each weighs as if an error in SOLID's steps were one in steps of a ball's.
    fn hold_windows(&self, problem: &mut Problem) -> Vec<f64> {
        let mut weights = Vec::new();
        for held in &self.held {
            problem.add_windows(&held.triangles, &held.placement, &held.windows);
            let steps = self.step / held.step;
            let weigh = |window: &Window| HOLD_SOLID * window.weight * steps * steps;
            weights.extend(held.windows.iter().map(weigh));
        }
        weights
    }

    fn moved(&self, displacement: &[DVec3]) -> Mesh {
        let positions = self.mesh.positions.iter().zip(displacement);
        self.mesh
            .with_positions(positions.map(|(p, d)| *p + *d).collect())
    }

    fn keep_to_limits(&self, displacement: &mut [DVec3]) {
        for (d, freedom) in displacement.iter_mut().zip(&self.freedom) {
            let most = CLAMP * self.limit * (freedom / self.typical).min(1.0);
            *d = d.clamp_length_max(most);
        }
        let (leeway, admissible) = (self.host.leeway, &self.host.admissible);
        admissible.project(displacement);
        let scale = (self.limit / rms(displacement)).min(1.0);
        displacement.iter_mut().for_each(|d| *d *= scale);
        leeway.keep(&self.mesh.positions, displacement, admissible);
    }

    /// The phases of a displaced mesh's fluxes in the windows of all balls, each about its place as it is now.
    fn phases(&self, moved: &Mesh, marked: &mut [Marked]) -> Vec<f64> {
        let now = self.areas(moved);
        let mut phases = Vec::new();
        for marked in marked {
            marked.follow(&now);
            let Marked {
                ball,
                lattice,
                windows,
            } = marked;
            let placement = ball.placement(lattice, DVec3::ONE);
            let seen = windows_of(&ball.clusters(&now), lattice, &placement);
            for window in windows {
                let found = seen.binary_search_by_key(&window.index, |other| other.index);
                let flux = found.map_or(window.flux, |found| seen[found].flux);
                phases.push(phase(flux / self.step, window.dither));
            }
        }
        phases
    }
}

impl Marked {
    fn new(ball: Ball, key: &Key, areas: &Areas) -> Marked {
        let lattice = lattice(key, ball.class());
        let placement = ball.placement(&lattice, DVec3::ONE);
        let mut windows = windows_of(&ball.clusters(areas), &lattice, &placement);
        // What is to be added to a window's phase so that whole numbers carry its symbol.
        for window in &mut windows {
            let (dither, symbol) = lattice.at(window.index);
            let is_positive = Codeword::Presence.sign(symbol) > 0.0;
            window.dither = dither - if is_positive { 0.0 } else { 0.5 };
        }
        Marked {
            ball,
            lattice,
            windows,
        }
    }

    /// Takes its place to where it is now, with axes of the same signs.
    fn follow(&mut self, areas: &Areas) {
        let Some(mut again) = self.ball.place.again(areas) else {
            return;
        };
        let (now, before) = (again.frames[self.ball.frame].axes, self.ball.axes());
        let signed = |now: DVec3, before: DVec3| if now.dot(before) < 0.0 { -now } else { now };
        again.frames[self.ball.frame].axes = DMat3::from_cols(
            signed(now.x_axis, before.x_axis),
            signed(now.y_axis, before.y_axis),
            signed(now.z_axis, before.z_axis),
        );
        self.ball.place = again;
    }
}

fn rms(displacement: &[DVec3]) -> f64 {
    let squares: f64 = displacement.iter().map(|d| d.length_squared()).sum();
    (squares / displacement.len() as f64).sqrt()
}

fn agreement(phases: &[f64], marked: &[Marked]) -> f64 {
    let windows = marked.iter().flat_map(|marked| &marked.windows);
    let terms = phases.iter().zip(windows);
    terms
        .map(|(phase, window)| window.weight * cosine(*phase))
        .sum()
}

/// The exponent of the bound if the symbols that are no pilots are read at these phases.
fn exponent(phases: &[f64], marked: &[Marked]) -> f64 {
    let windows = marked.iter().flat_map(|marked| {
        marked
            .windows
            .iter()
            .map(|window| (window, &marked.lattice))
    });
    let testify = |(phase, (window, lattice)): (&f64, (&Window, &Lattice))| {
        let is_pilot = lattice.at(window.index).1 == Symbol::Pilot;
        (!is_pilot).then(|| (window.weight * cosine(*phase), window.weight))
    };
    -Statistic::new(phases.iter().zip(windows).filter_map(testify)).ln_p()
}
