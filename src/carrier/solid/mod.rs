//! SOLID: quantization index modulation of a band-passed occupancy field, sampled on a lattice that the key owns.
//!
//! The statistic is an integral over the surface ([`flux`]), so it stays when the tessellation goes: under noise, smoothing,
//! quantization, simplification, subdivision and remeshing. The lattice lies in a canonical frame of the surface, turned and
//! shifted by the key: two owners who mark one model do not meet at the same points. Cropping moves the frame and is RING's
//! to survive.
//!
//! The method and its constants are this project's own (docs/REFERENCES.md, "SOLID"). QIM with dither: Chen and Wornell 2001.

mod embed;
mod field;
mod flux;
mod freedom;
mod measurement;
mod problem;
mod refine;
mod search;
mod store;
mod strength;

pub use embed::{NEEDED_WINDOWS, embed};
pub use measurement::{Measurement, Surface, Surfaces};

use crate::code::Symbol;
use crate::geometry::{Pose, oriented};
use crate::key::{Key, Prf};
use crate::mesh::{Edges, Mesh};
use flux::Placement;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::TAU;

/// Distances of lattice points, in units of the frame: a fifth is about 4 % of the diagonal.
const PITCHES: [f64; 6] = [0.05, 0.07, 0.1, 0.14, 0.2, 0.3];

/// The area of a surface, in squared pitches, for which an embedder uses a pitch: some 1 500 to 3 500 windows. With fewer there is
/// too little to say a message with, and more marks beside it drown it; with more, windows are so small that attacks reach into
/// them. One pitch suits every surface whose area in its own frame is 2 to 160.
const AREAS_TO_EMBED: std::ops::Range<f64> = 800.0..1810.0;

/// The same for a detector: attacks change a surface's area, and it has to try what an embedder chose.
const AREAS: std::ops::Range<f64> = 680.0..2150.0;

/// The largest area of a surface in squares of the finest pitch that it is read at: a suspect's, times what undoing a smoothing may
/// add. What is larger is left out.
const LARGEST_AREA: f64 = 2150.0 * SPIKY_IF_FEW;

/// A filtered surface that is so many times larger than the suspect has spikes, and is left out.
const SPIKY: f64 = 1.6;

/// The same for meshes of few triangles.
const SPIKY_IF_FEW: f64 = 3.0;

/// Pitches that a surface is read at, at most: no three of them have the area between these bounds.
const MOST_PITCHES: usize = 2;

/// Steps of the quantizer: the displacement of a surface, in units of the frame, that takes a window of about a squared pitch
/// of it from one symbol to the same symbol again. Each is smaller than the one before by a factor of sqrt 2.
const STEPS: [f64; 6] = [0.035, 0.0247, 0.0175, 0.0124, 0.00875, 0.0062];

/// The steps for a strength, the largest first: 0.035 at 0.08 % of the diagonal, in proportion. Large steps stand more noise;
/// smaller ones ask less of meshes with few vertices.
fn steps_for(rms_rel: f64) -> &'static [f64] {
    let ideal = STEPS[0] * rms_rel / 0.0008;
    let first = STEPS.partition_point(|step| *step > 1.19 * ideal);
    &STEPS[first.min(STEPS.len() - 1)..]
}

/// The frame of an oriented mesh with a boundary: by volume moments, or by area moments where it encloses next to nothing.
fn pose_of(mesh: &Mesh, boundary: &[(u32, u32)]) -> Option<Pose> {
    Pose::of_volume(mesh, boundary).or_else(|| Pose::of(mesh))
}

/// The directed edges of a mesh that have one face.
fn boundary(mesh: &Mesh) -> Vec<(u32, u32)> {
    Edges::new(mesh).boundary(&mesh.triangles).collect()
}

/// The pitches for a surface of an area in units of the frame.
fn pitches(area: f64, areas: std::ops::Range<f64>) -> impl Iterator<Item = f64> {
    PITCHES
        .into_iter()
        .filter(move |pitch| areas.contains(&(area / (pitch * pitch))))
}

/// Windows that a mesh offers to a lattice that lies along its axes, as far as its vertices are free to serve them; a key's
/// own lattice sees about as many.
pub fn num_windows(mesh: &Mesh) -> usize {
    let (mesh, boundary) = oriented(mesh);
    let Some(pose) = pose_of(&mesh, &boundary) else {
        return 0;
    };
    let num = |pitch| {
        let along = Placement {
            rotation: DMat3::IDENTITY,
            origin: DVec3::ZERO,
            pitch,
        };
        flux::windows(&flux::clusters(&mesh, &pose, pitch), &along).len()
    };
    let most = pitches(mesh.area() / (pose.size * pose.size), AREAS_TO_EMBED).map(num);
    most.max().unwrap_or(0).min(3 * mesh.positions.len())
}

/// The lattice of one key: where it lies, and what its points hold.
struct Lattice {
    rotation: DMat3,
    /// In pitches.
    shift: DVec3,
    symbols: Prf,
    /// Other dithers for all symbols but pilots: what may not depend on them must stay as it is.
    #[cfg(test)]
    redrawn: Option<Prf>,
}

