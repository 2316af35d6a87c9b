//! What is left between an original and a suspect that lies on it, once what a tool does to every surface is taken out.
//!
//! Seen at points of the original: how far along the normal the suspect is. A shift, a shear, smoothing and the chords of larger triangles
//! explain most of it; a mark is in the rest. Knows no key.

use super::near::Near;
use super::registration::Original;
use super::scatter::{Point, scattered};
use super::{Motion, Surface, cotangents, open_sides, vertex_normals};
use crate::mesh::{Edges, Mesh};
use crate::random::Random;
use glam::DVec3;
use nalgebra::{SMatrix, SVector};

/// Points of the original that are looked at.
const NUM_POINTS: usize = 30_000;
/// A suspect farther than this share of the diagonal says nothing of a point.
const FARTHEST: f64 = 0.012;
/// Nearer than this the direction to the suspect does not matter.
const TOUCHING: f64 = 1e-4;
/// How much normals have to agree.
const AGREE: f64 = 0.3;
/// Points without which nothing is said.
const LEAST_POINTS: usize = 300;
/// Suspects of more vertices have no chords to speak of.
const MOST_FOR_CHORDS: usize = 40_000;
/// Nuisances: nine of a linear map, three of a shift, one of an offset; of smoothings; two of chords.
const FIRST_SMOOTHING: usize = 13;
const FIRST_CHORD: usize = FIRST_SMOOTHING + NUM_SMOOTHINGS;
const COLUMNS: usize = FIRST_CHORD + 2;
const ROUNDS: usize = 4;
/// Residuals beyond so many deviations count as so many.
const CLIP: f64 = 2.5;
/// The trend is taken over an area of so many windows, on so many points, about so many anchors.
const TREND_WINDOWS: f64 = 15.0;
const TREND_POINTS: usize = 9000;
const ANCHORS: usize = 1200;
/// Weight of normals beside positions, in diagonals: two sides of a thin part are no neighbours.
const SIDES: f64 = 0.09;

/// Something that is seen of a displacement of the original's vertices: `sum weights[i] direction . d(vertices[i])` is `value`, within a
/// deviation of 1 / root of `precision`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Vertices of the original.
    pub vertices: [u32; 3],
    /// How much each of them counts.
    pub weights: [f64; 3],
    /// Along which direction, of unit length.
    pub direction: DVec3,
    /// What is seen, in units of the original.
    pub value: f64,
    /// The inverse of its variance.
    pub precision: f64,
}

/// The points of an original, and what smoothing would do to them.
pub struct Views {
    points: Vec<Point>,
    /// By point: how far each smoothing would move it along its normal.
    smoothings: Vec<[f64; NUM_SMOOTHINGS]>,
    normals: Vec<DVec3>,
}

impl Views {
    /// Strews points over an original. O(V + F).
    pub fn new(mesh: &Mesh) -> Views {
        let normals = vertex_normals(mesh);
        let points = scattered(mesh, NUM_POINTS, 7);
        let moved = smoothings(mesh, &normals);
        let at = |point: &Point| {
            let corners = mesh.triangles[point.triangle as usize];
            std::array::from_fn(|number| {
                let own = corners.map(|v| moved[v as usize][number]);
                (0..3).map(|i| own[i] * point.weights[i]).sum()
            })
        };
        Views {
            smoothings: points.iter().map(at).collect(),
            points,
            normals,
        }
    }
}

/// How neighbours count where a vertex moves towards their mean.
#[derive(Clone, Copy)]
enum Neighbours {
    /// Alike, the vertex among them.
    Alike,
    /// By the cotangents of the angles across from the edge between, as MeshLab has it.
    Cotangents,
    /// By the inverse of their distance, as Open3D has it.
    Distance,
}

/// Less than this is nothing, as a sum of weights.
const LEAST_SUM: f64 = 1e-9;

