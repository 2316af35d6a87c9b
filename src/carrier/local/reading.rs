//! What a key reads in the places of a suspect.
//!
//! Every place, frame, pitch, step and sign of the axes is looked at by the pilots alone; the best are refined by the pilots alone, in two stages; and of
//! the best of each class the other symbols testify: of the best ball, of the best two, and so on. The pilots' own agreement is never
//! reported, so thousands of candidates cost nothing (docs/SECURITY.md, 9).

use super::ball::{Ball, CLASSES, RADIUS, RATIOS, STEPS, lattice, windows_of};
use super::measurement::Measurement;
use crate::carrier::solid::cluster::Cluster;
use crate::carrier::solid::lattice::{Lattice, Placement};
use crate::carrier::solid::quantizer::{cosine, phase};
use crate::carrier::solid::refine::{View, approach, refine};
use crate::carrier::solid::window::Window;
use crate::carrier::{Hypothesis, Reading};
use crate::code::{SoftSymbol, Symbol};
use crate::detection::Statistic;
use crate::geometry::Pose;
use crate::key::Key;
use crate::progress::{Cancelled, Progress, Stage, step};
use std::ops::Range;

/// Pitches that are tried, as fractions of the suspect's diagonal.
const PITCHES: Range<f64> = 0.03..0.075;
/// Axes that are told apart by less than this are not tried.
const GAP: f64 = 0.02;
/// A ball with fewer windows says too little.
const FEWEST_WINDOWS: usize = 24;
/// Candidates that are refined: many with little effort, and the best of these with all.
const STAGES: [(usize, Refine); 2] = [(240, approach), (40, refine)];
/// What refining gains by chance, in nats.
const BY_CHANCE: f64 = 7.0;
/// Balls that testify together, at most: as many sets are tested, each the one before and one ball more.
const MOST_TOGETHER: usize = 4;

/// How a view is taken to where its pilots agree best nearby.
type Refine = fn(&dyn Fn(&View) -> Vec<Window>, &View, &Lattice, f64) -> View;

/// A ball that may hold a mark.
struct Candidate {
    ball: Ball,
    /// In pitches.
    step: f64,
    placement: Placement,
    /// How well the pilots agree, in nats, refined or not.
    evidence: f64,
}

impl Measurement {
    /// The soft symbols of a key.
    pub fn read(&self, key: &Key, progress: &mut dyn Progress) -> Result<Reading, Cancelled> {
        self.read_with(&|class| lattice(key, class), progress)
    }

    /// The same with a lattice for each class.
    fn read_with(
        &self,
        lattice: &dyn Fn(usize) -> Lattice,
        progress: &mut dyn Progress,
    ) -> Result<Reading, Cancelled> {
        let lattices: Vec<Lattice> = (0..CLASSES).map(lattice).collect();
        let (mut candidates, num_addresses) = self.candidates(&lattices, progress)?;
        for (most, refine) in STAGES {
            candidates.truncate(most);
            for candidate in &mut candidates {
                let lattice = &lattices[candidate.ball.class()];
                self.refine(candidate, lattice, refine);
            }
            best_first(&mut candidates);
        }
        let mut chosen: Vec<&Candidate> = Vec::new();
        for candidate in &candidates {
            let is_other = |other: &&Candidate| other.ball.class() != candidate.ball.class();
            if chosen.len() < MOST_TOGETHER && chosen.iter().all(is_other) {
                chosen.push(candidate);
            }
        }
        let symbols =
            |candidate: &&Candidate| self.testimony(candidate, &lattices[candidate.ball.class()]);
        let of_balls: Vec<Vec<SoftSymbol>> = chosen.iter().map(symbols).collect();
        let hypotheses = (1..=of_balls.len()).map(|count| Hypothesis {
            symbols: of_balls[..count].concat(),
            ln_num_tests: libm::log(MOST_TOGETHER as f64),
            piece: 0,
        });
        Ok(Reading {
            hypotheses: hypotheses.collect(),
            num_addresses,
        })
    }

    /// All that the pilots look at, the best first, and the most windows that any has.
    fn candidates(
        &self,
        lattices: &[Lattice],
        progress: &mut dyn Progress,
    ) -> Result<(Vec<Candidate>, usize), Cancelled> {
        let mut candidates = Vec::new();
        let mut num_addresses = 0;
        for (number, place) in self.places.iter().enumerate() {
            let part = number as f64 / self.places.len() as f64;
            step(progress, Stage::Test, part)?;
            let frames = (0..2).filter(|&frame| place.frames[frame].gap > GAP);
            let frames_and_ratios =
                frames.flat_map(|frame| (0..RATIOS.len()).map(move |ratio| (frame, ratio)));
            for (frame, ratio) in frames_and_ratios {
                let place = *place;
                let ball = Ball {
                    place,
                    frame,
                    ratio,
                };
                if !PITCHES.contains(&(ball.pitch() / self.diagonal)) {
                    continue;
                }
                let lattice = &lattices[ball.class()];
                let clusters = ball.clusters(&self.areas);
                for signs in Pose::HALF_TURNS {
                    let placement = ball.placement(lattice, signs);
                    let windows = self.windows(&ball, &clusters, lattice, &placement);
                    if windows.len() < FEWEST_WINDOWS {
                        continue;
                    }
                    num_addresses = num_addresses.max(windows.len());
                    candidates.extend(STEPS.map(|step| Candidate {
                        ball,
                        step,
                        placement,
                        evidence: evidence(&windows, lattice, step),
                    }));
                }
            }
        }
        best_first(&mut candidates);
        Ok((candidates, num_addresses))
    }

