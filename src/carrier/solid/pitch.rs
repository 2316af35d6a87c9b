//! Pitches: how far apart a lattice's points are, by the area of the surface that it is laid through.

use crate::geometry::Pose;
use std::ops::Range;

/// Distances of lattice points, in units of the frame: a fifth is about 4 % of the diagonal.
pub const PITCHES: [f64; 6] = [0.05, 0.07, 0.1, 0.14, 0.2, 0.3];

/// The area of a surface, in squared pitches, for which an embedder uses a pitch: some 1 500 to 3 500 windows. With fewer there is
/// too little to say a message with, and more marks beside it drown it; with more, windows are so small that attacks reach into
/// them. One pitch or two suit every surface whose area in its own frame is 2 to 162.
const AREAS_TO_EMBED: Range<f64> = 800.0..1810.0;

/// The same for surfaces that have no pitch then, of an area of less than 2 or more than 162: long rods, and what is folded all over. Attacks may
/// change their area by less.
const AREAS_AT_THE_ENDS: Range<f64> = 740.0..1950.0;

/// The same for a detector: attacks change a surface's area, and it has to try what an embedder chose.
pub const AREAS: Range<f64> = 680.0..2150.0;

/// The same where a stretch is undone, which gives back the area that the embedder saw, but for what simplification takes: a narrower
/// range, for every pitch takes as long as all others.
pub const AREAS_IF_STRETCHED: Range<f64> = 780.0..1860.0;

/// The largest area of a surface in squares of the finest pitch that it is read at: a suspect's, times what undoing a smoothing may
/// add. What is larger is left out.
pub const LARGEST_AREA: f64 = AREAS.end * SPIKY_IF_FEW;

/// A filtered surface that is so many times larger than the suspect has spikes, and is left out.
pub const SPIKY: f64 = 1.6;

/// The same for meshes of few triangles.
pub const SPIKY_IF_FEW: f64 = 3.0;

/// Pitches that a surface is read at, at most: no three of them have the area between these bounds.
pub const MOST_PITCHES: usize = 2;

/// The pitches for a surface of an area in units of the frame.
pub fn pitches(area: f64, areas: Range<f64>) -> impl Iterator<Item = f64> {
    PITCHES
        .into_iter()
        .filter(move |pitch| areas.contains(&(area / (pitch * pitch))))
}

/// The pitches that an embedder takes for a surface of an area in units of the frame.
pub fn pitches_to_embed(area: f64) -> impl Iterator<Item = f64> {
    let has_some = pitches(area, AREAS_TO_EMBED).next().is_some();
    let areas = match has_some {
        true => AREAS_TO_EMBED,
        false => AREAS_AT_THE_ENDS,
    };
    pitches(area, areas)
}

/// The pitches that a surface of an area is read at, the finest first.
pub fn pitches_of(area: f64, pose: &Pose) -> Vec<f64> {
    pitches(area / (pose.size * pose.size), AREAS).collect()
}
