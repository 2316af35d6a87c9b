//! What a key reads in a suspect's surfaces.
//!
//! Three kinds of tests share the probability of a false alarm in equal parts, each charged for its own number: the suspect
//! as it is, in all turns of its frame; the surfaces that undo what may have been done to it; and the symbols that are no
//! pilots, where the pilots agree best after a search of which they know nothing (docs/SECURITY.md). A suspect of several pieces is
//! read as a whole, and each piece alone, as if it were all that there is.

use super::lattice::Lattice;
use super::pitch::MOST_PITCHES;
use super::quantizer::{STEPS, cosine, phase};
use super::refine::{View, refine};
use super::search::{Candidate, STRENGTHS, Search, num_nodes};
use super::strength::{blend, weights};
use super::stretch::mapped;
use super::surface::Surface;
use super::window::{Window, windows};
use crate::carrier::{Hypothesis, Reading};
use crate::code::{SoftSymbol, Symbol};
use crate::progress::{Cancelled, Progress, Stage, step};
use std::borrow::Cow;

/// Kinds of tests.
const KINDS: usize = 3;

/// The surfaces of one piece, in their order.
pub type SurfacesOf<'a> = Box<dyn Iterator<Item = Cow<'a, Surface>> + 'a>;

/// Reads the surfaces of a suspect with a key, and those of each of its pieces alone, until it is sure of one. So many of them are searched widely, for stretches
/// and unknown turns.
///
/// All are looked at as they are before anything is undone: a marked model is mostly found in that, and where what was read
/// then `is_settled`, nothing more is.
pub fn read<'a>(
    pieces: Vec<SurfacesOf<'a>>,
    lattice: &dyn Fn() -> Lattice,
    is_settled: &dyn Fn(&Reading) -> bool,
    num_wide: usize,
    progress: &mut dyn Progress,
) -> Result<Reading, Cancelled> {
    let num_pieces = pieces.len();
    let mut begun = Vec::new();
    for (number, mut surfaces) in pieces.into_iter().enumerate() {
        step(progress, Stage::Test, 0.0)?;
        if let Some(suspect) = surfaces.next() {
            let search = Search::new(lattice(), suspect);
            if search.is_sure() {
                return Ok(search.conclude().of_piece(number, num_pieces));
            }
            begun.push((number, search, surfaces));
        }
    }
    let mut seen = Reading::default();
    for (number, search, _) in &begun {
        seen.add(search.as_it_is().of_piece(*number, num_pieces));
    }
    if is_settled(&seen) {
        return Ok(seen);
    }
    let mut all = Reading::default();
    for (number, mut search, mut surfaces) in begun {
        let mut report =
            |stage, part| progress.report(stage, (number as f64 + part) / num_pieces as f64);
        search.go_on(&mut surfaces, number < num_wide, &mut report)?;
        let reading = search.conclude().of_piece(number, num_pieces);
        if search.is_sure() {
            return Ok(reading);
        }
        all.add(reading);
    }
    Ok(all)
}

impl Reading {
    /// What was read of a piece beside others.
    fn add(&mut self, piece: Reading) {
        self.num_addresses = self.num_addresses.max(piece.num_addresses);
        self.hypotheses.extend(piece.hypotheses);
    }

    /// The reading of one piece of so many, the whole being the first. It has half of the probability of a false alarm, and the
    /// others share the rest.
    fn of_piece(mut self, number: usize, num_pieces: usize) -> Reading {
        let num_shares = match (number, num_pieces) {
            (_, 1) => 1,
            (0, _) => 2,
            (_, num) => 2 * (num - 1),
        };
        for hypothesis in &mut self.hypotheses {
            hypothesis.ln_num_tests += libm::log(num_shares as f64);
            hypothesis.piece = number;
        }
        self
    }
}