/// The smoothings that are told apart: so many steps, each time after those before of their kind. Three steps by MeshLab of the cow, vertex by
/// vertex: the first kind alone left 0.76 of the displacement (RMS), all left 0.10; by Open3D 0.50 and 0.08.
const SMOOTHINGS: [(Neighbours, [usize; 3]); 3] = [
    (Neighbours::Alike, [1, 4, 12]),
    (Neighbours::Cotangents, [1, 2, 4]),
    (Neighbours::Distance, [1, 2, 4]),
];
const NUM_SMOOTHINGS: usize = 9;

/// How far each smoothing moves every vertex along its normal.
fn smoothings(mesh: &Mesh, normals: &[DVec3]) -> Vec<[f64; NUM_SMOOTHINGS]> {
    let edges = Edges::new(mesh);
    let mut all = vec![[0.0; NUM_SMOOTHINGS]; mesh.positions.len()];
    let mut number = 0;
    for (neighbours, stages) in SMOOTHINGS {
        let mut now = mesh.clone();
        for steps in stages {
            let before = now.positions.clone();
            for _ in 0..steps {
                now.positions = smoothed(&now, &edges, neighbours);
            }
            for (vertex, own) in all.iter_mut().enumerate() {
                let moved = now.positions[vertex] - before[vertex];
                own[number] = moved.dot(normals[vertex]);
            }
            number += 1;
        }
    }
    all
}

/// Where one step of smoothing takes every vertex.
fn smoothed(mesh: &Mesh, edges: &Edges, neighbours: Neighbours) -> Vec<DVec3> {
    let now = &mesh.positions;
    let own = match neighbours {
        Neighbours::Alike => 1.0,
        _ => 0.0,
    };
    let mut sums: Vec<(DVec3, f64)> = now.iter().map(|p| (*p * own, own)).collect();
    let mut add = |a: u32, b: u32, weight: f64| {
        for (to, from) in [(a, b), (b, a)] {
            let sum = &mut sums[to as usize];
            sum.0 += now[from as usize] * weight;
            sum.1 += weight;
        }
    };
    match neighbours {
        Neighbours::Alike => edges.ends().for_each(|[a, b]| add(a, b, 1.0)),
        Neighbours::Distance => edges.ends().for_each(|[a, b]| {
            let distance = now[a as usize].distance(now[b as usize]);
            if distance > 0.0 {
                add(a, b, 1.0 / distance);
            }
        }),
        Neighbours::Cotangents => {
            for &triangle in &mesh.triangles {
                let cotangents = cotangents(mesh.corners(triangle));
                for (i, cotangent) in cotangents.into_iter().enumerate() {
                    add(triangle[(i + 1) % 3], triangle[(i + 2) % 3], cotangent);
                }
            }
        }
    }
    // Cotangents of obtuse angles are negative: a vertex whose weights add up to nothing stays where it is.
    let moved = |((sum, weight), p): ((DVec3, f64), &DVec3)| match neighbours {
        _ if weight <= LEAST_SUM => *p,
        Neighbours::Alike => sum / weight,
        _ => 0.5 * (*p + sum / weight),
    };
    sums.into_iter().zip(now).map(moved).collect()
}

/// What a suspect shows of an original's surface as it lies on it.
pub struct Shown<'a> {
    views: &'a Views,
    original: &'a Original<'a>,
    /// The points that can be seen, and what is left of the distance there.
    seen: Vec<(u32, f64)>,
}