    /// The windows of a ball that see no boundary.
    fn windows(
        &self,
        ball: &Ball,
        clusters: &[Cluster],
        lattice: &Lattice,
        placement: &Placement,
    ) -> Vec<Window> {
        let mut windows = windows_of(clusters, lattice, placement);
        self.keep_whole(&mut windows, ball, placement);
        windows
    }

    /// Takes a candidate to where its pilots agree best nearby.
    fn refine(&self, candidate: &mut Candidate, lattice: &Lattice, refine: Refine) {
        let ball = candidate.ball;
        let clusters = ball.clusters(&self.areas);
        let start = self.windows(&ball, &clusters, lattice, &candidate.placement);
        let is_there = |window: &Window| {
            start
                .binary_search_by_key(&window.index, |other| other.index)
                .is_ok()
        };
        // Nudges are of one size in turns and in shifts where the ball's radius is the unit of length.
        let unit = RADIUS * candidate.placement.pitch;
        let scaled = |placement: &Placement, unit: f64| Placement {
            origin: placement.origin * unit,
            pitch: placement.pitch * unit,
            ..*placement
        };
        let see = |view: &View| {
            let placement = scaled(&view.placement, unit);
            let mut windows = windows_of(&clusters, lattice, &placement);
            windows.retain(is_there);
            windows
        };
        let view = View::of_suspect(scaled(&candidate.placement, 1.0 / unit), None);
        let step = candidate.step * view.placement.pitch;
        let found = refine(&see, &view, lattice, step);
        let refined = evidence(&see(&found), lattice, candidate.step) - BY_CHANCE;
        candidate.placement = scaled(&found.placement, unit);
        candidate.evidence = candidate.evidence.max(refined);
    }

    /// What the symbols of a ball say that are no pilots.
    fn testimony(&self, candidate: &Candidate, lattice: &Lattice) -> Vec<SoftSymbol> {
        let clusters = candidate.ball.clusters(&self.areas);
        let windows = self.windows(&candidate.ball, &clusters, lattice, &candidate.placement);
        let soft = |window: &Window| {
            let (dither, symbol) = lattice.at(window.index);
            (symbol != Symbol::Pilot).then(|| SoftSymbol {
                symbol,
                value: window.weight * cosine(phase(window.flux / candidate.step, dither)),
                weight: window.weight,
            })
        };
        windows.iter().filter_map(soft).collect()
    }
}

fn best_first(candidates: &mut [Candidate]) {
    candidates.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
}

/// How well the pilots agree, in nats.
fn evidence(windows: &[Window], lattice: &Lattice, step: f64) -> f64 {
    let pilot = |window: &Window| {
        let (dither, symbol) = lattice.at(window.index);
        let value = || window.weight * cosine(phase(window.flux / step, dither));
        (symbol == Symbol::Pilot).then(|| (value(), window.weight))
    };
    -Statistic::new(windows.iter().filter_map(pilot)).ln_p()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use crate::progress::ignore;

    /// docs/SECURITY.md, 9 and 10: neither which balls are chosen nor any weight depends on the dithers that testify.
    #[test]
    fn nothing_that_is_chosen_depends_on_the_dithers_that_testify() {
        let measurement = Measurement::new(&shapes::low_poly());
        let key = Key::from_bytes(&[3; Key::BYTES]).unwrap();
        let other = Key::from_bytes(&[103; Key::BYTES]).unwrap();
        let read = |lattice: &dyn Fn(usize) -> Lattice| {
            measurement.read_with(lattice, &mut ignore).unwrap()
        };
        let drawn = read(&|class| lattice(&key, class));
        let redrawn = read(&|class| lattice(&key, class).redrawn(&other));
        let of = |reading: &Reading,
                  part: fn(&SoftSymbol) -> (Symbol, f64)|
         -> Vec<Vec<(Symbol, f64)>> {
            let ways = reading.hypotheses.iter();
            ways.map(|way| way.symbols.iter().map(part).collect())
                .collect()
        };
        let weights = |soft: &SoftSymbol| (soft.symbol, soft.weight);
        let values = |soft: &SoftSymbol| (soft.symbol, soft.value);
        assert!(!drawn.hypotheses.is_empty(), "balls are chosen");
        assert!(of(&drawn, weights) == of(&redrawn, weights));
        assert!(
            of(&drawn, values) != of(&redrawn, values),
            "nothing was redrawn"
        );
    }
}
