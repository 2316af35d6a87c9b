//! Embedding by majorise-minimise on the detector's own statistic, with every vertex free to move in space.
//!
//! Each round linearizes the windows' fluxes in the displacement, weighs each window by how near its lattice it is (see
//! RING's embedder), and solves the ridge problem in its dual by conjugate gradients, on displacements that leave the moments
//! of the surface alone, so that the frame stays where it is. The frame is measured again in every round.
//!
//! Displacements along vertex normals alone, or weighted by area, reach little more than half the exponent at equal RMS.

use super::flux::{Placement, clusters, sensitivity, windows, windows_at};
use super::{Lattice, PITCH, oriented, pose_of, step_for};
use crate::carrier::{Carrier, CarrierError, Host, Mark};
use crate::geometry::{Pose, diagonal, roughness, samples};
use crate::mesh::{Edges, Mesh};
use crate::order::order_by;
use crate::progress::{Progress, Stage, step};
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

const ROUNDS: usize = 8;
const CG_STEPS: usize = 50;
const CG_TOLERANCE: f64 = 1e-3;
/// Weight that is left to a window half a step from its lattice.
const LEAST_WEIGHT: f64 = 0.02;
/// No vertex moves more than so many times the RMS limit.
const CLAMP: f64 = 4.0;
/// Windows without which a mark of 48 bits cannot be read.
pub const NEEDED_WINDOWS: usize = 100;

/// The exponent below which a mark is left to another carrier: 62 would do for the payload, a chance of 10^-9 and the tests,
/// if nothing happened to the model.
const NEEDED_EXPONENT: f64 = 150.0;

