//! Reading a measurement with a key: which surface, pitch, turn of the frame, step and strength of smoothing, and where
//! exactly the lattice lies. Pilots choose, among ways of reading that were declared before any key was known.
//!
//! Three kinds of tests share the probability of a false alarm in equal parts, each charged for its own number: the suspect
//! as it is, in all turns of its frame; the surfaces that undo what may have been done to it; and the symbols that are no
//! pilots, where the pilots agree best after a search of which they know nothing (docs/SECURITY.md).

use super::field::{self, Field};
use super::flux::{Cluster, Placement, Window, windows};
use super::measurement::{Axes, Origin, Surface};
use super::refine::{View, refine};
use super::strength::{FAMILIES, blend, weights};
use super::{Lattice, MOST_PITCHES, STEPS, cosine, phase};
use crate::carrier::{Hypothesis, Reading};
use crate::code::{SoftSymbol, Symbol};
use crate::detection::Statistic;
use crate::key::Key;
use crate::progress::{Cancelled, Progress, Stage, step};
use glam::{DMat3, DVec3};
use std::borrow::Cow;
use std::cell::OnceCell;

/// Pilots that agree better than this, in nats, end the search: what follows would only undo attacks that did not happen.
const ENOUGH: f64 = 40.0;

/// Strengths that are tried between two nodes, the further node included.
const STRENGTHS: usize = 8;

/// The share of the time that a search takes which ends in a scan, before that.
const SHARE_BEFORE_SCAN: f64 = 0.2;

/// Kinds of tests.
const KINDS: usize = 3;

/// Ways of reading that are followed, of each kind.
const FOLLOWED: usize = 2;

/// Reads surfaces with a key, in their order, until it is sure.
pub fn read<'a>(
    surfaces: &mut dyn Iterator<Item = Cow<'a, Surface>>,
    key: &Key,
    progress: &mut dyn Progress,
) -> Result<Reading, Cancelled> {
    read_at(surfaces, &Lattice::of(key), progress)
}

/// The same with the lattice of a key.
fn read_at<'a>(
    surfaces: &mut dyn Iterator<Item = Cow<'a, Surface>>,
    lattice: &Lattice,
    progress: &mut dyn Progress,
) -> Result<Reading, Cancelled> {
    let Some(suspect) = surfaces.next() else {
        return Ok(Reading::default());
    };
    let axes = suspect.axes;
    let mut search = Search::new(lattice, suspect);
    let is_undetermined = axes.contains(&Axes::Undetermined);
    let share = if is_undetermined {
        SHARE_BEFORE_SCAN
    } else {
        1.0
    };
    let mut looked = 0.0;
    while !search.is_sure() {
        step(progress, Stage::Test, share * looked)?;
        let Some(surface) = surfaces.next() else {
            break;
        };
        looked = part_until(surface.origin);
        search.look(surface);
    }
    if is_undetermined && !search.is_sure() {
        search.scan(axes, progress)?;
    }
    Ok(search.conclude())
}

/// Nodes of all families.
fn num_nodes() -> usize {
    FAMILIES.iter().map(|family| family.len()).sum()
}

/// How much of all that can be looked at there is up to a surface.
fn part_until(origin: Origin) -> f64 {
    let place = match origin {
        Origin::Suspect => 0,
        Origin::Refined => 1,
        Origin::Filtered { family, node } => {
            let before = FAMILIES[..usize::from(family)].iter();
            2 + before.map(|family| family.len()).sum::<usize>() + usize::from(node)
        }
    };
    (place + 1) as f64 / (2 + num_nodes()) as f64
}

/// A measured surface, as the pilots see it.
struct Node<'a> {
    surface: Cow<'a, Surface>,
    clusters: OnceCell<Vec<Cluster>>,
    /// For each of the surface's pitches and each turn.
    pilots: Vec<Vec<Window>>,
}

