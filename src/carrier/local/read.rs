//! Reading.

use super::ball::{Ball, RATIOS, STEPS, see};
use super::embed::WIDTHS;
use crate::carrier::solid::cluster::Cluster;
use crate::carrier::solid::lattice::{Lattice, RADIUS};
use crate::carrier::solid::quantizer::{cosine, phase};
use crate::carrier::solid::refine::{View, refine};
use crate::carrier::solid::window::Window;
use crate::code::{Codeword, Symbol};
use crate::detection::Statistic;
use crate::geometry::places::{Areas, Place, areas, places};
use crate::geometry::{Pose, diagonal, oriented};
use crate::key::Key;
use crate::mesh::Mesh;
use glam::DVec3;

pub struct Measured {
    pub areas: Areas,
    pub places: Vec<Place>,
    pub boundary: Vec<DVec3>,
    pub diagonal: f64,
}

pub fn measure(mesh: &Mesh) -> Measured {
    let (mesh, boundary) = oriented(mesh);
    let d = diagonal(&mesh.positions);
    let widths = 0.8 * WIDTHS[0] * d..WIDTHS[1] * d;
    let areas = areas(&mesh, &widths);
    Measured {
        places: places(&areas, &widths),
        areas,
        boundary: boundary.iter().map(|&(a, _)| mesh.positions[a as usize]).collect(),
        diagonal: d,
    }
}

#[derive(Clone)]
pub struct Candidate {
    pub ball: Ball,
    pub signs: DVec3,
    pub step: f64,
    pub guides: f64,
    pub refined: f64,
    pub witnesses: f64,
    /// sums of the witnesses
    pub sum: f64,
    pub energy: f64,
    pub view: View,
}

pub fn statistic(windows: &[Window], lattice: &Lattice, step: f64, pilots: bool) -> (f64, f64) {
    let (mut sum, mut energy) = (0.0, 0.0);
    for w in windows {
        let (dither, symbol) = lattice.at(w.index);
        if (symbol == Symbol::Pilot) != pilots { continue; }
        sum += w.weight * cosine(phase(w.flux / step, dither)) * Codeword::Presence.sign(symbol);
        energy += w.weight * w.weight;
    }
    (sum, energy)
}

pub fn ln(sum: f64, energy: f64) -> f64 {
    if energy > 0.0 { sum * sum.abs() / energy } else { 0.0 }
}

/// The windows that do not see a boundary.
pub fn whole(windows: &mut Vec<Window>, m: &Measured, ball: &Ball, placement: &crate::carrier::solid::lattice::Placement) {
    let reach = RADIUS * ball.pitch();
    let near: Vec<DVec3> = m.boundary.iter().filter(|b| b.distance(ball.place.point) < 6.5 * ball.pitch()).copied().collect();
    windows.retain(|w| {
        let at = placement.point(DVec3::from_array(w.index.map(f64::from)));
        near.iter().all(|b| b.distance_squared(at) > reach * reach)
    });
}

pub fn read(m: &Measured, key: &Key, num_refined: usize) -> (Vec<Candidate>, usize) {
    let mut all: Vec<Candidate> = Vec::new();
    let mut tried = 0;
    let mut lattices: Vec<Option<Lattice>> = (0..72).map(|_| None).collect();
    for place in &m.places {
        for frame in 0..2 {
            if place.frames[frame].gap < 0.02 { continue; }
            for ratio in 0..RATIOS.len() {
                let ball = Ball { place: *place, frame, ratio };
                let relative = ball.pitch() / m.diagonal;
                if !(0.03..0.075).contains(&relative) { continue; }
                let lattice = &*lattices[ball.class()].get_or_insert_with(|| ball.lattice(key));
                let clusters = ball.clusters(&m.areas);
                for signs in Pose::HALF_TURNS {
                    let placement = ball.placement(lattice, signs);
                    let mut windows = see(&clusters, lattice, &placement);
                    whole(&mut windows, m, &ball, &placement);
                    if windows.len() < 24 { continue; }
                    for step in STEPS {
                        tried += 1;
                        let (sum, energy) = statistic(&windows, lattice, step, true);
                        let guides = ln(sum, energy);
                        all.push(Candidate { ball, signs, step, guides, refined: 0.0, witnesses: 0.0, sum: 0.0, energy: 0.0, view: View { placement, strength: 0.0 } });
                    }
                }
            }
        }
    }
    all.sort_by(|a, b| b.guides.total_cmp(&a.guides));
    all.truncate(num_refined);
    for c in &mut all { refine_one(m, key, c); }
    let score = |c: &Candidate| c.guides.max(c.refined - 7.0);
    all.sort_by(|a, b| score(b).total_cmp(&score(a)));
    let mut kept: Vec<Candidate> = Vec::new();
    for c in all { if kept.iter().all(|k| k.ball.class() != c.ball.class()) { kept.push(c); } }
    (kept, tried)
}

pub fn refine_one(m: &Measured, key: &Key, c: &mut Candidate) {
    let lattice = c.ball.lattice(key);
    let clusters: Vec<Cluster> = c.ball.clusters(&m.areas);
    let mut allowed = see(&clusters, &lattice, &c.view.placement);
    whole(&mut allowed, m, &c.ball, &c.view.placement);
    let allowed: Vec<[i32; 3]> = allowed.iter().map(|w| w.index).collect();
    let look = |view: &View| {
        let mut w = see(&clusters, &lattice, &view.placement);
        w.retain(|w| allowed.binary_search(&w.index).is_ok());
        w
    };
    // refine nudges origins in scene units: give it the view in pitches
    let view = refine_in_pitches(&look, &c.view, &lattice, c.step);
    let windows = look(&view);
    let (s, e) = statistic(&windows, &lattice, c.step, true);
    c.refined = ln(s, e);
    let (s, e) = statistic(&windows, &lattice, c.step, false);
    (c.sum, c.energy) = (s, e);
    c.witnesses = ln(s, e);
    c.view = view;
    let _ = Statistic::default();
}

fn refine_in_pitches(look: &dyn Fn(&View) -> Vec<Window>, start: &View, lattice: &Lattice, step: f64) -> View {
    // in units of the ball's 5 pitches, so that a nudge of translation compares with one of rotation and scale
    let unit = 5.0 * start.placement.pitch;
    let to = |v: &View| { let mut v = *v; v.placement.origin *= unit; v.placement.pitch *= unit; v };
    let from = |v: &View| { let mut v = *v; v.placement.origin /= unit; v.placement.pitch /= unit; v };
    let see = |v: &View| look(&to(v));
    let inner = from(start);
    to(&refine(&see, &inner, lattice, step * inner.placement.pitch))
}