/// The displacement of all V vertices that gives the host the mark.
pub fn embed(
    host: &Host,
    mark: &Mark,
    progress: &mut dyn Progress,
) -> Result<Vec<DVec3>, CarrierError> {
    let mesh = oriented(host.mesh);
    let none = |available| CarrierError::TooFewAddresses {
        carrier: Carrier::Solid,
        needed: NEEDED_WINDOWS,
        available,
        vertices: mesh.positions.len(),
    };
    let pose = pose_of(&mesh).ok_or_else(|| none(0))?;
    let lattice = Lattice::of(mark.key);
    let placement = lattice.placed(DMat3::IDENTITY);
    let step_size = step_for(host.rms_rel) * PITCH * PITCH;
    let active = windows(&clusters(&mesh, &pose), &placement);
    if active.len() < NEEDED_WINDOWS {
        return Err(none(active.len()));
    }
    step(progress, Stage::Embed, 0.0)?;

    // Rough regions hide more: a vertex may move in proportion to the roughness about it.
    let freedom = roughness(&mesh, &Edges::new(&mesh).rings(mesh.positions.len()));
    let indices: Vec<[i32; 3]> = active.iter().map(|window| window.index).collect();
    let problem = Problem::new(&mesh, &pose, &placement, &indices, step_size, freedom);
    let targets: Vec<f64> = active
        .iter()
        .map(|window| {
            let (dither, symbol) = lattice.at(window.index);
            let coset = if mark.codeword.sign(symbol) > 0.0 {
                0.0
            } else {
                0.5
            };
            dither - coset
        })
        .collect();
    let limit = host.rms_rel * diagonal(&mesh.positions);
    let mut displacement = vec![DVec3::ZERO; mesh.positions.len()];
    let mut best = (0.0, displacement.clone());
    let mut multipliers = vec![0.0; active.len()];
    let mut ridge = None;
    for round in 0..=ROUNDS {
        let fluxes = fluxes(&mesh, &displacement, &pose, &placement, &active);
        let phases: Vec<f64> = fluxes
            .iter()
            .zip(&targets)
            .map(|(flux, target)| flux / step_size + target)
            .collect();
        let (sum, energy) =
            phases
                .iter()
                .zip(&active)
                .fold((0.0, 0.0), |(sum, energy), (phase, window)| {
                    (
                        sum + window.weight * libm::cos(TAU * phase),
                        energy + window.weight * window.weight,
                    )
                });
        let exponent = if sum > 0.0 { sum * sum / energy } else { 0.0 };
        if exponent > best.0 {
            best = (exponent, displacement.clone());
        }
        if round == ROUNDS {
            break;
        }
        let errors: Vec<f64> = phases.iter().map(|phase| phase.round() - phase).collect();
        let weights: Vec<f64> = errors
            .iter()
            .zip(&active)
            .map(|(error, window)| {
                let angle = TAU * error.abs();
                let curvature = if angle > 0.0 {
                    libm::sin(angle) / angle
                } else {
                    1.0
                };
                window.weight * curvature.max(LEAST_WEIGHT)
            })
            .collect();
        let to_frame = pose.axes.transpose() * (1.0 / pose.size);
        let frame: Vec<DVec3> = displacement
            .iter()
            .map(|d| placement.rotation.transpose() * (to_frame * *d))
            .collect();
        let goals: Vec<f64> = problem
            .rows
            .times(&problem.scaled(&frame, |freedom| 1.0 / freedom))
            .zip(&errors)
            .map(|(reached, error)| reached + error)
            .collect();
        let tries = if round == 0 { 7 } else { 3 };
        let mut solution = frame;
        for attempt in 0..tries {
            let mu = *ridge.get_or_insert_with(|| problem.mean_diagonal());
            solution = problem.scaled(
                &problem.solve(&goals, &weights, mu, &mut multipliers),
                |freedom| freedom,
            );
            let rms = (solution.iter().map(|x| x.length_squared()).sum::<f64>()
                / solution.len() as f64)
                .sqrt()
                * pose.size;
            if attempt + 1 < tries {
                // The RMS falls more slowly than the ridge grows.
                let excess = (rms / limit).clamp(0.05, 20.0);
                ridge = Some(mu * excess * excess);
            }
            progress_at(progress, round, attempt, tries)?;
        }
        let from_frame = pose.axes * placement.rotation * pose.size;
        displacement = solution
            .iter()
            .map(|x| (from_frame * *x).clamp_length_max(CLAMP * limit))
            .collect();
        host.admissible.project(&mut displacement);
        let square = displacement.iter().map(|d| d.length_squared()).sum::<f64>()
            / displacement.len() as f64;
        let scale = (limit / square.sqrt()).min(1.0);
        displacement.iter_mut().for_each(|d| *d *= scale);
    }
    step(progress, Stage::Embed, 1.0)?;
    let (reached, displacement) = best;
    if reached < NEEDED_EXPONENT {
        return Err(CarrierError::TooWeak {
            carrier: Carrier::Solid,
            reached,
            needed: NEEDED_EXPONENT,
        });
    }
    Ok(displacement)
}

fn progress_at(
    progress: &mut dyn Progress,
    round: usize,
    attempt: usize,
    tries: usize,
) -> Result<(), CarrierError> {
    let done = round as f64 + (attempt + 1) as f64 / tries as f64;
    Ok(step(progress, Stage::Embed, done / ROUNDS as f64)?)
}

/// The fluxes of the displaced mesh at the active windows, in its own frame, the axes' signs as the host's.
fn fluxes(
    mesh: &Mesh,
    displacement: &[DVec3],
    host: &Pose,
    placement: &Placement,
    active: &[super::flux::Window],
) -> Vec<f64> {
    let moved = mesh.with_positions(
        mesh.positions
            .iter()
            .zip(displacement)
            .map(|(p, d)| *p + *d)
            .collect(),
    );
    let pose = pose_of(&moved).map_or(*host, |pose| pose.aligned_with(host));
    let now = windows(&clusters(&moved, &pose), placement);
    let find = |index| {
        now.binary_search_by_key(&index, |window| window.index)
            .ok()
            .map(|found| now[found].flux)
    };
    active
        .iter()
        .map(|window| find(window.index).unwrap_or(window.flux))
        .collect()
}

