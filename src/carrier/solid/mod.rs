//! SOLID: quantization index modulation of a band-passed occupancy field, sampled on a lattice that the key owns.
//!
//! The statistic is an integral over the surface ([`flux`]), so it stays when the tessellation goes: under noise, smoothing,
//! quantization, simplification, subdivision and remeshing. The lattice lies in a canonical frame of the surface, turned and
//! shifted by the key: two owners who mark one model do not meet at the same points. Cropping moves the frame and is RING's
//! to survive.
//!
//! The method and its constants are this project's own (docs/REFERENCES.md, "SOLID"). QIM with dither: Chen and Wornell 2001.

mod embed;
mod flux;
mod measurement;
mod refine;

pub use embed::{NEEDED_WINDOWS, embed};
pub use measurement::Measurement;

use crate::code::Symbol;
use crate::geometry::{Pose, outward};
use crate::key::{Key, Prf};
use crate::mesh::Mesh;
use flux::Placement;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::TAU;

/// Distance of lattice points, in units of the frame: about 4 % of the diagonal.
const PITCH: f64 = 0.2;

/// Radius of the windows about them.
const RADIUS: f64 = 1.2 * PITCH;

/// Steps of the quantizer, in units of the pitch squared. A step suits one strength; a detector tries all.
const STEPS: [f64; 3] = [0.0055, 0.011, 0.022];

/// The step for a strength: 0.022 at 0.08 % of the diagonal, in proportion, to the nearest there is.
fn step_for(rms_rel: f64) -> f64 {
    let ideal = 0.022 * rms_rel / 0.0008;
    let distance = |step: f64| libm::log(step / ideal).abs();
    STEPS
        .into_iter()
        .min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        .unwrap_or(STEPS[0])
}

/// A mesh with its triangles facing outwards.
fn oriented(mesh: &Mesh) -> Mesh {
    Mesh {
        positions: mesh.positions.clone(),
        triangles: outward(mesh),
    }
}

/// The frame of an oriented mesh: by volume moments, or by area moments where it encloses next to nothing.
fn pose_of(mesh: &Mesh) -> Option<Pose> {
    Pose::of_volume(mesh).or_else(|| Pose::of(mesh))
}

/// Windows that a mesh offers to a lattice that lies along its axes, as far as its vertices are free to serve them; a key's
/// own lattice sees about as many.
pub fn num_windows(mesh: &Mesh) -> usize {
    let mesh = oriented(mesh);
    let along = Placement {
        rotation: DMat3::IDENTITY,
        origin: DVec3::ZERO,
        scale: 1.0,
    };
    let windows = pose_of(&mesh).map_or(0, |pose| {
        flux::windows(&flux::clusters(&mesh, &pose), &along).len()
    });
    windows.min(3 * mesh.positions.len())
}

/// The lattice of one key: where it lies, and what its points hold.
struct Lattice {
    rotation: DMat3,
    shift: DVec3,
    symbols: Prf,
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
        let shift = DVec3::new(uniform(3), uniform(4), uniform(5)) - DVec3::splat(0.5);
        Lattice {
            rotation: DMat3::from_quat(turn),
            shift: shift * PITCH,
            symbols: key.prf("solid"),
        }
    }

    /// The lattice in a frame whose axes are turned.
    fn placed(&self, turn: DMat3) -> Placement {
        let rotation = turn * self.rotation;
        Placement {
            rotation,
            origin: rotation * self.shift,
            scale: 1.0,
        }
    }

    /// What a lattice point holds: its dither, 0 to 1 in steps of the quantizer, and its symbol.
    fn at(&self, [i, j, k]: [i32; 3]) -> (f64, Symbol) {
        let part = |index: i32| (index + (1 << 19)) as u64 & ((1 << 20) - 1);
        let (dither, choice) = self.symbols.at(part(i) << 40 | part(j) << 20 | part(k));
        (unit(dither), Symbol::select(choice))
    }
}

fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}
