//! A suspect that no one motion lays on the original: taken apart, each part of it lies there in a way of its own.
//!
//! What a motion explains, and what bends on from there, is a part. What is left falls into regions that hang together or touch, and each is looked for anew:
//! about where it was joined to a part that lies already, as a limb in another pose, or by what it looks like, as one of several things that were put together.
//! Knows no key.

use super::bent::Bent;
use super::icp::{Freedom, refined};
use super::points::Points;
use super::{
    FINE, Found, KEPT, LEAST_NEAR, Original, REFINED, Registration, Search, features, moments,
};
use crate::geometry::Motion;
use crate::geometry::near::Around;
use crate::geometry::scatter::scattered;
use crate::mesh::{Edges, Mesh, Sets};
use glam::{DMat3, DVec3};

/// Regions that are looked for, and those of them by what they look like.
const MOST_TRIED: usize = 16;
const MOST_BY_FEATURES: usize = 4;
/// Shares of the suspect's area: a region that is looked for, the least of it that a motion explains, and a piece of that.
const LEAST_REGION: f64 = 0.02;
const LEAST_PART: f64 = 0.01;
const LEAST_PIECE: f64 = 0.004;
/// A region smaller than this share of the original looks like much, and an affine map of it takes a part of the mark.
const LEAST_LOOK: f64 = 0.05;
const LEAST_AFFINE: f64 = 0.3;
/// The share of a part that has to lie on the original exactly: elsewhere it lies by chance.
const LEAST_EXACT: f64 = 0.45;
/// By how much larger or smaller than the first a part may be made: poses turn, and do not scale.
const MOST_SCALED: f64 = 1.15;
/// A part bends where that explains so many times as much of it: what does not bend keeps one motion, which leaves all of the mark.
const MUCH_MORE: f64 = 1.1;
/// The share of the suspect's area from which on a part is taken for the whole; others were not tried.
const WHOLE: f64 = 0.9;
/// Parts touch where points of them, of so many, are nearer to each other than this share of the root of the suspect's area.
const TOUCH: f64 = 0.02;
const TOUCHING: usize = 6000;
/// Points of a region.
const POINTS: usize = 2000;
const CLOUD: usize = 15_000;
/// By how much a limb may have turned about its joint, degrees, about each of 13 axes.
const TURNS: [f64; 4] = [12.0, 28.0, 50.0, 80.0];

/// A suspect whose parts lie on the original.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// The parts, each moved to where it lies; what lies nowhere is left out.
    pub mesh: Mesh,
    /// How many there are.
    pub num_parts: usize,
    /// Whether one of them bends.
    pub is_bent: bool,
    /// How the largest lies, and which share of the whole suspect lies on the original.
    pub registration: Registration,
}

/// A part that lies.
struct Part {
    /// Where it lies; of one that bends, where that began.
    registration: Registration,
    lying: Lying,
    area: f64,
    is_bent: bool,
}

/// Triangles that lie on the original, and where they do.
struct Lying {
    triangles: Vec<u32>,
    mesh: Mesh,
}

struct Apart<'a> {
    original: &'a Original<'a>,
    suspect: &'a Mesh,
    areas: Vec<f64>,
    /// Pairs of triangles that touch and do not hang together.
    touching: Vec<[u32; 2]>,
    /// Of each triangle, whether it is to be looked for.
    is_open: Vec<bool>,
    parts: Vec<Part>,
}

impl Original<'_> {
    /// Whether a suspect falls into several parts of some size by itself.
    pub fn has_large_parts(suspect: &Mesh) -> bool {
        let mut areas = Vec::new();
        for (label, triangle) in Edges::new(suspect)
            .components()
            .into_iter()
            .zip(&suspect.triangles)
        {
            areas.resize(areas.len().max(label as usize + 1), 0.0);
            let [a, b, c] = suspect.corners(*triangle);
            areas[label as usize] += 0.5 * (b - a).cross(c - a).length();
        }
        let least = LEAST_LOOK * areas.iter().sum::<f64>();
        areas.iter().filter(|area| **area >= least).count() > 1
    }

    /// Takes a suspect apart. `starts` are the ways in which it lies as a whole, however badly. `None` where no part of it lies.
    pub fn assembled(&self, suspect: &Mesh, starts: &[Registration]) -> Option<Assembly> {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = suspect.corners(*t);
            0.5 * (b - a).cross(c - a).length()
        };
        let mut apart = Apart {
            original: self,
            suspect,
            areas: suspect.triangles.iter().map(area).collect(),
            touching: touching(suspect),
            is_open: vec![true; suspect.triangles.len()],
            parts: Vec::new(),
        };
        let starts: Vec<Motion> = starts.iter().map(|start| start.motion).collect();
        let mut num_by_features = 0;
        for _ in 0..MOST_TRIED {
            let Some(region) = apart.largest_region() else {
                break;
            };
            let by_features = num_by_features < MOST_BY_FEATURES;
            let (part, is_by_features) = apart.part_of(&region, &starts, by_features);
            num_by_features += usize::from(is_by_features);
            match part {
                Some(part) => {
                    let triangles = part.lying.triangles.iter();
                    triangles.for_each(|&t| apart.is_open[t as usize] = false);
                    apart.parts.push(part);
                }
                None => region
                    .iter()
                    .for_each(|&t| apart.is_open[t as usize] = false),
            }
        }
        apart.conclude()
    }
}