impl Lattice {
    /// A rotation uniform on SO(3) (Shoemake 1992) and a shift uniform in one cell.
    fn of(key: &Key) -> Lattice {
        let place = key.prf("solid/lattice");
        let uniform = |address: u64| unit(place.at(address).0);
        let (a, b, c) = (uniform(0), TAU * uniform(1), TAU * uniform(2));
        let (p, q) = ((1.0 - a).sqrt(), a.sqrt());
        let turn = DQuat::from_xyzw(
            p * libm::sin(b),
            p * libm::cos(b),
            q * libm::sin(c),
            q * libm::cos(c),
        );
        Lattice {
            rotation: DMat3::from_quat(turn),
            shift: DVec3::new(uniform(3), uniform(4), uniform(5)) - DVec3::splat(0.5),
            symbols: key.prf("solid"),
            #[cfg(test)]
            redrawn: None,
        }
    }

    /// The lattice in a frame whose axes are turned.
    fn placed(&self, turn: DMat3, pitch: f64) -> Placement {
        let rotation = turn * self.rotation;
        Placement {
            rotation,
            origin: rotation * self.shift * pitch,
            pitch,
        }
    }

    /// What a lattice point holds: its dither, 0 to 1 in steps of the quantizer, and its symbol.
    fn at(&self, [i, j, k]: [i32; 3]) -> (f64, Symbol) {
        // Points farther than this would share an address with nearer ones. A window sees clusters, which lie within the
        // frame's extent, so there are none.
        debug_assert!([i, j, k].iter().all(|index| index.abs() < 1 << 19));
        let part = |index: i32| (index + (1 << 19)) as u64 & ((1 << 20) - 1);
        let address = part(i) << 40 | part(j) << 20 | part(k);
        let (dither, choice) = self.symbols.at(address);
        let symbol = Symbol::select(choice);
        #[cfg(test)]
        if let Some(redrawn) = self.redrawn.as_ref().filter(|_| symbol != Symbol::Pilot) {
            return (unit(redrawn.at(address).0), symbol);
        }
        (unit(dither), symbol)
    }
}

fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// The phase, in turns, of a flux in steps of the quantizer under a dither. Whole steps are dropped first: a suspect may offer a
/// flux of any size, and added to a large one the dither would be rounded away.
fn phase(steps: f64, dither: f64) -> f64 {
    fraction(steps) + dither
}

/// What is left of a number when the nearest whole one is taken off, -1/2 to 1/2, without any rounding.
fn fraction(number: f64) -> f64 {
    /// Adding and subtracting it rounds to the nearest whole number, for numbers up to a third of it.
    const ROUND: f64 = 1.5 / f64::EPSILON;
    /// Numbers beyond 2^50 count as this one, and so does what is no number: their fractions say nothing.
    const MOST: f64 = 0.25 / f64::EPSILON;
    let number = held(number, MOST);
    number - (number + ROUND - ROUND)
}

/// A number, or the nearest in `-most..=most`. What is none becomes `-most`, where `clamp` would leave it: nothing that follows has
/// to ask.
fn held(number: f64, most: f64) -> f64 {
    number.max(-most).min(most)
}

/// The cosine of an angle in turns, to within 1e-11, from additions and products alone: a detector takes millions of them.
fn cosine(turns: f64) -> f64 {
    /// Of the sine of an angle in turns: `(-1)^n tau^(2n+1) / (2n+1)!`.
    const SERIES: [f64; 8] = {
        let mut series = [TAU; 8];
        let mut n = 1;
        while n < 8 {
            series[n] = -series[n - 1] * TAU * TAU / ((2 * n) as f64 * (2 * n + 1) as f64);
            n += 1;
        }
        series
    };
    let quarter = 0.25 - fraction(turns).abs();
    let square = quarter * quarter;
    quarter * SERIES.iter().rev().fold(0.0, |sum, c| sum * square + c)
}

#[cfg(test)]
mod tests {
    use super::{cosine, phase};

    const STEPS: [f64; 9] = [
        0.0,
        -0.3,
        1e6 + 0.25,
        4e15,
        -1e17,
        1e300,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];

    #[test]
    fn no_flux_swallows_a_dither() {
        for steps in STEPS {
            let [none, some] = [0.0, 0.3].map(|dither| phase(steps, dither));
            assert!((some - none - 0.3).abs() < 1e-15, "{steps}");
            assert!((-0.5..=0.5).contains(&none), "{steps}");
        }
        assert_eq!(phase(1e6 + 0.25, 0.5), 0.75);
    }

    #[test]
    fn cosines_stay_within_one() {
        for turns in STEPS {
            assert!(cosine(turns).abs() <= 1.0 + 1e-11, "{turns}");
        }
        assert!((cosine(7.125) - 0.5f64.sqrt()).abs() < 1e-11);
    }
}
