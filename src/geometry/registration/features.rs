//! Where a piece may lie, by what the surface looks like about points: histograms of normals (FPFH: Rusu, Blodow and Beetz 2009), and
//! triples of points whose sides have one ratio.

use super::points::Points;
use crate::geometry::Motion;
use crate::geometry::near::Around;
use crate::geometry::similarity::fitted;
use crate::random::Random;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

const BINS: usize = 11;
const LEN: usize = 3 * BINS;
/// What a processor does side by side.
const LANES: usize = 4;
/// Three histograms, one after the other, and zeros.
type Feature = [[f32; LANES]; LEN.div_ceil(LANES)];
/// The radius on the suspect, as a share of the root of its area.
const RADIUS: f64 = 0.2;
/// Radii on the original, as shares of the root of its area: which one fits says how large the piece is.
const SMALLEST: f64 = 0.055;
const GROWTH: f64 = 1.22;
const NUM_RADII: i32 = 8;
/// Points are as far apart as this share of a radius; normals are means over the second.
const SPACING: f64 = 0.2;
const SMOOTHING: f64 = 0.35;
/// Triples that are tried at each radius, and those of them that are fitted.
const TRIPLES: usize = 40_000;
const MOST_FITTED: usize = 250;
/// How far ratios of sides may be from each other and from the radii's, and products of normals from each other.
const SIDES: f64 = 0.12;
const SCALE: [f64; 2] = [0.82, 1.22];
const NORMALS: f64 = 0.3;

/// What a surface looks like about each of some points.
pub struct Look {
    points: Vec<(DVec3, DVec3)>,
    features: Vec<Feature>,
    radius: f64,
}

/// What an original looks like at every radius.
pub fn looks_of_original(cloud: &Points, area: f64) -> Vec<Look> {
    let radii = (0..NUM_RADII).map(|k| SMALLEST * libm::pow(GROWTH, f64::from(k)));
    radii.map(|r| Look::new(cloud, r * area.sqrt())).collect()
}

/// What a suspect looks like.
pub fn look_of_suspect(cloud: &Points, area: f64) -> Look {
    Look::new(cloud, RADIUS * area.sqrt())
}

impl Look {
    fn new(cloud: &Points, radius: f64) -> Look {
        let points = thinned(cloud, SPACING * radius, SMOOTHING * radius);
        let near = Around::new(points.iter().map(|(p, _)| *p).collect(), radius);
        let around: Vec<Vec<(f64, u32)>> = points.iter().map(|(p, _)| near.of(*p)).collect();
        let simple: Vec<[f64; LEN]> = points
            .iter()
            .zip(&around)
            .enumerate()
            .map(|(own, (point, around))| histogram(own, point, around, &points))
            .collect();
        let features = around.iter().enumerate().map(|(own, around)| {
            let mut sum = simple[own];
            let others = around.iter().filter(|(_, other)| *other as usize != own);
            let share = 1.0 / around.len().saturating_sub(1).max(1) as f64;
            for &(square, other) in others {
                let weight = share * radius / square.sqrt().max(0.1 * radius);
                let theirs = &simple[other as usize];
                sum.iter_mut()
                    .zip(theirs)
                    .for_each(|(s, t)| *s += 0.3 * weight * t);
            }
            // Roots make the Euclidean distance Hellinger's.
            let mut feature = Feature::default();
            for third in 0..3 {
                let range = third * BINS..(third + 1) * BINS;
                let total: f64 = sum[range.clone()].iter().sum();
                for bin in range {
                    feature[bin / LANES][bin % LANES] =
                        (sum[bin] / total.max(1e-300)).sqrt() as f32;
                }
            }
            feature
        });
        Look {
            features: features.collect(),
            points,
            radius,
        }
    }

    /// Motions of this surface onto another.
    pub fn onto(&self, other: &Look, seed: u64) -> Vec<Motion> {
        let matches = self.matches(other);
        if matches.len() < 3 {
            return Vec::new();
        }
        let mut random = Random::new(seed);
        let scale = other.radius / self.radius;
        let mut motions = Vec::new();
        for _ in 0..TRIPLES {
            let mut pick = || matches[(random.bits() % matches.len() as u64) as usize];
            let triple = [pick(), pick(), pick()];
            if let Some(motion) = self.fit(other, triple, scale) {
                motions.push(motion);
                if motions.len() == MOST_FITTED {
                    break;
                }
            }
        }
        motions
    }