impl Apart<'_> {
    fn area_of(&self, triangles: &[u32]) -> f64 {
        triangles.iter().map(|&t| self.areas[t as usize]).sum()
    }

    fn mesh_of(&self, triangles: &[u32]) -> Mesh {
        let all = &self.suspect.triangles;
        self.suspect
            .part(triangles.iter().map(|&t| all[t as usize]))
    }

    /// Triangles that hang together or touch, of those that are given.
    fn regions(&self, triangles: &[u32]) -> Vec<Vec<u32>> {
        let labels = Edges::new(&self.mesh_of(triangles)).components();
        let count = labels.iter().max().map_or(0, |&last| last as usize + 1);
        let mut label_of = vec![None; self.suspect.triangles.len()];
        for (&label, &triangle) in labels.iter().zip(triangles) {
            label_of[triangle as usize] = Some(label);
        }
        let mut sets = Sets::new(count);
        for pair in &self.touching {
            if let [Some(a), Some(b)] = pair.map(|triangle| label_of[triangle as usize]) {
                sets.join(a, b);
            }
        }
        let mut regions = vec![Vec::new(); count];
        for (&label, &triangle) in labels.iter().zip(triangles) {
            regions[sets.find(label) as usize].push(triangle);
        }
        regions
    }

    fn open(&self) -> Vec<u32> {
        let open = (0u32..).zip(&self.is_open);
        open.filter(|(_, is_open)| **is_open).map(|o| o.0).collect()
    }

    fn largest_region(&self) -> Option<Vec<u32>> {
        let least = LEAST_REGION * self.areas.iter().sum::<f64>();
        let sized = self
            .regions(&self.open())
            .into_iter()
            .map(|region| (self.area_of(&region), region));
        let large = sized.filter(|(area, _)| *area >= least);
        large
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, region)| region)
    }

    /// The part of a region that lies on the original in one way, and whether it was looked for by what it looks like.
    fn part_of(
        &self,
        region: &[u32],
        starts: &[Motion],
        by_features: bool,
    ) -> (Option<Part>, bool) {
        let mesh = self.mesh_of(region);
        let points = Points::of(&mesh, POINTS, 5);
        if points.positions.len() < POINTS / 2 {
            return (None, false);
        }
        let near = self.laid(region, &points, self.candidates(region, starts));
        let area = mesh.area();
        let is_whole = region.len() == self.suspect.triangles.len(); // looked for by who asks
        if near.is_some() || is_whole || !by_features || area < LEAST_LOOK * self.scaled_area() {
            return (near, false);
        }
        let cloud = Points::of(&mesh, CLOUD, 4);
        let look = features::look_of_suspect(&cloud, area);
        let looks = self.original.looks().iter().zip(5..);
        let motions = looks.flat_map(|(original, seed)| look.onto(original, seed));
        (self.laid(region, &points, motions.collect()), true)
    }

    /// The original's area in the suspect's units, where a part lies already.
    fn scaled_area(&self) -> f64 {
        let Some(part) = self.parts.first() else {
            return 0.0;
        };
        let size = size(&part.registration.motion);
        self.original.area / (size * size)
    }

    /// Where a region may lie: as the suspect does, or as a part that lies already, or turned about where it was joined to one.
    fn candidates(&self, region: &[u32], starts: &[Motion]) -> Vec<Motion> {
        let mut motions = starts.to_vec();
        motions.extend(self.parts.iter().map(|part| part.registration.motion));
        let mut is_own = vec![false; self.suspect.positions.len()];
        for &triangle in region {
            let corners = self.suspect.triangles[triangle as usize];
            corners.iter().for_each(|&v| is_own[v as usize] = true);
        }
        for part in &self.parts {
            let corners = part
                .lying
                .triangles
                .iter()
                .flat_map(|&t| self.suspect.triangles[t as usize]);
            let common: Vec<u32> = corners.filter(|&v| is_own[v as usize]).collect();
            if common.is_empty() {
                continue;
            }
            let motion = part.registration.motion;
            let places = common.iter().map(|&v| self.suspect.positions[v as usize]);
            let joint = motion.of(places.sum::<DVec3>() / common.len() as f64);
            motions.extend(turns().map(|turn| {
                let about = Motion {
                    linear: turn,
                    translation: joint - turn * joint,
                };
                about.after(&motion)
            }));
        }
        motions
    }

    /// The part of a region that the best of some motions lays on the original.
    fn laid(&self, region: &[u32], points: &Points, motions: Vec<Motion>) -> Option<Part> {
        let area = self.area_of(region);
        let mut found = Found::new(self.original, points, area);
        found.follow(motions, Freedom::Similarity);
        let kept = found.kept.into_iter();
        let mut kept: Vec<Registration> = kept.filter(|k| self.is_of_size(&k.motion)).collect();
        // Made small enough, anything lies somewhere.
        let worth = |kept: &Registration| kept.near * size(&kept.motion);
        kept.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
        // A whole that bends lies nowhere well before it is bent back, so that the best motion may be none of its own.
        let is_whole = region.len() == self.suspect.triangles.len();
        kept.truncate(if is_whole { KEPT } else { 1 });
        let mut best: Option<Part> = None;
        for Registration { motion, .. } in kept {
            let part = self.laid_from(region, motion);
            let is_better = |part: &Part| best.as_ref().is_none_or(|best| best.area < part.area);
            best = part.filter(is_better).or(best);
            if best
                .as_ref()
                .is_some_and(|best| best.area >= LEAST_NEAR * area)
            {
                break;
            }
        }
        let best = best?;
        let is_all = best.is_bent && best.area >= WHOLE * self.areas.iter().sum::<f64>();
        Some(if is_all {
            self.turned(region, best)
        } else {
            best
        })
    }

    /// A whole that was bent back, as it lies best: on an original that looks alike from several sides it may have been bent onto another one.
    fn turned(&self, region: &[u32], mut part: Part) -> Part {
        let mut ways = self.original.registrations(&part.lying.mesh, Search::Quick);
        // Where a third of a turn or less leads to the same shape, axes do not tell how it is turned.
        if moments::has_equal_spreads(&self.original.points) {
            ways.extend(
                self.original
                    .registrations(&part.lying.mesh, Search::Pieces),
            );
        }
        let score = |part: &Part| part.area * part.registration.exact;
        let began = part.registration.motion;
        for way in ways {
            let other = self.laid_from(region, way.motion.after(&began));
            part = other
                .filter(|other| score(other) > score(&part))
                .unwrap_or(part);
        }
        part
    }

    /// The part of a region that lies on the original from a motion on.
    fn laid_from(&self, region: &[u32], mut motion: Motion) -> Option<Part> {
        let least = LEAST_PART * self.areas.iter().sum::<f64>();
        let is_mirrored = motion.is_mirrored();
        let mut lying = self.lying(region, is_mirrored, |p| Some(motion.of(p)));
        for _ in 0..2 {
            if self.area_of(&lying.triangles) < least {
                return None;
            }
            motion = self.finished(&lying.triangles, motion);
            lying = self.lying(region, is_mirrored, |p| Some(motion.of(p)));
        }
        let open = self.open();
        let bent = Bent::new(self.original, &self.mesh_of(&open), &motion);
        let bent = self.lying(&open, is_mirrored, |p| bent.of(p));
        let is_bent = self.area_of(&bent.triangles) > MUCH_MORE * self.area_of(&lying.triangles);
        if is_bent {
            lying = bent;
        }
        let area = self.area_of(&lying.triangles);
        let points = Points::of(&lying.mesh, REFINED, 6);
        let registration = Registration {
            motion,
            ..self.original.scored(&points, Motion::IDENTITY)
        };
        let is_exact = registration.exact >= LEAST_EXACT;
        (is_exact && area >= least && self.is_of_size(&motion)).then_some(Part {
            registration,
            lying,
            area,
            is_bent,
        })
    }

    /// Whether a motion makes a region as large as the first part was made.
    fn is_of_size(&self, motion: &Motion) -> bool {
        let Some(first) = self.parts.first() else {
            return true;
        };
        let ratio = size(motion) / size(&first.registration.motion);
        ratio.max(1.0 / ratio) <= MOST_SCALED
    }

    /// What lies on the original of some triangles, in pieces of some size, where their corners are moved; what is not moved lies nowhere.
    fn lying(
        &self,
        triangles: &[u32],
        is_mirrored: bool,
        moved: impl Fn(DVec3) -> Option<DVec3>,
    ) -> Lying {
        let surface = &self.original.surface;
        let mut all = self.suspect.triangles.clone();
        if is_mirrored {
            all.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let reach = FINE * self.original.diagonal;
        let mut places = vec![None; self.suspect.positions.len()];
        for &triangle in triangles {
            for v in all[triangle as usize] {
                let place = &mut places[v as usize];
                *place = place.or_else(|| moved(self.suspect.positions[v as usize]));
            }
        }
        let lies = |corners: [u32; 3]| {
            let [Some(a), Some(b), Some(c)] = corners.map(|v| places[v as usize]) else {
                return false;
            };
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let foot = surface.foot((a + b + c) / 3.0, reach);
            foot.is_some_and(|(_, plane)| normal.dot(plane) > 0.5)
                && ([a, b, c].iter()).all(|p| surface.nearest_within(*p, reach).is_some())
        };
        let near = triangles.iter().copied();
        let near: Vec<u32> = near.filter(|&t| lies(all[t as usize])).collect();
        let least = LEAST_PIECE * self.areas.iter().sum::<f64>();
        let mut pieces = self.regions(&near);
        pieces.retain(|piece| self.area_of(piece) >= least);
        let triangles = pieces.concat();
        let places = places.into_iter().map(Option::unwrap_or_default).collect();
        let mesh = self.suspect.with_positions(places);
        Lying {
            mesh: mesh.part(triangles.iter().map(|&t| all[t as usize])),
            triangles,
        }
    }

    /// The last steps of a part.
    fn finished(&self, triangles: &[u32], motion: Motion) -> Motion {
        let mesh = self.mesh_of(triangles);
        let points = Points::of(&mesh, POINTS, 7);
        let (d, surface) = (self.original.diagonal, &self.original.surface);
        let reach = [0.006 * d, 0.004 * d];
        let least = 0.001 * d;
        let motion = refined(
            &points,
            surface,
            motion,
            Freedom::Similarity,
            6,
            reach,
            least,
        );
        match motion.of_mesh(&mesh).area() < LEAST_AFFINE * self.original.area {
            true => motion,
            false => refined(&points, surface, motion, Freedom::Affine, 6, reach, least),
        }
    }

    fn conclude(mut self) -> Option<Assembly> {
        self.parts.sort_by(|a, b| b.area.total_cmp(&a.area));
        let largest = self.parts.first()?.registration;
        let total = self.areas.iter().sum::<f64>();
        let share = |of: fn(&Registration) -> f64| {
            let parts = self.parts.iter();
            parts
                .map(|part| part.area / total * of(&part.registration))
                .sum::<f64>()
        };
        Some(Assembly {
            num_parts: self.parts.len(),
            is_bent: self.parts.iter().any(|part| part.is_bent),
            registration: Registration {
                motion: largest.motion,
                near: share(|part| part.near),
                exact: share(|part| part.exact),
            },
            mesh: Mesh::joined(self.parts.into_iter().map(|part| part.lying.mesh)),
        })
    }
}

