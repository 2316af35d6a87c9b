//! Which surface, pitch, turn of the frame, step and strength of smoothing suit a key: pilots choose, among ways of reading that
//! were declared before any key was known.

use super::cluster::{Cluster, merged};
use super::frame::{Axes, turns};
use super::lattice::Lattice;
use super::pitch::AREAS_IF_STRETCHED;
use super::quantizer::{STEPS, cosine, phase};
use super::refine::View;
use super::scan::scan;
use super::strength::{FAMILIES, blend, weights};
use super::stretch::{CELLS_PER_PITCH, half, mapped};
use super::surface::{Origin, Surface};
use super::window::{Window, windows};
use crate::code::Symbol;
use crate::detection::Statistic;
use crate::progress::{Cancelled, Progress, Stage, step};
use glam::DMat3;
use std::borrow::Cow;

/// Pilots that agree better than this, in nats, end the search: what follows would only undo attacks that did not happen.
const ENOUGH: f64 = 40.0;

/// Strengths that are tried between two nodes, the further node included.
pub const STRENGTHS: usize = 8;

/// The share of the time of a search that a scan takes, where it begins with one, and of the rest what comes before stretches.
const SHARE_OF_SCAN: f64 = 0.7;
const SHARE_BEFORE_STRETCHES: f64 = 0.5;

/// Ways of reading that are followed, of each kind.
pub const FOLLOWED: usize = 2;

/// A measured surface, as the pilots see it.
pub struct Node<'a> {
    pub surface: Cow<'a, Surface>,
    pub clusters: Vec<Cluster>,
    /// For each of the surface's pitches and each turn.
    pilots: Vec<Vec<Window>>,
}

impl<'a> Node<'a> {
    fn new(surface: Cow<'a, Surface>) -> Node<'a> {
        Node {
            clusters: surface.store.clusters(),
            surface,
            pilots: Vec::new(),
        }
    }

    /// Which of the surface's pitches one is.
    fn place(&self, pitch: f64) -> Option<usize> {
        self.surface.pitches.iter().position(|own| *own == pitch)
    }
}

/// A way of reading.
#[derive(Clone)]
pub struct Candidate {
    /// How well the pilots agree, in nats: the exponent of their bound.
    pub evidence: f64,
    /// Indices of the nodes that its strength lies among, and their strengths.
    pub nodes: Vec<usize>,
    pub strengths: Vec<f64>,
    pub view: View,
    pub step: f64,
}

impl Candidate {
    /// Of the suspect's own surface.
    fn of_suspect(evidence: f64, view: View, step: f64) -> Candidate {
        Candidate {
            evidence,
            nodes: vec![0],
            strengths: vec![0.0],
            view,
            step,
        }
    }
}

fn area(clusters: &[Cluster]) -> f64 {
    clusters.iter().map(|cluster| cluster.weight).sum()
}

/// Adds a candidate to the best so many, best first; of equals, those that were met first.
fn keep(best: &mut Vec<Candidate>, most: usize, candidate: Candidate) {
    let place = best.partition_point(|other| other.evidence >= candidate.evidence);
    if place < most {
        best.insert(place, candidate);
        best.truncate(most);
    }
}

pub struct Search<'a> {
    pub lattice: Lattice,
    pub turns: Vec<DMat3>,
    pub nodes: Vec<Node<'a>>,
    pub num_windows: usize,
    /// The best ways of reading the suspect as it is, best first.
    pub own: Vec<Candidate>,
    /// The best ways of undoing something.
    pub undone: Vec<Candidate>,
    /// The best of all stretches.
    pub stretched: Vec<Candidate>,
    /// The best of a scan.
    pub scanned: Option<Candidate>,
}

impl<'a> Search<'a> {
    /// Goes on until it is sure: scans, where axes are undetermined, looks at the rest of a suspect's surfaces in their order, and tries
    /// stretches. It scans and stretches only where it may search widely.
    pub fn go_on(
        &mut self,
        surfaces: &mut dyn Iterator<Item = Cow<'a, Surface>>,
        is_wide: bool,
        progress: &mut dyn Progress,
    ) -> Result<(), Cancelled> {
        let axes = self.nodes[0].surface.axes;
        let mut start = 0.0;
        if is_wide && axes.contains(&Axes::Undetermined) {
            self.scan(axes, &mut |part| {
                step(progress, Stage::Test, SHARE_OF_SCAN * part)
            })?;
            start = SHARE_OF_SCAN;
        }
        let mut report = |part| step(progress, Stage::Test, start + (1.0 - start) * part);
        let mut looked = 0.0;
        while !self.is_sure() {
            report(SHARE_BEFORE_STRETCHES * looked)?;
            let Some(surface) = surfaces.next() else {
                break;
            };
            looked = part_until(surface.origin);
            self.look(surface);
        }
        if is_wide && !self.is_sure() {
            self.stretch(&mut |part| {
                report(SHARE_BEFORE_STRETCHES + (1.0 - SHARE_BEFORE_STRETCHES) * part)
            })?;
        }
        Ok(())
    }