    /// The two points of another surface that look most like each point of this one.
    fn matches(&self, other: &Look) -> Vec<(u32, u32)> {
        let mut matches = Vec::with_capacity(2 * self.features.len());
        for (own, feature) in (0..).zip(&self.features) {
            let mut best = [(f32::INFINITY, 0u32); 2];
            for (name, theirs) in (0..).zip(&other.features) {
                let square = distance_squared(feature, theirs);
                if square < best[0].0 {
                    best = [(square, name), best[0]];
                } else if square < best[1].0 {
                    best[1] = (square, name);
                }
            }
            matches.extend(best.iter().filter(|b| b.0.is_finite()).map(|b| (own, b.1)));
        }
        matches
    }

    /// The motion by three matches, if their sides and normals allow one.
    fn fit(&self, other: &Look, triple: [(u32, u32); 3], scale: f64) -> Option<Motion> {
        let own = triple.map(|(own, _)| self.points[own as usize]);
        let theirs = triple.map(|(_, theirs)| other.points[theirs as usize]);
        let pairs = [(0, 1), (1, 2), (2, 0)];
        let mut ratios = [0.0; 3];
        for (ratio, (i, j)) in ratios.iter_mut().zip(pairs) {
            let (a, b) = (
                own[i].0.distance(own[j].0),
                theirs[i].0.distance(theirs[j].0),
            );
            if a < 0.8 * self.radius {
                return None;
            }
            *ratio = b / a;
            if (own[i].1.dot(own[j].1) - theirs[i].1.dot(theirs[j].1)).abs() > NORMALS {
                return None;
            }
        }
        let mean = ratios.iter().sum::<f64>() / 3.0;
        if ratios.iter().any(|r| (r / mean - 1.0).abs() > SIDES)
            || !(SCALE[0]..SCALE[1]).contains(&(mean / scale))
        {
            return None;
        }
        let offset = self.radius;
        let points: Vec<DVec3> = own
            .iter()
            .flat_map(|(p, n)| [*p, *p + *n * offset])
            .collect();
        let onto: Vec<DVec3> = theirs
            .iter()
            .flat_map(|(p, n)| [*p, *p + *n * (offset * mean)])
            .collect();
        let motion = fitted(&points, &onto)?;
        (!motion.is_mirrored() && motion.linear.is_finite()).then_some(motion)
    }
}

fn distance_squared(a: &Feature, b: &Feature) -> f32 {
    let mut sums = [0.0f32; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += (a[lane] - b[lane]) * (a[lane] - b[lane]);
        }
    }
    sums.iter().sum()
}

/// One point for each cell that has any, with the mean normal about it.
fn thinned(cloud: &Points, cell: f64, radius: f64) -> Vec<(DVec3, DVec3)> {
    let mut cells = std::collections::BTreeMap::<[i64; 3], (DVec3, f64)>::new();
    for p in &cloud.positions {
        let name = (*p / cell).floor().to_array().map(|x| x as i64);
        let sum = cells.entry(name).or_default();
        sum.0 += *p;
        sum.1 += 1.0;
    }
    let near = Around::new(cloud.positions.clone(), radius);
    let mut points = Vec::with_capacity(cells.len());
    for (sum, count) in cells.into_values() {
        let around = near.of(sum / count);
        // A cell's mean is within the radius of the points that it is of: its diagonal is no longer.
        let Some(&(_, first)) = around.iter().min_by(|a, b| a.0.total_cmp(&b.0)) else {
            continue;
        };
        let own = cloud.normals[first as usize];
        let others = around
            .iter()
            .map(|&(_, other)| cloud.normals[other as usize]);
        let normal = others.filter(|n| n.dot(own) > 0.0).sum::<DVec3>();
        points.push((
            cloud.positions[first as usize],
            normal.try_normalize().unwrap_or(own),
        ));
    }
    points
}

/// The angles between a point's normal and those about it, in three histograms.
fn histogram(
    own: usize,
    (p, u): &(DVec3, DVec3),
    around: &[(f64, u32)],
    points: &[(DVec3, DVec3)],
) -> [f64; LEN] {
    let mut bins = [0.0; LEN];
    let share = 1.0 / around.len().max(1) as f64;
    for &(_, other) in around {
        if other as usize == own {
            continue;
        }
        let (q, n) = points[other as usize];
        let Some(d) = (q - *p).try_normalize() else {
            continue;
        };
        let Some(v) = d.cross(*u).try_normalize() else {
            continue;
        };
        let w = u.cross(v);
        let angles = [
            (v.dot(n) + 1.0) / 2.0,
            (u.dot(d) + 1.0) / 2.0,
            (libm::atan2(w.dot(n), u.dot(n)) + PI) / TAU,
        ];
        for (third, angle) in angles.into_iter().enumerate() {
            let bin = ((angle * BINS as f64) as usize).min(BINS - 1);
            bins[third * BINS + bin] += share;
        }
    }
    bins
}
