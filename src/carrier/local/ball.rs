//! A ball: the lattice of a key about a place, in one of the place's frames, at a pitch that its width gives.

use crate::carrier::solid::cluster::Cluster;
use crate::carrier::solid::lattice::{Lattice, Placement};
use crate::carrier::solid::window::{Window, windows};
use crate::code::Symbol;
use crate::geometry::places::{Areas, Piece, Place, near};
use crate::key::Key;
use glam::{DMat3, DVec3};
use std::ops::Range;

/// Widths of places, as fractions of the diagonal.
const WIDTHS: Range<f64> = 0.014..0.1;

/// Pitches that a ball may have, in widths of its place.
pub const RATIOS: [f64; 6] = [0.5, 0.71, 1.0, 1.41, 2.0, 2.83];

/// Radius of a ball, in pitches.
pub const RADIUS: f64 = 5.0;

/// What a window sees beyond its ball, in pitches, and a little more for a lattice that is moved.
pub const MARGIN: f64 = 1.6;

/// Steps of the quantizer: displacements of a surface, in pitches, that take a window of about a squared pitch of it from one symbol
/// to the same symbol again.
pub const STEPS: [f64; 6] = [0.14, 0.1, 0.07, 0.05, 0.035, 0.025];

/// Kinds of places, frames and ratios: balls of different classes share no dither.
pub const CLASSES: usize = 6 * 2 * RATIOS.len();

/// Places for which a surface is looked through, by its diagonal, in scene units.
pub fn widths(diagonal: f64) -> Range<f64> {
    WIDTHS.start * diagonal..WIDTHS.end * diagonal
}

/// A place, one of its frames and a pitch.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    pub place: Place,
    /// Which of the place's frames.
    pub frame: usize,
    /// Which of [`RATIOS`].
    pub ratio: usize,
}

impl Ball {
    /// What its dithers depend on beside the key and the lattice point.
    pub fn class(&self) -> usize {
        let kind = self.place.invariant as usize * 2 + usize::from(self.place.is_high);
        (kind * 2 + self.frame) * RATIOS.len() + self.ratio
    }

    /// In scene units.
    pub fn pitch(&self) -> f64 {
        self.place.width * RATIOS[self.ratio]
    }

    pub fn axes(&self) -> DMat3 {
        self.place.frames[self.frame].axes
    }

    /// Where a lattice lies if two of the axes are turned over, or none.
    pub fn placement(&self, lattice: &Lattice, signs: DVec3) -> Placement {
        let axes = self.axes() * DMat3::from_diagonal(signs);
        let placement = lattice.placed(axes, self.pitch());
        Placement {
            origin: placement.origin + self.place.point,
            ..placement
        }
    }

    /// The surface that its windows see.
    pub fn clusters(&self, areas: &Areas) -> Vec<Cluster> {
        let level = areas.level(self.pitch() / 3.0);
        let reach = (RADIUS + MARGIN) * self.pitch();
        let cluster = |piece: Piece| Cluster {
            centre: piece.point,
            area: piece.area,
            moment: piece.moment,
            weight: piece.weight,
        };
        let pieces = near(&level.pieces, self.place.point, reach);
        pieces.into_iter().map(cluster).collect()
    }
}

/// The lattice of a key for balls of a class: it lies alike in all of them.
pub fn lattice(key: &Key, class: usize) -> Lattice {
    let symbols = format!("local/{class}");
    Lattice::labelled(key, ["local/lattice", &symbols], select)
}

/// The symbol that 64 random bits select: every second one is a pilot. Pilots choose here among thousands of balls.
fn select(random: u64) -> Symbol {
    match random & 1 {
        0 => Symbol::Pilot,
        // What is 1 modulo 3 selects no pilot.
        _ => Symbol::select(3 * (random >> 3) + 1),
    }
}

/// The windows of a ball, in increasing order of index.
pub fn windows_of(clusters: &[Cluster], lattice: &Lattice, placement: &Placement) -> Vec<Window> {
    let centre = lattice.centre();
    let mut windows = windows(clusters, placement);
    windows.retain(|window| {
        let point = DVec3::from_array(window.index.map(f64::from));
        point.distance_squared(centre) <= RADIUS * RADIUS
    });
    windows
}