impl<'a> Shown<'a> {
    /// Looks at a suspect that a motion takes onto the original; `None` where too little of it lies there.
    pub fn new(
        original: &'a Original,
        views: &'a Views,
        suspect: &Mesh,
        motion: &Motion,
    ) -> Option<Shown<'a>> {
        let moved = motion.of_mesh(suspect);
        let surface = Surface::new(&moved);
        let open = open_sides(&moved);
        let chords = Chords::of(original, views, &moved);
        let d = original.diagonal;
        let feet = views.points.iter().zip(0u32..).filter_map(|(point, name)| {
            let nearest = surface.nearest_within(point.position, FARTHEST * d)?;
            if nearest.is_at_boundary(&open) {
                return None;
            }
            let [a, b, c] = moved.corners(moved.triangles[nearest.triangle as usize]);
            let plane = (b - a).cross(c - a).normalize_or_zero();
            let along = point.normal.dot(nearest.point - point.position);
            let is_across = nearest.distance < TOUCHING * d || along.abs() > 0.5 * nearest.distance;
            is_across.then_some((name, along, plane.dot(point.normal), nearest))
        });
        let feet: Vec<_> = feet.collect();
        // A file may face inwards.
        let turned = feet
            .iter()
            .map(|(_, _, agree, _)| agree.signum())
            .sum::<f64>()
            < 0.0;
        let facing = if turned { -1.0 } else { 1.0 };
        let mut seen = Vec::new();
        let mut columns = Vec::new();
        for (name, along, agree, nearest) in feet {
            if facing * agree <= AGREE {
                continue;
            }
            let point = &views.points[name as usize];
            let y = (point.position - original.mesh.positions[0]) / d;
            let n = point.normal;
            let mut row = [0.0; COLUMNS];
            for axis in 0..3 {
                row[3 * axis..3 * axis + 3].copy_from_slice(&(y * n[axis]).to_array());
            }
            row[9..12].copy_from_slice(&n.to_array());
            row[12] = 1.0;
            row[FIRST_SMOOTHING..FIRST_CHORD].copy_from_slice(&views.smoothings[name as usize]);
            if let Some(chords) = &chords {
                row[FIRST_CHORD..].copy_from_slice(&chords.at(&nearest));
            }
            seen.push((name, along));
            columns.push(row);
        }
        if seen.len() < LEAST_POINTS {
            return None;
        }
        level(&mut columns);
        let values: Vec<f64> = seen.iter().map(|(_, along)| *along).collect();
        let left = without(&columns, values, d);
        seen.iter_mut()
            .zip(left)
            .for_each(|(seen, left)| seen.1 = left);
        Some(Shown {
            views,
            original,
            seen,
        })
    }

    /// The share of the original that is seen, 0 to 1.
    pub fn covered(&self) -> f64 {
        self.seen.len() as f64 / self.views.points.len().max(1) as f64
    }

    /// What is seen beside the trend over many windows of a radius.
    pub fn observations(&self, radius: f64) -> Vec<Observation> {
        let (values, noise) = self.beside_trend(radius);
        let point = |(name, value, noise): (u32, f64, f64)| {
            let point = &self.views.points[name as usize];
            Observation {
                vertices: self.original.mesh.triangles[point.triangle as usize],
                weights: point.weights,
                direction: point.normal,
                value: value.clamp(-CLIP * noise, CLIP * noise),
                precision: 1.0 / (noise * noise),
            }
        };
        let names = self.seen.iter().map(|(name, _)| *name);
        let all = names.zip(values).zip(noise);
        all.map(|((name, value), noise)| point((name, value, noise)))
            .collect()
    }

    /// Each value without the local median, and the local deviation.
    fn beside_trend(&self, radius: f64) -> (Vec<f64>, Vec<f64>) {
        let d = self.original.diagonal;
        let place = |at: usize| {
            let point = &self.views.points[self.seen[at].0 as usize];
            let (x, n) = (point.position, point.normal * (SIDES * d));
            [x.x, x.y, x.z, n.x, n.y, n.z]
        };
        let order = Random::new(11).permutation(self.seen.len());
        let few = &order[..order.len().min(TREND_POINTS)];
        let anchors = &order[..order.len().min(ANCHORS)];
        let window = std::f64::consts::PI * radius * radius;
        let covered = self.original.mesh.area() * self.covered();
        let wanted = few.len() as f64 * TREND_WINDOWS * window / covered;
        let count = (wanted as usize).clamp(25, 900).min(few.len());
        let near = Near::new(few.iter().map(|&at| place(at as usize)));
        let trends: Vec<(f64, f64)> = anchors
            .iter()
            .map(|&anchor| {
                let around = near.nearest(place(anchor as usize), count);
                let values = around
                    .iter()
                    .map(|&(_, at)| self.seen[few[at as usize] as usize].1);
                let mut values: Vec<f64> = values.collect();
                let middle = median(&mut values);
                values.iter_mut().for_each(|v| *v = (*v - middle).abs());
                (middle, 1.4826 * median(&mut values))
            })
            .collect();
        let near = Near::new(anchors.iter().map(|&at| place(at as usize)));
        let mut values = Vec::with_capacity(self.seen.len());
        let mut noise = Vec::with_capacity(self.seen.len());
        for (at, (_, value)) in self.seen.iter().enumerate() {
            let around = near.nearest(place(at), 3);
            let (mut total, mut trend, mut scale) = (0.0, 0.0, 0.0);
            for (square, anchor) in around {
                let weight = 1.0 / (square.sqrt() + 1e-9 * d);
                let (middle, deviation) = trends[anchor as usize];
                total += weight;
                trend += weight * middle;
                scale += weight * deviation;
            }
            values.push(value - trend / total);
            noise.push(scale / total);
        }
        let global = 1.4826 * median(&mut values.iter().map(|v| v.abs()).collect::<Vec<_>>());
        let least = (0.3 * global) * (0.3 * global) + 1e-14 * d * d;
        noise.iter_mut().for_each(|s| *s = (*s * *s + least).sqrt());
        (values, noise)
    }
}

