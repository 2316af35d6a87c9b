//! The linear problem of one embedding round: which displacement takes every window to its lattice, at the least cost.
//!
//! Minimises `sum weight (row x - goal)^2 + mu |x|^2` over displacements x that leave ten moments of the surface alone, so that
//! the frame stays where it is. In the dual that is `(G + mu / weight) l = goal` with the sparse matrix G of the windows' inner
//! products: windows that share no vertex do not meet, so its size depends on the shape and not on the number of vertices.
//!
//! Displacements along vertex normals alone, or weighted by area, reach little more than half the exponent at equal RMS.

use super::cluster::{EDGE, MOST_PARTS};
use super::grid::Grid;
use super::lattice::{Placement, RADIUS, for_each_near};
use super::lists::Lists;
use super::moments::{MOMENTS, PerMoment, answers, orthonormal};
use super::window::{Window, sensitivity};
use crate::geometry::{Pose, Quadrature, conjugate_gradients};
use crate::mesh::Mesh;
use glam::DVec3;
use std::borrow::Cow;

/// Windows whose vertices are listed at a time: lists for all would double the memory.
const BLOCK: usize = 512;
const CG_STEPS: usize = 50;
const CG_TOLERANCE: f64 = 1e-3;
/// Displacements and fluxes are in lattice coordinates.
pub struct Problem<'a> {
    triangles: Cow<'a, [[u32; 3]]>,
    /// In lattice coordinates.
    positions: Vec<DVec3>,
    /// By vertex: the triangles at it.
    faces: Lists<u32>,
    /// By vertex: windows and how they answer to its displacement in units of its freedom.
    pushes: Lists<(u32, [f32; 3])>,
    freedom: Cow<'a, [f64]>,
    /// By window: its inner products with windows, itself included. None are listed where vertices are few: [`Problem::inner`].
    gram: Lists<(u32, f64)>,
    diagonal: Vec<f64>,
    /// By window: the part of the moments in it, in an orthonormal basis of these.
    coupling: Vec<PerMoment<f64>>,
    /// Takes coordinates in that basis to multipliers of the moments.
    basis: PerMoment<PerMoment<f64>>,
}