impl<'a> Node<'a> {
    fn new(surface: Cow<'a, Surface>) -> Node<'a> {
        Node {
            surface,
            clusters: OnceCell::new(),
            pilots: Vec::new(),
        }
    }

    fn clusters(&self) -> &[Cluster] {
        self.clusters.get_or_init(|| self.surface.store.clusters())
    }

    /// Which of the surface's pitches one is.
    fn place(&self, pitch: f64) -> Option<usize> {
        self.surface.pitches.iter().position(|own| *own == pitch)
    }

    fn field(&self, pitch: f64) -> Option<&Field> {
        self.surface
            .fields
            .iter()
            .find(|field| field.pitch() == pitch)
    }

    /// The windows of a lattice in one of its pitches that are wanted, and the number of all.
    fn windows(
        &self,
        placement: &Placement,
        wanted: impl FnMut(&mut Window) -> bool,
    ) -> (Vec<Window>, usize) {
        match self.field(placement.pitch) {
            Some(field) => field.windows(placement, wanted),
            None => {
                let mut seen = windows(self.clusters(), placement);
                let num_seen = seen.len();
                seen.retain_mut(wanted);
                (seen, num_seen)
            }
        }
    }
}

/// A way of reading.
#[derive(Clone)]
struct Candidate {
    /// How well the pilots agree, in nats: the exponent of their bound.
    evidence: f64,
    /// Indices of the nodes that its strength lies among, and their strengths.
    nodes: Vec<usize>,
    strengths: Vec<f64>,
    view: View,
    step: f64,
}

struct Search<'a> {
    lattice: &'a Lattice,
    turns: Vec<DMat3>,
    nodes: Vec<Node<'a>>,
    num_windows: usize,
    /// The best ways of reading the suspect as it is, best first.
    own: Vec<Candidate>,
    /// The best ways of undoing something.
    undone: Vec<Candidate>,
    /// The best of a scan.
    scanned: Option<Candidate>,
}

