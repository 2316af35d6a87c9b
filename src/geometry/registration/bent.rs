//! A part that bends: each place of it lies on the original in a way of its own, a little other than its neighbours'.
//!
//! A place begins with the motion of a neighbour that lies already, and is refined on what is about it alone; and so on from place to place, the best
//! first, until nothing more fits. A point moves as the places about it do (Sumner, Schmid and Pauly 2007; without their sum over the whole surface: what
//! keeps neighbours alike here is that each begins where another ended). A place's own motion
//! takes a little of the mark with it: how much was measured (docs/ORIGINAL.md).

use super::icp::{Freedom, refined};
use super::points::Points;
use super::{EXACT, FINE, Original};
use crate::geometry::Motion;
use crate::geometry::near::Around;
use crate::mesh::Mesh;
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// As shares of the original's diagonal: how far apart places are, and what is about one. Of five pairs that were tried on a posed and halved bunny and leaf,
/// wider ones left less of the mark; 0.03 and 0.06 left as much, and took longer.
const SPACING: f64 = 0.04;
const REACH: f64 = 0.07;
/// Points of the surface for each place, and of the whole surface.
const POINTS: f64 = 20.0;
const LEAST_POINTS: usize = 500;
const MOST_POINTS: usize = 30_000;
/// Shares of the points about a place that have to lie on the original, nearly and exactly, for the place to lie there. Others were not tried.
const LEAST_NEAR: f64 = 0.7;
const LEAST_EXACT: f64 = 0.4;
/// Neighbours that a place is tried from.
const TRIES: u32 = 3;
/// Rounds of refinement, and within which shares of the diagonal points count in the first and the last.
const ROUNDS: usize = 6;
const CAPS: [f64; 2] = [0.02, 0.005];
const LEAST_CUT: f64 = 0.001;

/// Where a surface lies, place by place.
pub struct Bent {
    reach: f64,
    places: Around,
    motions: Vec<Motion>,
}

struct Place {
    at: DVec3,
    about: Points,
    neighbours: Vec<u32>,
    num_tries: u32,
    motion: Option<Motion>,
}

impl Bent {
    /// From where a motion lays some of a surface on the original. O(P^2 + P log F), P the number of places.
    pub fn new(original: &Original, mesh: &Mesh, start: &Motion) -> Bent {
        let unit = original.diagonal / libm::cbrt(start.linear.determinant().abs());
        let mut places = places_of(mesh, unit);
        // How well it fits, the place, and the neighbour that it is tried from.
        let mut heap = BinaryHeap::new();
        for (number, place) in (0u32..).zip(&places) {
            heap.extend(fit(original, place, start).map(|fit| (fit, Reverse(number), None)));
        }
        while let Some((_, Reverse(number), from)) = heap.pop() {
            let from: Option<Motion> = from.and_then(|from: u32| places[from as usize].motion);
            let place = &mut places[number as usize];
            if place.motion.is_some() || place.num_tries == TRIES {
                continue;
            }
            place.num_tries += 1;
            let motion = refined(
                &place.about,
                &original.surface,
                from.unwrap_or(*start),
                Freedom::Rigid,
                ROUNDS,
                CAPS.map(|cap| cap * original.diagonal),
                LEAST_CUT * original.diagonal,
            );
            if let Some(fit) = fit(original, place, &motion) {
                place.motion = Some(motion);
                let neighbours = place.neighbours.iter();
                heap.extend(neighbours.map(|&other| (fit, Reverse(other), Some(number))));
            }
        }
        let lying = places.iter().filter_map(|p| Some((p.at, p.motion?)));
        let (at, motions): (Vec<DVec3>, Vec<Motion>) = lying.unzip();
        Bent {
            reach: REACH * unit,
            places: Around::new(at, REACH * unit),
            motions,
        }
    }

    /// Where a point lies; `None` far from every place that does.
    pub fn of(&self, point: DVec3) -> Option<DVec3> {
        let mut sum = (DVec3::ZERO, 0.0);
        for (square, place) in self.places.of(point) {
            let inside = 1.0 - square / (self.reach * self.reach);
            let weight = inside * inside * inside;
            sum.0 += weight * self.motions[place as usize].of(point);
            sum.1 += weight;
        }
        (sum.1 > 0.0).then(|| sum.0 / sum.1)
    }
}

/// How well a place lies on the original, in thousandths; `None` where it does not.
fn fit(original: &Original, place: &Place, motion: &Motion) -> Option<u32> {
    let [near, exact] = original.nears(&place.about, motion, [FINE, EXACT]);
    (near >= LEAST_NEAR && exact >= LEAST_EXACT).then_some((1000.0 * (near + exact)) as u32)
}

/// Places all over a surface. A unit is the original's diagonal in units of the surface.
fn places_of(mesh: &Mesh, unit: f64) -> Vec<Place> {
    let spacing = SPACING * unit;
    let count = (POINTS * mesh.area() / (spacing * spacing)) as usize;
    let cloud = Points::of(mesh, count.clamp(LEAST_POINTS, MOST_POINTS), 8);
    let mut at: Vec<DVec3> = Vec::new();
    for p in &cloud.positions {
        let is_free = |q: &DVec3| q.distance_squared(*p) > spacing * spacing;
        if at.iter().all(is_free) {
            at.push(*p);
        }
    }
    let points = Around::new(cloud.positions.clone(), REACH * unit);
    let others = Around::new(at.clone(), 2.0 * spacing);
    let place = |&at: &DVec3| {
        let about = points.of(at);
        let of = |all: &[DVec3]| about.iter().map(|(_, n)| all[*n as usize]).collect();
        Place {
            at,
            about: Points {
                positions: of(&cloud.positions),
                normals: of(&cloud.normals),
            },
            neighbours: others.of(at).into_iter().map(|(_, n)| n).collect(),
            num_tries: 0,
            motion: None,
        }
    };
    at.iter().map(place).collect()
}