impl Search<'_> {
    /// All windows of a candidate's surface at a view.
    fn see(&self, candidate: &Candidate, view: &View) -> Vec<Window> {
        let parts = weights(&candidate.strengths, view.strength);
        let lists: Vec<(Vec<Window>, f64)> = parts
            .into_iter()
            .map(|(part, weight)| {
                let node = &self.nodes[candidate.nodes[part]];
                let clusters = match &view.stretch {
                    Some(stretch) => Cow::Owned(mapped(&node.clusters, stretch)),
                    None => Cow::Borrowed(&node.clusters),
                };
                (windows(&clusters, &view.placement), weight)
            })
            .collect();
        blend(
            lists
                .iter()
                .map(|(list, weight)| (list.as_slice(), *weight)),
        )
    }

    /// What windows say, read with a candidate's step at a view.
    fn symbols(&self, candidate: &Candidate, view: &View, windows: Vec<Window>) -> Vec<SoftSymbol> {
        let step = candidate.step / view.placement.pitch;
        let read = |window: Window| {
            let (dither, symbol) = self.lattice.at(window.index);
            let weight = window.weight.max(0.0);
            SoftSymbol {
                symbol,
                value: weight * cosine(phase(window.flux / step, dither)),
                weight,
            }
        };
        windows.into_iter().map(read).collect()
    }

    /// Ways of reading that differ in pitch, turn and step.
    fn num_views(&self, num_pitches: usize) -> usize {
        num_pitches * self.turns.len() * STEPS.len()
    }

    /// What candidates say, as they were found among so many.
    fn say(&self, candidates: &[Candidate], num_declared: usize) -> Vec<Hypothesis> {
        let say = |candidate: &Candidate| Hypothesis {
            symbols: self.symbols(
                candidate,
                &candidate.view,
                self.see(candidate, &candidate.view),
            ),
            ln_num_tests: libm::log((KINDS * num_declared) as f64),
            piece: 0,
        };
        candidates.iter().map(say).collect()
    }

    /// What the suspect says as it is, before any search.
    fn as_it_is(&self) -> Reading {
        let num_own = self.num_views(self.nodes[0].surface.pitches.len());
        Reading {
            hypotheses: self.say(&self.own, num_own),
            num_addresses: self.num_windows,
        }
    }

    fn conclude(&self) -> Reading {
        let mut hypotheses = self.as_it_is().hypotheses;
        let num_undone = self.num_views(MOST_PITCHES) * (1 + STRENGTHS * num_nodes());
        hypotheses.extend(self.say(&self.undone, num_undone));
        let to_refine = [
            (self.own.first(), 4.5),
            (self.undone.first(), 9.0),
            (self.stretched.first(), 9.0),
            (self.scanned.as_ref(), 9.0),
        ];
        for (candidate, least) in to_refine {
            // What is less than the best of so many that chance gives leads nowhere, and there is no need where all is clear.
            let is_worth_it =
                |candidate: &&Candidate| candidate.evidence >= least && !self.is_clear();
            let Some(candidate) = candidate.filter(is_worth_it) else {
                continue;
            };
            let candidate = self.with_whole_family(candidate);
            let see = |view: &View| self.see(&candidate, view);
            let view = refine(&see, &candidate.view, &self.lattice, candidate.step);
            let mut symbols = self.symbols(&candidate, &view, see(&view));
            symbols.retain(|soft| soft.symbol != Symbol::Pilot);
            hypotheses.push(Hypothesis {
                symbols,
                ln_num_tests: libm::log((KINDS * to_refine.len()) as f64),
                piece: 0,
            });
        }
        Reading {
            hypotheses,
            num_addresses: self.num_windows,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::super::search::FOLLOWED;
    use super::super::surfaces::Surfaces;
    use super::*;
    use crate::key::Key;
    use crate::mesh::{Mesh, shapes};
    use crate::progress::ignore;

    fn reading(surfaces: &[Surface], lattice: impl Fn() -> Lattice) -> Reading {
        let surfaces = surfaces.iter().map(Cow::Borrowed);
        let settled = |_: &Reading| false;
        read(vec![Box::new(surfaces)], &lattice, &settled, 1, &mut ignore).unwrap()
    }

    /// What is followed, what it is charged, and what each symbol weighs.
    fn choices(reading: &Reading) -> Vec<(f64, Vec<(Symbol, f64)>)> {
        let ways = reading.hypotheses.iter();
        ways.map(|way| {
            let symbols = way.symbols.iter().map(|soft| (soft.symbol, soft.weight));
            (way.ln_num_tests, symbols.collect())
        })
        .collect()
    }

    /// docs/SECURITY.md, 9 and 10: neither which ways are followed nor any weight depends on the dithers that testify.
    #[test]
    fn nothing_that_is_chosen_depends_on_the_dithers_that_testify() {
        let rock = shapes::asteroid(20, 30);
        let of = |mesh: &Mesh, stages: fn(Surfaces) -> Surfaces| -> Vec<Surface> {
            stages(Surfaces::new(mesh)).collect()
        };
        let suspects = [
            ("undone", of(&rock, Surfaces::first_kind), 2..4),
            ("scanned", of(&shapes::torus(40, 24), Surfaces::plain), 1..2),
        ];
        let mut num_split = 0;
        for (name, surfaces, keys) in suspects {
            for number in keys {
                let key = Key::from_bytes(&[number; Key::BYTES]).unwrap();
                let drawn = reading(&surfaces, || Lattice::of(&key));
                for other in 0..2 {
                    let other = Key::from_bytes(&[100 + other; Key::BYTES]).unwrap();
                    let redrawn = reading(&surfaces, || Lattice::of(&key).redrawn(&other));
                    assert!(choices(&redrawn) == choices(&drawn), "{name}, key {number}");
                    let values = |reading: &Reading| -> Vec<f64> {
                        let ways = reading.hypotheses.iter();
                        ways.flat_map(|way| way.symbols.iter().map(|soft| soft.value))
                            .collect()
                    };
                    assert_ne!(
                        values(&redrawn),
                        values(&drawn),
                        "{name}: nothing was redrawn"
                    );
                }
                num_split += drawn.hypotheses.len().saturating_sub(2 * FOLLOWED);
            }
        }
        assert!(num_split > 0, "no search was begun");
    }
}