    /// Looks at a suspect as it is.
    pub fn new(lattice: Lattice, suspect: Cow<'a, Surface>) -> Search<'a> {
        let mut search = Search {
            lattice,
            turns: turns(suspect.axes != [Axes::Distinct; 2]),
            nodes: Vec::new(),
            num_windows: 0,
            own: Vec::new(),
            undone: Vec::new(),
            stretched: Vec::new(),
            scanned: None,
        };
        search.look(suspect);
        search
    }

    /// Whether the pilots agree so well that nothing else needs to be tried.
    pub fn is_sure(&self) -> bool {
        let scanned = self.scanned.as_ref();
        self.is_clear() || scanned.is_some_and(|found| found.evidence >= ENOUGH)
    }

    /// Whether they do so in a way of reading that needs no refinement: a scan only comes near the right turn.
    pub fn is_clear(&self) -> bool {
        let mut best = self.own.iter().chain(&self.undone);
        best.any(|candidate| candidate.evidence >= ENOUGH)
    }

    /// Looks at a surface, and at those between it and the last of its family.
    fn look(&mut self, surface: Cow<'a, Surface>) {
        let origin = surface.origin;
        let pitches = surface.pitches.clone();
        let mut node = Node::new(surface);
        for &pitch in &pitches {
            for &turn in &self.turns {
                let placement = self.lattice.placed(turn, pitch);
                let seen = windows(&node.clusters, &placement);
                self.num_windows = self.num_windows.max(seen.len());
                node.pilots.push(pilots(seen, &self.lattice));
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
                let candidate = Candidate {
                    evidence: evidence(&pilots, step / pitch),
                    nodes: nodes.to_vec(),
                    strengths: strengths.to_vec(),
                    view: View {
                        stretch: None,
                        placement: self.lattice.placed(turn, pitch),
                        strength,
                    },
                    step,
                };
                keep(best, FOLLOWED, candidate);
            }
        }
    }

    /// Undoes scales of the suspect along an axis.
    fn stretch(
        &mut self,
        report: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
    ) -> Result<(), Cancelled> {
        let suspect = &self.nodes[0];
        let Some(stretchable) = suspect.surface.stretchable else {
            return Ok(());
        };
        let pitches = suspect.surface.pitches.iter();
        let half = half(&suspect.clusters);
        let share = area(&half) / area(&suspect.clusters);
        let merge = |&pitch: &f64| (pitch, merged(&half, pitch / CELLS_PER_PITCH));
        let coarse: Vec<(f64, Vec<Cluster>)> = pitches.map(merge).collect();
        let tries = stretchable.tries();
        for (number, stretch) in tries.iter().enumerate() {
            report(number as f64 / tries.len() as f64)?;
            for (pitch, clusters) in &coarse {
                let clusters = mapped(clusters, &stretch.map);
                let area = area(&clusters) / share;
                if !AREAS_IF_STRETCHED.contains(&(area / (pitch * pitch))) {
                    continue;
                }
                for turn in turns(stretch.axes != [Axes::Distinct; 2]) {
                    let placement = self.lattice.placed(turn, *pitch);
                    let view = View::of_suspect(placement, Some(stretch.map));
                    let pilots = pilots(windows(&clusters, &placement), &self.lattice);
                    for step in STEPS {
                        let evidence = evidence(&pilots, step / pitch);
                        keep(
                            &mut self.stretched,
                            1,
                            Candidate::of_suspect(evidence, view, step),
                        );
                    }
                }
            }
            if self
                .stretched
                .first()
                .is_some_and(|best| best.evidence >= 0.5 * ENOUGH)
            {
                break;
            }
        }
        Ok(())
    }

    /// Turns the suspect about the axes that its frame cannot tell apart.
    fn scan(
        &mut self,
        axes: [Axes; 2],
        report: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
    ) -> Result<(), Cancelled> {
        let suspect = &self.nodes[0];
        let pitches = &suspect.surface.pitches;
        for (number, &pitch) in pitches.iter().enumerate() {
            let found = scan(&suspect.clusters, pitch, axes, &self.lattice, &mut |part| {
                report((number as f64 + part) / pitches.len() as f64)
            })?;
            let best = self.scanned.as_ref().map_or(0.0, |best| best.evidence);
            if found.evidence > best {
                let placement = self.lattice.placed(found.turn, pitch);
                let view = View::of_suspect(placement, None);
                self.scanned = Some(Candidate::of_suspect(found.evidence, view, found.step));
            }
        }
        Ok(())
    }

    /// A candidate, whose strength may now move among all that was measured of its family, not only to where it was met.
    pub fn with_whole_family(&self, candidate: &Candidate) -> Candidate {
        let last = candidate.nodes.last().map(|&node| &self.nodes[node]);
        let mut candidate = candidate.clone();
        if let Some(Origin::Filtered { family, .. }) = last.map(|node| node.surface.origin) {
            let pitch = candidate.view.placement.pitch;
            (candidate.nodes, candidate.strengths) = self.family(family, pitch);
        }
        candidate
    }
}

/// Nodes of all families.
pub fn num_nodes() -> usize {
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

/// Of windows, those that hold pilots, with what the key adds to their phases.
fn pilots(mut windows: Vec<Window>, lattice: &Lattice) -> Vec<Window> {
    windows.retain_mut(|window| {
        let (dither, symbol) = lattice.at(window.index);
        window.dither = dither;
        symbol == Symbol::Pilot
    });
    windows
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
