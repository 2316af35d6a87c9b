//! Which surface, pitch, turn of the frame, step and strength of smoothing suit a key: pilots choose, among ways of reading that
//! were declared before any key was known.

use super::cluster::Cluster;
use super::frame::{Axes, turns};
use super::lattice::Lattice;
use super::quantizer::{STEPS, cosine, phase};
use super::refine::View;
use super::scan::scan;
use super::strength::{FAMILIES, blend, weights};
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

/// The share of the time that a search takes which ends in a scan, before that.
const SHARE_BEFORE_SCAN: f64 = 0.2;

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

pub struct Search<'a> {
    pub lattice: Lattice,
    pub turns: Vec<DMat3>,
    pub nodes: Vec<Node<'a>>,
    pub num_windows: usize,
    /// The best ways of reading the suspect as it is, best first.
    pub own: Vec<Candidate>,
    /// The best ways of undoing something.
    pub undone: Vec<Candidate>,
    /// The best of a scan.
    pub scanned: Option<Candidate>,
}

impl<'a> Search<'a> {
    /// Looks at the rest of a suspect's surfaces in their order, until it is sure; then, where axes are undetermined, scans if it may.
    pub fn go_on(
        &mut self,
        surfaces: &mut dyn Iterator<Item = Cow<'a, Surface>>,
        may_scan: bool,
        progress: &mut dyn Progress,
    ) -> Result<(), Cancelled> {
        let axes = self.nodes[0].surface.axes;
        let scans = may_scan && axes.contains(&Axes::Undetermined);
        let share = if scans { SHARE_BEFORE_SCAN } else { 1.0 };
        let mut looked = 0.0;
        while !self.is_sure() {
            step(progress, Stage::Test, share * looked)?;
            let Some(surface) = surfaces.next() else {
                break;
            };
            looked = part_until(surface.origin);
            self.look(surface);
        }
        if scans && !self.is_sure() {
            self.scan(axes, progress)?;
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
            scanned: None,
        };
        search.look(suspect);
        search
    }

    pub fn is_sure(&self) -> bool {
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
                let mut seen = windows(&node.clusters, &placement);
                self.num_windows = self.num_windows.max(seen.len());
                seen.retain_mut(is_pilot);
                node.pilots.push(seen);
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
            let found = scan(&suspect.clusters, pitch, axes, &self.lattice, &mut |part| {
                step(progress, Stage::Test, start + share * part)
            })?;
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
