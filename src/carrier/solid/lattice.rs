//! The lattice of a key: where its points lie in a frame, and what each of them holds.

use crate::code::Symbol;
use crate::key::{Key, Prf, unit};
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::TAU;

/// Radius of the window about a lattice point, in pitches.
pub const RADIUS: f64 = 1.2;

/// The lattice of one key: where it lies, and what its points hold.
pub struct Lattice {
    rotation: DMat3,
    /// In pitches.
    shift: DVec3,
    symbols: Prf,
    /// Which symbol the second word of an address selects.
    select: fn(u64) -> Symbol,
    /// Other dithers for all symbols but pilots: what may not depend on them must stay as it is.
    #[cfg(test)]
    redrawn: Option<Prf>,
}

impl Lattice {
    /// A rotation uniform on SO(3) (Shoemake 1992) and a shift uniform in one cell.
    pub fn of(key: &Key) -> Lattice {
        Lattice::labelled(key, ["solid/lattice", "solid"], Symbol::select)
    }

    /// The same by other sub-keys, for where it lies and for what its points hold, and with another share of pilots.
    pub fn labelled(key: &Key, [place, symbols]: [&str; 2], select: fn(u64) -> Symbol) -> Lattice {
        let place = key.prf(place);
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
            symbols: key.prf(symbols),
            select,
            #[cfg(test)]
            redrawn: None,
        }
    }

    /// The same lattice, whose symbols have the dithers of another key, but for pilots.
    #[cfg(test)]
    pub fn redrawn(self, other: &Key) -> Lattice {
        Lattice {
            redrawn: Some(other.prf("x")),
            ..self
        }
    }

    /// The lattice coordinates of the frame's centre.
    pub fn centre(&self) -> DVec3 {
        -self.shift
    }

    /// The lattice in a frame whose axes are turned.
    pub fn placed(&self, turn: DMat3, pitch: f64) -> Placement {
        let rotation = turn * self.rotation;
        Placement {
            rotation,
            origin: rotation * self.shift * pitch,
            pitch,
        }
    }

    /// What a lattice point holds: its dither, 0 to 1 in steps of the quantizer, and its symbol.
    pub fn at(&self, [i, j, k]: [i32; 3]) -> (f64, Symbol) {
        // Points farther than this would share an address with nearer ones. A window sees clusters, which lie within the
        // frame's extent, so there are none.
        debug_assert!([i, j, k].iter().all(|index| index.abs() < 1 << 19));
        let part = |index: i32| (index + (1 << 19)) as u64 & ((1 << 20) - 1);
        let address = part(i) << 40 | part(j) << 20 | part(k);
        let (dither, choice) = self.symbols.at(address);
        let symbol = (self.select)(choice);
        #[cfg(test)]
        if let Some(redrawn) = self.redrawn.as_ref().filter(|_| symbol != Symbol::Pilot) {
            return (unit(redrawn.at(address).0), symbol);
        }
        (unit(dither), symbol)
    }
}

/// Where a lattice lies in the canonical frame: a point y has lattice coordinates `rotation^T (y - origin) / pitch`, in
/// which lattice points are whole numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    pub rotation: DMat3,
    pub origin: DVec3,
    pub pitch: f64,
}

impl Placement {
    /// This placement moved by a small similarity: translation and rotation vector in the frame, log of the scale.
    pub fn nudged(&self, x: &[f64; 7]) -> Placement {
        Placement {
            rotation: self.rotation * rotation(DVec3::new(x[3], x[4], x[5])),
            origin: self.origin + self.rotation * DVec3::new(x[0], x[1], x[2]),
            pitch: self.pitch * libm::exp(x[6]),
        }
    }

    /// The lattice coordinates of a point.
    pub fn lattice(&self, y: DVec3) -> DVec3 {
        self.rotation.transpose() * (y - self.origin) / self.pitch
    }

    /// The point at lattice coordinates.
    pub fn point(&self, lattice: DVec3) -> DVec3 {
        self.rotation * lattice * self.pitch + self.origin
    }
}

/// The rotation by a vector's length about its direction.
fn rotation(vector: DVec3) -> DMat3 {
    let angle = vector.length();
    if angle < 1e-12 {
        return DMat3::IDENTITY;
    }
    let half = vector * (libm::sin(0.5 * angle) / angle);
    DMat3::from_quat(glam::DQuat::from_xyzw(
        half.x,
        half.y,
        half.z,
        libm::cos(0.5 * angle),
    ))
}

/// Calls `visit` with every lattice point within a radius of a position, the offset from it and the squared distance relative
/// to the radius.
pub fn for_each_near(y: DVec3, radius: f64, mut visit: impl FnMut([i32; 3], DVec3, f64)) {
    let first = (y - radius).ceil();
    let last = (y + radius).floor();
    let mut point = first;
    while point.x <= last.x {
        let x = y.x - point.x;
        point.y = first.y;
        while point.y <= last.y {
            let dy = y.y - point.y;
            let plane = x * x + dy * dy;
            point.z = first.z;
            while plane < radius * radius && point.z <= last.z {
                let z = y.z - point.z;
                let q2 = (plane + z * z) / (radius * radius);
                if q2 < 1.0 {
                    let index = [point.x as i32, point.y as i32, point.z as i32];
                    visit(index, DVec3::new(x, dy, z), q2);
                }
                point.z += 1.0;
            }
            point.y += 1.0;
        }
        point.x += 1.0;
    }
}