/// Pairs of triangles that touch and do not hang together.
fn touching(mesh: &Mesh) -> Vec<[u32; 2]> {
    let labels = Edges::new(mesh).components();
    if labels.iter().all(|&label| label == 0) {
        return Vec::new();
    }
    let points = scattered(mesh, TOUCHING, 9);
    let places = points.iter().map(|point| point.position).collect();
    let near = Around::new(places, TOUCH * mesh.area().sqrt());
    let label = |triangle: u32| labels[triangle as usize];
    let mut pairs = Vec::new();
    for point in &points {
        for (_, other) in near.of(point.position) {
            let pair = [point.triangle, points[other as usize].triangle];
            if label(pair[0]) < label(pair[1]) {
                pairs.push(pair);
            }
        }
    }
    pairs
}

fn size(motion: &Motion) -> f64 {
    libm::cbrt(motion.linear.determinant().abs())
}

/// Turns about 13 axes, by several angles, both ways.
fn turns() -> impl Iterator<Item = DMat3> {
    let steps = || [-1.0, 0.0, 1.0].into_iter();
    let all = steps()
        .flat_map(move |x| steps().flat_map(move |y| steps().map(move |z| DVec3::new(x, y, z))));
    // An axis and its opposite turn both ways.
    let axes = all.filter_map(DVec3::try_normalize);
    axes.flat_map(|axis| TURNS.map(|angle| DMat3::from_axis_angle(axis, angle.to_radians())))
}