impl<'a> Problem<'a> {
    pub fn new(
        mesh: &'a Mesh,
        pose: &Pose,
        placement: &Placement,
        active: &[Window],
        freedom: &'a [f64],
    ) -> Problem<'a> {
        let num_vertices = mesh.positions.len();
        let corners = || {
            let faces = mesh.triangles.iter().zip(0u32..);
            faces.flat_map(|(triangle, face)| triangle.map(|vertex| (vertex, face)))
        };
        let mut problem = Problem {
            triangles: Cow::Borrowed(&mesh.triangles),
            positions: mesh
                .positions
                .iter()
                .map(|p| placement.lattice(pose.canonical(*p)))
                .collect(),
            faces: Lists::from_pairs(num_vertices, corners),
            pushes: Lists::default(),
            freedom: Cow::Borrowed(freedom),
            gram: Lists::default(),
            diagonal: Vec::new(),
            coupling: vec![[0.0; MOMENTS]; active.len()],
            basis: [[0.0; MOMENTS]; MOMENTS],
        };
        problem.push(active);
        problem.project();
        problem.measure();
        if num_vertices >= active.len() {
            problem.multiply();
        }
        problem
    }

    /// How windows and moments answer to every vertex.
    fn push(&mut self, active: &[Window]) {
        let triangles = self.triangles.iter();
        let corners = triangles.map(|triangle| triangle.map(|v| self.positions[v as usize]));
        let quadrature = Quadrature::new(EDGE).at_most(MOST_PARTS, corners);
        let positions = active
            .iter()
            .map(|window| DVec3::from_array(window.index.map(f64::from)));
        let mut rows = Grid::about(positions, 0.0, u32::MAX);
        for (window, row) in active.iter().zip(0..) {
            let place = rows.place(window.index);
            rows.values[place] = row;
        }
        let mut sums = vec![DVec3::ZERO; active.len()];
        let mut touched: Vec<u32> = Vec::new();
        for vertex in 0..self.positions.len() {
            for &face in self.faces.get(vertex) {
                let triangle = self.triangles[face as usize];
                let corner = triangle
                    .iter()
                    .position(|v| *v as usize == vertex)
                    .unwrap_or(0);
                let corners = triangle.map(|v| self.positions[v as usize]);
                for sample in quadrature.samples(corners) {
                    let push = sample.area * (sample.weights[corner] * self.freedom[vertex]);
                    for_each_near(sample.point, RADIUS, |index, _, q2| {
                        let Some(place) = rows.find(index) else {
                            return;
                        };
                        let row = rows.values[place];
                        if row == u32::MAX {
                            return;
                        }
                        let sum = &mut sums[row as usize];
                        if *sum == DVec3::ZERO {
                            touched.push(row);
                        }
                        *sum += push * sensitivity(q2);
                    });
                }
            }
            let moments = self.moments(vertex);
            for (a, row) in moments.iter().zip(&mut self.basis) {
                row.iter_mut()
                    .zip(&moments)
                    .for_each(|(entry, b)| *entry += a.dot(*b));
            }
            for row in touched.drain(..) {
                let sum = std::mem::take(&mut sums[row as usize]);
                if sum == DVec3::ZERO {
                    continue;
                }
                self.pushes.items.push((row, sum.as_vec3().to_array()));
                let coupling = &mut self.coupling[row as usize];
                coupling
                    .iter_mut()
                    .zip(&moments)
                    .for_each(|(entry, m)| *entry += sum.dot(*m));
            }
            self.pushes.end_list();
        }
    }

    /// How the moments answer to a vertex in units of its freedom.
    fn moments(&self, vertex: usize) -> PerMoment<DVec3> {
        let mut moments = [DVec3::ZERO; MOMENTS];
        for &face in self.faces.get(vertex) {
            let corners = self.triangles[face as usize].map(|v| self.positions[v as usize]);
            let answers = answers(corners, self.positions[vertex], self.freedom[vertex]);
            moments
                .iter_mut()
                .zip(answers)
                .for_each(|(moment, answer)| *moment += answer);
        }
        moments
    }

    /// Makes the moments orthonormal, whose inner products are in `basis` so far.
    fn project(&mut self) {
        self.basis = orthonormal(&self.basis);
        for coupling in &mut self.coupling {
            let raw = *coupling;
            *coupling = self
                .basis
                .map(|vector| vector.iter().zip(&raw).map(|(v, c)| v * c).sum());
        }
    }

    /// Each window's inner product with itself, the moments' part taken out.
    fn measure(&mut self) {
        let mut wholes = vec![0.0; self.coupling.len()];
        for &(row, push) in &self.pushes.items {
            wholes[row as usize] += push.map(f64::from).iter().map(|p| p * p).sum::<f64>();
        }
        let outside =
            |coupling: &PerMoment<f64>| coupling.iter().map(|part| part * part).sum::<f64>();
        let wholes = wholes.into_iter().zip(&self.coupling);
        self.diagonal = wholes
            .map(|(whole, coupling)| (whole - outside(coupling)).max(1e-9 * whole))
            .collect();
    }

    /// Lists the windows' inner products.
    fn multiply(&mut self) {
        let num_windows = self.coupling.len();
        let pushes = &self.pushes;
        let num_vertices = self.positions.len() as u32;
        let mut sums = vec![0.0; num_windows];
        let mut touched: Vec<u32> = Vec::new();
        for start in (0..num_windows as u32).step_by(BLOCK) {
            let block = start..(start + BLOCK as u32).min(num_windows as u32);
            let by_window = || {
                (0..num_vertices).flat_map(|vertex| {
                    let pushes = pushes.get(vertex as usize).iter();
                    pushes
                        .filter(|(row, _)| block.contains(row))
                        .map(move |&(row, push)| (row - start, (vertex, push)))
                })
            };
            let vertices: Lists<(u32, [f32; 3])> = Lists::from_pairs(block.len(), by_window);
            for window in 0..block.len() {
                for &(vertex, push) in vertices.get(window) {
                    let push = push.map(f64::from);
                    for &(other, its) in pushes.get(vertex as usize) {
                        let sum = &mut sums[other as usize];
                        if *sum == 0.0 {
                            touched.push(other);
                        }
                        *sum += push[0] * f64::from(its[0])
                            + push[1] * f64::from(its[1])
                            + push[2] * f64::from(its[2]);
                    }
                }
                for other in touched.drain(..) {
                    let sum = std::mem::take(&mut sums[other as usize]);
                    if sum != 0.0 {
                        self.gram.items.push((other, sum));
                    }
                }
                self.gram.end_list();
            }
        }
    }

    /// The windows' inner products times a number for each window. Where vertices are fewer than windows, most windows share one:
    /// what each vertex hears is then quicker summed than listed.
    fn inner(&self, l: &[f64]) -> Vec<f64> {
        if self.positions.len() >= l.len() {
            let row = |window| {
                let products = self.gram.get(window).iter();
                products.map(|&(other, g)| g * l[other as usize]).sum()
            };
            return (0..l.len()).map(row).collect();
        }
        let mut sums = vec![0.0; l.len()];
        for vertex in 0..self.positions.len() {
            let pushes = self.pushes.get(vertex);
            let heard = pushes.iter().fold(DVec3::ZERO, |heard, &(row, push)| {
                heard + DVec3::from_array(push.map(f64::from)) * l[row as usize]
            });
            for &(row, push) in pushes {
                sums[row as usize] += DVec3::from_array(push.map(f64::from)).dot(heard);
            }
        }
        sums
    }

    pub fn num_vertices(&self) -> usize {
        self.positions.len()
    }

    /// The same, which needs nobody else's memory.
    pub fn into_owned(self) -> Problem<'static> {
        Problem {
            triangles: Cow::Owned(self.triangles.into_owned()),
            freedom: Cow::Owned(self.freedom.into_owned()),
            ..self
        }
    }

    pub fn mean_diagonal(&self) -> f64 {
        self.diagonal.iter().sum::<f64>() / self.diagonal.len() as f64
    }

    /// What displacements of all vertices do to the windows.
    pub fn times(&self, x: impl Iterator<Item = DVec3>) -> Vec<f64> {
        let mut sums = vec![0.0; self.coupling.len()];
        for (vertex, x) in x.enumerate() {
            let x = x / self.freedom[vertex];
            for &(row, [a, b, c]) in self.pushes.get(vertex) {
                sums[row as usize] += f64::from(a) * x.x + f64::from(b) * x.y + f64::from(c) * x.z;
            }
        }
        sums
    }

    /// How much of each moment the windows' multipliers hold.
    fn parts(&self, multipliers: &[f64]) -> PerMoment<f64> {
        let mut parts = [0.0; MOMENTS];
        for (coupling, l) in self.coupling.iter().zip(multipliers) {
            parts
                .iter_mut()
                .zip(coupling)
                .for_each(|(part, c)| *part += c * l);
        }
        parts
    }

    /// The displacements of all vertices that take the windows nearest to their goals, from the last solution of the dual on: the next one
    /// is near it.
    pub fn solve(
        &self,
        goals: &[f64],
        weights: &[f64],
        mu: f64,
        multipliers: &mut [f64],
    ) -> Vec<DVec3> {
        self.relax(goals, weights, mu, multipliers);
        let parts = self.parts(multipliers);
        let mut of_moments = [0.0; MOMENTS];
        for (vector, part) in self.basis.iter().zip(parts) {
            of_moments
                .iter_mut()
                .zip(vector)
                .for_each(|(m, v)| *m += v * part);
        }
        let displacement = |vertex: usize| {
            let mut x = DVec3::ZERO;
            for &(row, push) in self.pushes.get(vertex) {
                x += DVec3::from_array(push.map(f64::from)) * multipliers[row as usize];
            }
            for (moment, multiplier) in self.moments(vertex).into_iter().zip(of_moments) {
                x -= moment * multiplier;
            }
            x * self.freedom[vertex]
        };
        (0..self.positions.len()).map(displacement).collect()
    }

    /// The matrix of the dual times a number for each window: what the windows are to be moved by for these multipliers.
    pub fn ridged(&self, l: &[f64], weights: &[f64], mu: f64) -> Vec<f64> {
        let parts = self.parts(l);
        let row = |(window, inner): (usize, f64)| {
            let outer: f64 = self.coupling[window]
                .iter()
                .zip(&parts)
                .map(|(c, part)| c * part)
                .sum();
            inner - outer + mu * l[window] / weights[window]
        };
        self.inner(l).into_iter().enumerate().map(row).collect()
    }

    /// The displacements of all vertices by the windows' multipliers, whatever that does to the moments.
    pub fn spread(&self, l: &[f64]) -> Vec<DVec3> {
        let displacement = |vertex: usize| {
            let pushes = self.pushes.get(vertex).iter();
            let sum: DVec3 = pushes
                .map(|&(row, push)| DVec3::from_array(push.map(f64::from)) * l[row as usize])
                .sum();
            sum * self.freedom[vertex]
        };
        (0..self.positions.len()).map(displacement).collect()
    }

    /// The transposed map: what a number for each vertex and axis gives each window.
    pub fn gathered(&self, at: &[DVec3]) -> Vec<f64> {
        let mut sums = vec![0.0; self.coupling.len()];
        for (vertex, at) in at.iter().enumerate() {
            let at = *at * self.freedom[vertex];
            for &(row, push) in self.pushes.get(vertex) {
                sums[row as usize] += DVec3::from_array(push.map(f64::from)).dot(at);
            }
        }
        sums
    }

    /// For each window, the sum over vertices of a number times the square of what a unit of its multiplier moves them by.
    pub fn squares(&self, at: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.coupling.len()];
        for (vertex, at) in at.iter().enumerate() {
            let at = at * self.freedom[vertex] * self.freedom[vertex];
            for &(row, push) in self.pushes.get(vertex) {
                sums[row as usize] += DVec3::from_array(push.map(f64::from)).length_squared() * at;
            }
        }
        sums
    }

    /// Each window's inner product with itself.
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Conjugate gradients on the dual, preconditioned by the diagonal, from the multipliers at hand.
    fn relax(&self, goals: &[f64], weights: &[f64], mu: f64, multipliers: &mut [f64]) {
        let apply = |l: &[f64]| self.ridged(l, weights, mu);
        let precondition = |r: &[f64]| -> Vec<f64> {
            r.iter()
                .zip(self.diagonal.iter().zip(weights))
                .map(|(r, (d, w))| r / (d + mu / w))
                .collect()
        };
        conjugate_gradients(
            apply,
            precondition,
            goals,
            multipliers,
            CG_TOLERANCE,
            CG_STEPS,
        );
    }
}