impl<'a> Search<'a> {
    fn new(lattice: &'a Lattice, suspect: Cow<'a, Surface>) -> Search<'a> {
        let mut search = Search {
            lattice,
            turns: turns(suspect.axes != [Axes::Distinct; 2]),
            nodes: Vec::new(),
            num_windows: 0,
            own: Vec::new(),
            undone: Vec::new(),
            scanned: None,
        };
        search.look(suspect);
        search
    }

    fn is_sure(&self) -> bool {
        let best = self
            .own
            .iter()
            .chain(&self.undone)
            .map(|candidate| candidate.evidence);
        best.fold(0.0, f64::max) >= ENOUGH
    }

    /// Looks at a surface, and at those between it and the last of its family.
    fn look(&mut self, surface: Cow<'a, Surface>) {
        let origin = surface.origin;
        let pitches = surface.pitches.clone();
        let mut node = Node::new(surface);
        for &pitch in &pitches {
            for &turn in &self.turns {
                let is_pilot = |window: &mut Window| {
                    let (dither, symbol) = self.lattice.at(window.index);
                    window.dither = dither;
                    symbol == Symbol::Pilot
                };
                let placement = self.lattice.placed(turn, pitch);
                let (pilots, num_windows) = node.windows(&placement, is_pilot);
                self.num_windows = self.num_windows.max(num_windows);
                node.pilots.push(pilots);
            }
        }
        self.nodes.push(node);
        for pitch in pitches {
            match origin {
                Origin::Filtered { family, .. } => self.look_between(family, pitch),
                _ => self.consider(&[self.nodes.len() - 1], &[0.0], pitch, 0.0),
            }
        }
    }

    /// The surfaces of a family that are read at a pitch, as indices of nodes, and their strengths: the suspect is the first.
    fn family(&self, family: u8, pitch: f64) -> (Vec<usize>, Vec<f64>) {
        let strength_of = |node: &Node| match node.surface.origin {
            Origin::Suspect => Some(0.0),
            Origin::Filtered {
                family: other,
                node,
            } if other == family => Some(FAMILIES[usize::from(family)].strength(node.into())),
            _ => None,
        };
        let of_pitch = |(number, node): (usize, &Node)| {
            let strength = strength_of(node).filter(|_| node.place(pitch).is_some());
            strength.map(|strength| (number, strength))
        };
        self.nodes.iter().enumerate().filter_map(of_pitch).unzip()
    }

    /// Looks at what lies between the last two surfaces of a family that are read at a pitch.
    fn look_between(&mut self, family: u8, pitch: f64) {
        let (nodes, strengths) = self.family(family, pitch);
        match strengths[..] {
            [.., low, high] => {
                for part in 1..=STRENGTHS {
                    let share = part as f64 / STRENGTHS as f64;
                    let strength = low + (high - low) * share;
                    self.consider(&nodes, &strengths, pitch, strength);
                }
            }
            [only] => self.consider(&nodes, &strengths, pitch, only),
            [] => {}
        }
    }

    /// Weighs all turns and steps of a surface of some strength.
    fn consider(&mut self, nodes: &[usize], strengths: &[f64], pitch: f64, strength: f64) {
        let parts = weights(strengths, strength);
        for (number, &turn) in self.turns.iter().enumerate() {
            let lists = parts.iter().filter_map(|&(part, weight)| {
                let node = &self.nodes[nodes[part]];
                let place = node.place(pitch)? * self.turns.len() + number;
                Some((node.pilots[place].as_slice(), weight))
            });
            let pilots = blend(lists);
            let best = if nodes == [0] {
                &mut self.own
            } else {
                &mut self.undone
            };
            for step in STEPS {
                let evidence = evidence(&pilots, step / pitch);
                let place = best.partition_point(|other| other.evidence >= evidence);
                if place < FOLLOWED {
                    let candidate = Candidate {
                        evidence,
                        nodes: nodes.to_vec(),
                        strengths: strengths.to_vec(),
                        view: View {
                            placement: self.lattice.placed(turn, pitch),
                            strength,
                        },
                        step,
                    };
                    best.insert(place, candidate);
                    best.truncate(FOLLOWED);
                }
            }
        }
    }

    /// Turns the suspect about the axes that its frame cannot tell apart.
    fn scan(&mut self, axes: [Axes; 2], progress: &mut dyn Progress) -> Result<(), Cancelled> {
        let suspect = &self.nodes[0];
        let pitches = &suspect.surface.pitches;
        let share = (1.0 - SHARE_BEFORE_SCAN) / pitches.len() as f64;
        for (number, &pitch) in pitches.iter().enumerate() {
            let start = SHARE_BEFORE_SCAN + share * number as f64;
            let field = match suspect.field(pitch) {
                Some(field) => Cow::Borrowed(field),
                None => Cow::Owned(Field::new(suspect.clusters(), pitch)),
            };
            let found = field::scan(
                &field,
                suspect.clusters(),
                axes,
                self.lattice,
                &mut |part| step(progress, Stage::Test, start + share * part),
            )?;
            let best = self.scanned.as_ref().map_or(0.0, |best| best.evidence);
            if found.evidence > best {
                self.scanned = Some(Candidate {
                    evidence: found.evidence,
                    nodes: vec![0],
                    strengths: vec![0.0],
                    view: View {
                        placement: self.lattice.placed(found.turn, pitch),
                        strength: 0.0,
                    },
                    step: found.step,
                });
            }
        }
        Ok(())
    }

    /// A candidate, whose strength may now move among all that was measured of its family, not only to where it was met.
    fn with_whole_family(&self, candidate: &Candidate) -> Candidate {
        let last = candidate.nodes.last().map(|&node| &self.nodes[node]);
        let mut candidate = candidate.clone();
        if let Some(Origin::Filtered { family, .. }) = last.map(|node| node.surface.origin) {
            let pitch = candidate.view.placement.pitch;
            (candidate.nodes, candidate.strengths) = self.family(family, pitch);
        }
        candidate
    }

    /// All windows of a candidate's surface at a view, by what each surface shows of a placement.
    fn see(
        &self,
        candidate: &Candidate,
        view: &View,
        windows: impl Fn(&Node, &Placement) -> Vec<Window>,
    ) -> Vec<Window> {
        let parts = weights(&candidate.strengths, view.strength);
        let lists: Vec<(Vec<Window>, f64)> = parts
            .into_iter()
            .map(|(part, weight)| {
                let node = &self.nodes[candidate.nodes[part]];
                (windows(node, &view.placement), weight)
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

    fn conclude(&self) -> Reading {
        let num_views = |num_pitches| num_pitches * self.turns.len() * STEPS.len();
        let num_own = num_views(self.nodes[0].surface.pitches.len());
        let num_undone = num_views(MOST_PITCHES) * (1 + STRENGTHS * num_nodes());
        let declared = |node: &Node, placement: &Placement| node.windows(placement, |_| true).0;
        // Small moves show in differences, where interpolation would show as well.
        let exact = |node: &Node, placement: &Placement| windows(node.clusters(), placement);
        let mut hypotheses = Vec::new();
        for (candidates, num_declared) in [(&self.own, num_own), (&self.undone, num_undone)] {
            hypotheses.extend(candidates.iter().map(|candidate| {
                let view = &candidate.view;
                Hypothesis {
                    symbols: self.symbols(candidate, view, self.see(candidate, view, declared)),
                    ln_num_tests: libm::log((KINDS * num_declared) as f64),
                }
            }));
        }
        let to_refine = [
            (self.own.first(), 4.5),
            (self.undone.first(), 9.0),
            (self.scanned.as_ref(), 9.0),
        ];
        for (candidate, least) in to_refine {
            // What is less than the best of so many that chance gives leads nowhere, and there is no need where all is clear.
            let is_worth_it =
                |candidate: &&Candidate| candidate.evidence >= least && !self.is_sure();
            let Some(candidate) = candidate.filter(is_worth_it) else {
                continue;
            };
            let candidate = self.with_whole_family(candidate);
            let see = |view: &View| self.see(&candidate, view, exact);
            let view = refine(&see, &candidate.view, self.lattice, candidate.step);
            let mut symbols = self.symbols(&candidate, &view, see(&view));
            symbols.retain(|soft| soft.symbol != Symbol::Pilot);
            hypotheses.push(Hypothesis {
                symbols,
                ln_num_tests: libm::log((KINDS * to_refine.len()) as f64),
            });
        }
        Reading {
            hypotheses,
            num_addresses: self.num_windows,
        }
    }
}

/// How well pilots agree with a quantizer's step, in nats.
fn evidence(pilots: &[Window], step: f64) -> f64 {
    let read = |pilot: &Window| {
        let weight = pilot.weight.max(0.0);
        (
            weight * cosine(phase(pilot.flux / step, pilot.dither)),
            weight,
        )
    };
    -Statistic::new(pilots.iter().map(read)).ln_p()
}

/// The rotations that take a frame into itself: 4 if its axes are known but for their signs, else 24.
fn turns(near: bool) -> Vec<DMat3> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut turns = Vec::new();
    for (first, second) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
        for (a, b) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let (x, y) = (axes[first] * a, axes[second] * b);
            turns.push(DMat3::from_cols(x, y, x.cross(y)));
        }
        if !near {
            break;
        }
    }
    turns
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::super::Surfaces;
    use super::*;
    use crate::mesh::{Mesh, shapes};
    use crate::progress::ignore;

    fn reading(surfaces: &[Surface], lattice: &Lattice) -> Reading {
        read_at(
            &mut surfaces.iter().map(Cow::Borrowed),
            lattice,
            &mut ignore,
        )
        .unwrap()
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
            ("undone", of(&rock, Surfaces::first_kind), 3),
            ("scanned", of(&shapes::torus(40, 24), Surfaces::plain), 3),
        ];
        let mut num_split = 0;
        for (name, surfaces, keys) in &suspects {
            for number in 0..*keys {
                let key = Key::from_bytes(&[number + 1; Key::BYTES]).unwrap();
                let drawn = reading(surfaces, &Lattice::of(&key));
                for other in 0..3 {
                    let lattice = Lattice {
                        redrawn: Some(
                            Key::from_bytes(&[100 + other; Key::BYTES])
                                .unwrap()
                                .prf("x"),
                        ),
                        ..Lattice::of(&key)
                    };
                    let redrawn = reading(surfaces, &lattice);
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