/// The linear model of the windows: phases = rows * displacement, phases in steps, displacements in lattice coordinates and
/// in units of each vertex's freedom.
struct Problem {
    rows: VectorRows,
    /// Orthonormal: how ten moments of the surface answer to displacements.
    moments: Vec<Vec<DVec3>>,
    diagonal: Vec<f64>,
    /// The unit of each vertex's unknowns, in units of the frame.
    freedom: Vec<f64>,
}

impl Problem {
    fn new(
        mesh: &Mesh,
        pose: &Pose,
        placement: &Placement,
        active: &[[i32; 3]],
        step_size: f64,
        freedom: Vec<f64>,
    ) -> Problem {
        let num_vertices = mesh.positions.len();
        let mut entries: Vec<(u32, u32, DVec3)> = Vec::new();
        let mut moments = vec![vec![DVec3::ZERO; num_vertices]; 10];
        for sample in samples(mesh, PITCH * pose.size / 3.0) {
            let y = placement.lattice(pose.canonical(sample.point));
            let area = placement.rotation.transpose() * (pose.axes.transpose() * sample.area)
                / (pose.size * pose.size);
            let corners = mesh.triangles[sample.face as usize];
            let values = [
                1.0,
                y.x,
                y.y,
                y.z,
                y.x * y.x,
                y.x * y.y,
                y.x * y.z,
                y.y * y.y,
                y.y * y.z,
                y.z * y.z,
            ];
            for (moment, value) in moments.iter_mut().zip(values) {
                for (corner, weight) in corners.into_iter().zip(sample.weights) {
                    moment[corner as usize] += area * (value * weight * freedom[corner as usize]);
                }
            }
            for (index, _, q2) in windows_at(y) {
                if let Ok(row) = active.binary_search(&index) {
                    let push = area * (sensitivity(q2) / step_size);
                    let pushed = |(v, weight): (u32, f64)| {
                        (row as u32, v, push * (weight * freedom[v as usize]))
                    };
                    entries.extend(corners.into_iter().zip(sample.weights).map(pushed));
                }
            }
        }
        let rows = VectorRows::new(entries, active.len());
        orthonormalize(&mut moments);
        let diagonal = rows
            .rows()
            .map(|row| {
                let whole: f64 = row.iter().map(|(_, push)| push.length_squared()).sum();
                let outside: f64 = moments
                    .iter()
                    .map(|moment| {
                        row.iter()
                            .map(|&(v, push)| push.dot(moment[v as usize]))
                            .sum::<f64>()
                    })
                    .map(|part| part * part)
                    .sum();
                (whole - outside).max(1e-9 * whole)
            })
            .collect();
        Problem {
            rows,
            moments,
            diagonal,
            freedom,
        }
    }

    /// Displacements of all vertices, each times a function of its freedom.
    fn scaled(&self, x: &[DVec3], scale: impl Fn(f64) -> f64) -> Vec<DVec3> {
        x.iter()
            .zip(&self.freedom)
            .map(|(x, &freedom)| *x * scale(freedom))
            .collect()
    }

    fn mean_diagonal(&self) -> f64 {
        self.diagonal.iter().sum::<f64>() / self.diagonal.len() as f64
    }

    /// The displacement of multipliers: the transposed rows, projected on what leaves the moments alone.
    fn displacement(&self, multipliers: &[f64]) -> Vec<DVec3> {
        let mut x = self.rows.transposed(multipliers, self.freedom.len());
        for moment in &self.moments {
            let part: f64 = moment.iter().zip(&x).map(|(m, x)| m.dot(*x)).sum();
            x.iter_mut().zip(moment).for_each(|(x, m)| *x -= *m * part);
        }
        x
    }

