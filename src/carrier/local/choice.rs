//! Which places will come back: the embedder attacks its own model, and keeps those that move least.

use super::ball::{Ball, RATIOS, widths};
use crate::geometry::diagonal;
use crate::geometry::places::{Areas, Place, areas, places};
use crate::mesh::{Edges, Mesh};
use crate::random::Random;
use glam::DVec3;

/// Balls of a model, at most, and how far their centres are apart at least, as a fraction of its diagonal.
const MOST_BALLS: usize = 8;
const APART: f64 = 0.17;

/// The pitch that is aimed at, as a fraction of the diagonal.
const PITCH: f64 = 0.04;

/// Places are sharper than this, and axes told apart by more than this.
const SHARPNESS: f64 = 0.008;
const GAP: f64 = 0.03;

/// Wider places, as fractions of the diagonal, are taken where there are few others: they do not fit into a piece.
const WIDE: f64 = 0.042;
const FEW: usize = 4;

/// Noise, as a fraction of the diagonal, and steps of smoothing.
const NOISE: f64 = 0.003;
const NOISES: usize = 2;
const SMOOTHING: usize = 10;

/// How far a place may be off after noise or smoothing, in pitches: what it is off costs nothing below a tenth.
const FARTHEST: f64 = 0.35;

/// A cut is tried on six sides, so many pitches from a place; how much what it moves counts beside noise and smoothing.
const CUT: f64 = 2.5;
const SHARE: f64 = 0.5;

/// Balls for a mesh whose triangles face outwards, the steadiest first.
pub fn choose(mesh: &Mesh) -> Vec<Ball> {
    let diagonal = diagonal(&mesh.positions);
    let widths = widths(diagonal);
    let whole = areas(mesh, &widths);
    let attacked = attacked(mesh, diagonal).map(|mesh| areas(&mesh, &widths));
    let attacked: Vec<Areas> = attacked.collect();
    let mut candidates = Vec::new();
    for place in places(&whole, &widths) {
        if place.sharpness < SHARPNESS {
            continue;
        }
        let again: Vec<Option<Place>> = attacked.iter().map(|areas| place.again(areas)).collect();
        for frame in (0..2).filter(|&frame| place.frames[frame].gap > GAP) {
            let ball = Ball {
                place,
                frame,
                ratio: ratio(place.width, PITCH * diagonal),
            };
            let worst = again.iter().map(|again| ball.error(again));
            let worst = worst.fold(0.0, f64::max);
            if worst < FARTHEST {
                candidates.push((worst + SHARE * ball.error_of_cuts(&whole), ball));
            }
        }
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Vec<Ball> = Vec::new();
    for (is_wide, most) in [(false, MOST_BALLS), (true, FEW)] {
        for (_, ball) in &candidates {
            let is_apart = |other: &Ball| {
                other.place.point.distance(ball.place.point) > APART * diagonal
                    && other.class() != ball.class()
            };
            let fits = (ball.place.width > WIDE * diagonal) == is_wide;
            if fits && chosen.len() < most && chosen.iter().all(is_apart) {
                chosen.push(*ball);
            }
        }
    }
    chosen
}

/// The ratio that brings a width nearest to a pitch.
fn ratio(width: f64, pitch: f64) -> usize {
    let off = |ratio: &usize| libm::log(RATIOS[*ratio] * width / pitch).abs();
    let ratios = 0..RATIOS.len();
    ratios.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}

/// The mesh under noise, and smoothed.
fn attacked(mesh: &Mesh, diagonal: f64) -> impl Iterator<Item = Mesh> {
    let mut random = Random::new(0x4c_4f_43_41);
    let noisy = (0..NOISES).map(move |_| {
        let noise = |p: &DVec3| *p + random.direction() * (NOISE * diagonal * random.unit());
        mesh.with_positions(mesh.positions.iter().map(noise).collect())
    });
    noisy.chain(std::iter::once_with(|| smoothed(mesh)))
}

fn smoothed(mesh: &Mesh) -> Mesh {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let mut positions = mesh.positions.clone();
    for _ in 0..SMOOTHING {
        let moved = |vertex: usize| {
            let ring = rings.neighbours(vertex);
            let sum: DVec3 = ring.iter().map(|&other| positions[other as usize]).sum();
            let mean = sum / ring.len().max(1) as f64;
            let share = if ring.is_empty() { 0.0 } else { 0.1 };
            positions[vertex].lerp(mean, share)
        };
        positions = (0..positions.len()).map(moved).collect();
    }
    mesh.with_positions(positions)
}

impl Ball {
    /// How far it is off where its place was found again, in pitches: at its centre, and by turn and size at three pitches from it.
    fn error(&self, again: &Option<Place>) -> f64 {
        const LOST: f64 = 9.0;
        let Some(again) = again else {
            return LOST;
        };
        let between = again.frames[self.frame].axes.transpose() * self.axes();
        // Two axes may be turned over.
        let trace = between.x_axis.x.abs() + between.y_axis.y.abs() + between.z_axis.z.abs();
        let turn = libm::acos((0.5 * (trace - 1.0)).clamp(-1.0, 1.0));
        let moved = again.point.distance(self.place.point) / self.pitch();
        let grown = libm::log(again.width / self.place.width);
        (moved * moved + 9.0 * (turn * turn + grown * grown)).sqrt()
    }

    /// The mean error where all beyond a plane is cut off, on one of six sides; 1 where that loses it.
    fn error_of_cuts(&self, whole: &Areas) -> f64 {
        let [x, y, z] = [self.axes().x_axis, self.axes().y_axis, self.axes().z_axis];
        let sides = [x, y, z, -x, -y, -z];
        let error = |side: &DVec3| {
            let distance = side.dot(self.place.point) + CUT * self.pitch();
            let again = self.place.again(&whole.cut(*side, distance));
            self.error(&again).min(1.0)
        };
        sides.iter().map(error).sum::<f64>() / sides.len() as f64
    }
}