/// The value in the middle; 0 of none.
pub(super) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    match values.is_empty() {
        true => 0.0,
        false => *values.select_nth_unstable_by(middle, f64::total_cmp).1,
    }
}

/// How far the chords of a suspect's triangles lie beneath the surface that they stand for, by the original's normals at their corners.
struct Chords<'a> {
    suspect: &'a Mesh,
    normals: Vec<DVec3>,
}

impl<'a> Chords<'a> {
    fn of(original: &Original, views: &Views, suspect: &'a Mesh) -> Option<Chords<'a>> {
        if suspect.positions.len() >= MOST_FOR_CHORDS {
            return None;
        }
        let normal = |position: &DVec3| {
            let Some(foot) = original.surface.nearest(*position) else {
                return DVec3::ZERO;
            };
            let corners = original.mesh.triangles[foot.triangle as usize];
            let parts = (0..3).map(|i| views.normals[corners[i] as usize] * foot.weights[i]);
            parts.sum::<DVec3>().normalize_or_zero()
        };
        Some(Chords {
            normals: suspect.positions.iter().map(normal).collect(),
            suspect,
        })
    }

    /// At a point of a triangle, and on the average over it.
    fn at(&self, nearest: &super::Nearest) -> [f64; 2] {
        let triangle = self.suspect.triangles[nearest.triangle as usize];
        let v = self.suspect.corners(triangle);
        let n = triangle.map(|corner| self.normals[corner as usize]);
        let b = nearest.weights;
        let (mut here, mut mean) = (0.0, 0.0);
        for (i, j) in [(0, 1), (1, 2), (0, 2)] {
            let sag = -0.5 * (n[j] - n[i]).dot(v[j] - v[i]);
            here += b[i] * b[j] * sag;
            mean += sag / 12.0;
        }
        [here, mean]
    }
}

/// Brings what is measured of smoothings and chords to a common size, and holds it to a few deviations.
fn level(rows: &mut [[f64; COLUMNS]]) {
    for column in FIRST_SMOOTHING..COLUMNS {
        let mut sizes: Vec<f64> = rows.iter().map(|row| row[column].abs()).collect();
        let most = 6.0 * median(&mut sizes);
        let mut square = 0.0;
        for row in rows.iter_mut() {
            row[column] = row[column].clamp(-most, most);
            square += row[column] * row[column];
        }
        let size = (square / rows.len() as f64).sqrt();
        for row in rows.iter_mut() {
            row[column] = if size > 0.0 { row[column] / size } else { 0.0 };
        }
    }
}

/// The affine map that explains most of some values, by how each answers to its twelve numbers; and what is left of them. `None` where there is
/// none.
pub fn affine_fit(rows: &[[f64; 12]], values: &[f64]) -> Option<([f64; 12], Vec<f64>)> {
    let least = 1e-9 * values.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    let (x, left) = fitted(rows, values, least);
    x.map(|x| (x, left))
}

/// Values without what columns explain of them.
fn without(rows: &[[f64; COLUMNS]], values: Vec<f64>, diagonal: f64) -> Vec<f64> {
    fitted(rows, &values, 1e-9 * diagonal).1
}

/// Least squares, in rounds that give what does not fit less weight (Cauchy's); what is less than `least` fits.
fn fitted<const N: usize>(
    rows: &[[f64; N]],
    values: &[f64],
    least: f64,
) -> (Option<[f64; N]>, Vec<f64>) {
    let mut weights = vec![1.0; rows.len()];
    let mut left = values.to_vec();
    let mut solution = None;
    for _ in 0..ROUNDS {
        let mut products = SMatrix::<f64, N, N>::zeros();
        let mut right = SVector::<f64, N>::zeros();
        for ((row, value), weight) in rows.iter().zip(values).zip(&weights) {
            for i in 0..N {
                let scaled = weight * row[i];
                right[i] += scaled * value;
                for j in 0..=i {
                    products[(i, j)] += scaled * row[j];
                }
            }
        }
        let damping = 1e-10 * products.trace() / N as f64;
        for i in 0..N {
            products[(i, i)] += damping;
            for j in 0..i {
                products[(j, i)] = products[(i, j)];
            }
        }
        let Some(factor) = products.cholesky() else {
            break;
        };
        let x = factor.solve(&right);
        solution = Some(std::array::from_fn(|i| x[i]));
        for ((left, value), row) in left.iter_mut().zip(values).zip(rows) {
            *left = value - (0..N).map(|i| x[i] * row[i]).sum::<f64>();
        }
        let mut sizes: Vec<f64> = left.iter().map(|e| e.abs()).collect();
        let scale = 2.0 * (1.4826 * median(&mut sizes) + least);
        for (weight, e) in weights.iter_mut().zip(&left) {
            let ratio = e / scale;
            *weight = 1.0 / ((1.0 + ratio * ratio) * (1.0 + ratio * ratio));
        }
    }
    (solution, left)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::*;
    use crate::mesh::shapes;

    /// Three whole steps, as programs take them: of each kind, and little is left of it.
    #[test]
    fn what_programs_smooth_is_taken_out() {
        let mesh = shapes::asteroid(24, 36);
        let edges = Edges::new(&mesh);
        let (original, views) = (Original::new(&mesh), Views::new(&mesh));
        for neighbours in [Neighbours::Cotangents, Neighbours::Distance] {
            let mut suspect = mesh.clone();
            for _ in 0..3 {
                let half = smoothed(&suspect, &edges, neighbours);
                let steps = suspect.positions.iter_mut().zip(half);
                steps.for_each(|(p, half)| *p = 2.0 * half - *p);
            }
            let moved = suspect.positions.iter().zip(&mesh.positions);
            let mut moved: Vec<f64> = moved.map(|(after, p)| after.distance(*p)).collect();
            let shown = Shown::new(&original, &views, &suspect, &Motion::IDENTITY).unwrap();
            let mut left: Vec<f64> = shown.seen.iter().map(|(_, left)| left.abs()).collect();
            let share = median(&mut left) / median(&mut moved);
            assert!(share < 0.1, "{share} is left");
        }
    }
}