    /// Minimises `sum weight (row x - goal)^2 + mu |x|^2`: conjugate gradients, preconditioned by the diagonal, on the dual
    /// `(G + mu / weight) l = goal`, from the multipliers at hand.
    fn solve(
        &self,
        goals: &[f64],
        weights: &[f64],
        mu: f64,
        multipliers: &mut [f64],
    ) -> Vec<DVec3> {
        let apply = |l: &[f64]| -> Vec<f64> {
            let x = self.displacement(l);
            self.rows
                .times(&x)
                .zip(l.iter().zip(weights))
                .map(|(y, (l, w))| y + mu * l / w)
                .collect()
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let precondition = |r: &[f64]| -> Vec<f64> {
            r.iter()
                .zip(self.diagonal.iter().zip(weights))
                .map(|(r, (d, w))| r / (d + mu / w))
                .collect()
        };
        let mut residual: Vec<f64> = goals
            .iter()
            .zip(apply(multipliers))
            .map(|(goal, y)| goal - y)
            .collect();
        let enough = CG_TOLERANCE * CG_TOLERANCE * dot(goals, goals);
        let mut scaled = precondition(&residual);
        let mut direction = scaled.clone();
        let mut square = dot(&residual, &scaled);
        for _ in 0..CG_STEPS {
            if dot(&residual, &residual) <= enough {
                break;
            }
            let image = apply(&direction);
            let length = square / dot(&direction, &image);
            multipliers
                .iter_mut()
                .zip(&direction)
                .for_each(|(l, d)| *l += length * d);
            residual
                .iter_mut()
                .zip(&image)
                .for_each(|(r, i)| *r -= length * i);
            scaled = precondition(&residual);
            let previous = std::mem::replace(&mut square, dot(&residual, &scaled));
            direction
                .iter_mut()
                .zip(&scaled)
                .for_each(|(d, s)| *d = s + square / previous * *d);
        }
        self.displacement(multipliers)
    }
}

/// Modified Gram-Schmidt; what depends on those before it becomes zero.
fn orthonormalize(vectors: &mut [Vec<DVec3>]) {
    let dot = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
    for i in 0..vectors.len() {
        let (before, rest) = vectors.split_at_mut(i);
        let vector = &mut rest[0];
        let original = dot(vector, vector);
        for _ in 0..2 {
            for other in before.iter() {
                let part = dot(other, vector);
                vector
                    .iter_mut()
                    .zip(other)
                    .for_each(|(v, o)| *v -= *o * part);
            }
        }
        let square = dot(vector, vector);
        let scale = if square > 1e-16 * original {
            1.0 / square.sqrt()
        } else {
            0.0
        };
        vector.iter_mut().for_each(|v| *v *= scale);
    }
}

/// A sparse matrix of vectors, by rows.
struct VectorRows {
    ends: Vec<usize>,
    entries: Vec<(u32, DVec3)>,
}

impl VectorRows {
    /// Adds up the entries (row, column, value) of each place.
    fn new(entries: Vec<(u32, u32, DVec3)>, num_rows: usize) -> VectorRows {
        let order = order_by(
            entries
                .iter()
                .map(|&(row, column, _)| u64::from(row) << 32 | u64::from(column)),
        );
        let mut ends = vec![0; num_rows];
        let mut merged: Vec<(u32, DVec3)> = Vec::new();
        for place in order.chunk_by(|a, b| a.0 == b.0) {
            let (row, column, _) = entries[place[0].1 as usize];
            merged.push((
                column,
                place
                    .iter()
                    .map(|&(_, entry)| entries[entry as usize].2)
                    .sum(),
            ));
            ends[row as usize] = merged.len();
        }
        for row in 1..num_rows {
            ends[row] = ends[row].max(ends[row - 1]);
        }
        VectorRows {
            ends,
            entries: merged,
        }
    }

    fn rows(&self) -> impl Iterator<Item = &[(u32, DVec3)]> {
        self.ends.iter().scan(0, |start, &end| {
            let row = &self.entries[*start..end];
            *start = end;
            Some(row)
        })
    }

    fn times(&self, x: &[DVec3]) -> impl Iterator<Item = f64> {
        self.rows().map(|row| {
            row.iter()
                .map(|&(column, value)| value.dot(x[column as usize]))
                .sum()
        })
    }

    fn transposed(&self, y: &[f64], num_columns: usize) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; num_columns];
        for (row, &y) in self.rows().zip(y) {
            row.iter()
                .for_each(|&(column, value)| sums[column as usize] += value * y);
        }
        sums
    }
}
