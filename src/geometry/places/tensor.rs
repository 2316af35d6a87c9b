//! The shape of a surface about a point, seen through a window: the second derivatives of its smoothed occupancy.
//!
//! With occupancy 1 inside and 0 outside, smoothed by a kernel W of width s, M = -s^2 times its Hessian. By the divergence theorem
//! M = s^2 sym grad (W * A), with A the surface's vector areas: a sum over the surface alone, whatever its triangles are, for open
//! surfaces as for closed ones. W is the polynomial (1 - r^2 / R^2)^8: as good as Gauss's function, of finite support.

use super::areas::Piece;
use glam::DVec3;

/// Radius of the support, in widths: the variance of W along an axis is then s^2.
pub const SUPPORT: f64 = 4.58257569495584; // sqrt(21)

/// The integral of W over the unit ball, for R = 1.
const VOLUME: f64 = 0.198_112_3;

/// M, as xx, yy, zz, xy, xz, yz: all positive eigenvalues in a ball.
pub type Tensor = [f64; 6];

/// M at a point, from the pieces of surface that are near it.
pub fn tensor(pieces: &[Piece], point: DVec3, width: f64) -> Tensor {
    let radius = SUPPORT * width;
    let per_square = 1.0 / (radius * radius);
    let mut sum = [0.0; 6];
    for piece in pieces {
        let y = piece.point - point;
        let left = (1.0 - y.length_squared() * per_square).max(0.0);
        let square = left * left;
        let kernel = square * square * square * left;
        let (y, a) = (y * kernel, piece.area);
        sum[0] += y.x * a.x;
        sum[1] += y.y * a.y;
        sum[2] += y.z * a.z;
        sum[3] += y.x * a.y + y.y * a.x;
        sum[4] += y.x * a.z + y.z * a.x;
        sum[5] += y.y * a.z + y.z * a.y;
    }
    // The derivative of (1 - r^2 / R^2)^8 is 16 (1 - r^2 / R^2)^7 y / R^2.
    let scale = width * width * 16.0 * per_square / (VOLUME * radius * radius * radius);
    let [xx, yy, zz, xy, xz, yz] = sum.map(|entry| entry * scale);
    [xx, yy, zz, 0.5 * xy, 0.5 * xz, 0.5 * yz]
}

/// The pieces within a distance of a point.
pub fn near(pieces: &[Piece], point: DVec3, distance: f64) -> Vec<Piece> {
    let is_near = |piece: &&Piece| piece.point.distance_squared(point) < distance * distance;
    pieces.iter().filter(is_near).copied().collect()
}

/// What a place is an extremum of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Invariant {
    /// The sum of the eigenvalues.
    Trace,
    /// Their product.
    Determinant,
    /// The sum of the principal minors.
    Second,
}

impl Invariant {
    /// Every one.
    pub const ALL: [Invariant; 3] = [Invariant::Trace, Invariant::Determinant, Invariant::Second];

    /// Its value, of the same order for each.
    pub fn of(self, [xx, yy, zz, xy, xz, yz]: Tensor) -> f64 {
        let minor = yy * zz - yz * yz;
        match self {
            Invariant::Trace => xx + yy + zz,
            Invariant::Determinant => {
                8.0 * (xx * minor - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz))
            }
            Invariant::Second => 3.0 * (minor + xx * zz - xz * xz + xx * yy - xy * xy),
        }
    }
}
