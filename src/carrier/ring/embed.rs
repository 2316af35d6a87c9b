//! Embedding by majorise-minimise on the detector's own statistic.
//!
//! The detector sums cosines of phase errors. A cosine is majorised by a parabola whose curvature is `sin(t)/t` at the
//! present error `t`, so each round solves a weighted linear least-squares problem; rings that are nearly half a step from
//! their lattice get almost no weight and are given up. Least squares without those weights reaches a lower agreement at
//! the same RMS. O(rounds * CG steps * rings).

use super::address::{self, AddressKind, Turn};
use super::feature::{Features, Neighbourhoods};
use super::measurement::read_at;
use super::{Measurement, Owned, Ownership, SHARE, STEP};
use crate::carrier::qim::curvature;
use crate::carrier::{Carrier, CarrierError, Embedded, Host, Mark, Needs, Reading};
use crate::geometry::{Pose, conjugate_gradients, diagonal, unconditioned, vertex_normals};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress, Stage, ignore, step};
use glam::DVec3;
use std::borrow::Cow;

const ROUNDS: usize = 6;
/// Rounds of a further message.
const ROUNDS_AGAIN: usize = 3;
const CG_STEPS: usize = 60;
const CG_TOLERANCE: f64 = 1e-3;
/// Weight of a vertex's own displacement, in units of its ring's size, against errors in units of the feature.
const RIDGE: f64 = 0.15;
/// Weight that is left to a ring half a step from its lattice.
const LEAST_WEIGHT: f64 = 0.05;
/// No vertex moves more than so many times the RMS limit.
const CLAMP: f64 = 4.0;
/// A payload needs 60 and the decoder some more; a chance of 10^-9 and the tests need 25. What is less than sturdy is not worth what it
/// takes from a mark below it.
const NEEDS: Needs = Needs {
    sturdy: 80.0,
    payload: 65.0,
    presence: 35.0,
};

/// Gives the host the mark: by displacements along vertex normals, their RMS at most the host's limit.
pub fn embed(
    host: &Host,
    mark: &Mark,
    progress: &mut dyn Progress,
) -> Result<Embedded, CarrierError> {
    let displacement = Prepared::new(host)?.displacement(host, mark, ROUNDS, progress)?;
    let reached = exponent(host, mark, &displacement);
    step(progress, Stage::Embed, 1.0)?;
    if reached < NEEDS.presence {
        return Err(CarrierError::TooWeak {
            carrier: Carrier::Ring,
            reached,
            needed: NEEDS.presence,
        });
    }
    Ok(Embedded {
        displacement,
        carrier: Carrier::Ring,
        exponent: reached,
        needs: NEEDS,
        chosen: Vec::new(),
    })
}

/// A host, ready for any message under any key: what stays as it is while vertices move a little.
pub struct Prepared {
    pub(super) neighbourhoods: Neighbourhoods,
    by_connectivity: Vec<u64>,
    /// Which vertices are instances of one.
    pub(super) instances: Vec<u32>,
    kind: AddressKind,
}

impl Prepared {
    /// Looks at a host.
    ///
    /// # Errors
    /// Where it has too few addresses.
    pub fn new(host: &Host) -> Result<Prepared, CarrierError> {
        let positions = &host.mesh.positions;
        let neighbourhoods = Neighbourhoods::new(host.mesh);
        let features = Features::new(positions, &neighbourhoods);
        let by_connectivity = address::by_connectivity(&neighbourhoods.rings);
        let by_geometry = address::by_geometry(positions, &neighbourhoods, &features);
        let instances = host.admissible.instances(positions.len());
        let (kind, available) = address::choose(
            host.mesh,
            &by_connectivity,
            &by_geometry,
            &features.usable,
            &instances,
        );
        // Addresses by position survive nothing that SOLID does not.
        let adds_nothing = host.on_top.is_some() && matches!(kind, AddressKind::Position(_));
        let needed = NEEDS.presence as usize * SHARE as usize;
        if available < needed || adds_nothing {
            return Err(CarrierError::TooFewAddresses {
                carrier: Carrier::Ring,
                needed,
                available,
                vertices: positions.len(),
            });
        }
        Ok(Prepared {
            neighbourhoods,
            by_connectivity,
            instances,
            kind,
        })
    }

    /// The displacement that gives the host, or one whose vertices are a little elsewhere, a mark.
    pub fn again(&self, host: &Host, mark: &Mark, is_thorough: bool) -> Vec<DVec3> {
        let rounds = if is_thorough { ROUNDS } else { ROUNDS_AGAIN };
        let displacement = self.displacement(host, mark, rounds, &mut ignore);
        displacement.unwrap_or_default() // what ignores progress is not cancelled
    }

    /// What a key reads of a mesh that differs from the host in a little displacement: no other kind of address is looked at.
    pub fn read(&self, mesh: &Mesh, key: &Key) -> Reading {
        let positions = &mesh.positions;
        let features = Features::new(positions, &self.neighbourhoods);
        match self.kind {
            AddressKind::Connectivity => read_at(&features, &self.by_connectivity, key),
            AddressKind::Geometry => {
                let addresses = address::by_geometry(positions, &self.neighbourhoods, &features);
                read_at(&features, &addresses, key)
            }
            AddressKind::Position(_) => Measurement::new(mesh).read(key),
        }
    }

    /// The addresses of the V rings of a mesh that differs from the host in a little displacement.
    pub(super) fn addresses(
        &self,
        mesh: &Mesh,
        features: &Features,
        host: Option<&Pose>,
    ) -> Cow<'_, [u64]> {
        match self.kind {
            AddressKind::Connectivity => Cow::Borrowed(&self.by_connectivity),
            AddressKind::Geometry => {
                let positions = &mesh.positions;
                address::by_geometry(positions, &self.neighbourhoods, features).into()
            }
            AddressKind::Position(turn) => by_position(mesh, host, turn).into(),
        }
    }

    fn displacement(
        &self,
        host: &Host,
        mark: &Mark,
        rounds: usize,
        progress: &mut dyn Progress,
    ) -> Result<Vec<DVec3>, Cancelled> {
        let positions = &host.mesh.positions;
        let neighbourhoods = &self.neighbourhoods;
        let features = Features::new(positions, neighbourhoods);
        let normals = vertex_normals(host.mesh);
        let pose = Pose::of(host.mesh);
        let limits = match host.on_top {
            Some(limits) => Cow::Borrowed(limits),
            None => Cow::Owned(vec![host.rms_rel * diagonal(positions); positions.len()]),
        };
        let ownership = Ownership::of(mark.key);
        let linear = Linearization::new(neighbourhoods, features, &normals, &host.admissible.fixed);
        let mut displacement = vec![DVec3::ZERO; positions.len()];
        for round in 0..rounds {
            step(progress, Stage::Embed, round as f64 / rounds as f64)?;
            let moved = positions.iter().zip(&displacement);
            let moved = host
                .mesh
                .with_positions(moved.map(|(p, d)| *p + *d).collect());
            let now = Features::new(&moved.positions, neighbourhoods);
            let addresses = self.addresses(&moved, &now, pose.as_ref());
            let along: Vec<f64> = displacement
                .iter()
                .zip(&normals)
                .map(|(d, n)| d.dot(*n))
                .collect();
            let carriers = address::carriers(&addresses, &now.usable, &self.instances);
            let goals = carriers.into_iter().filter_map(|vertex| {
                let vertex = vertex as usize;
                let owned = ownership.get(addresses[vertex])?;
                Some(linear.goal(vertex, now.offsets[vertex], &owned, mark, &along))
            });
            let solution = linear.solve(&goals.collect::<Vec<_>>());
            displacement = (solution.iter().zip(&normals).zip(&*limits))
                .map(|((length, normal), limit)| {
                    *normal * length.clamp(-CLAMP * limit, CLAMP * limit)
                })
                .collect();
            host.admissible.project(&mut displacement);
            scale_to_rms(&mut displacement, &limits);
            host.leeway
                .keep(positions, &mut displacement, host.admissible);
        }
        Ok(displacement)
    }
}

/// What a detector reads.
fn exponent(host: &Host, mark: &Mark, displacement: &[DVec3]) -> f64 {
    let moved = host.mesh.positions.iter().zip(displacement);
    let marked = host
        .mesh
        .with_positions(moved.map(|(p, d)| *p + *d).collect());
    let reading = Measurement::new(&marked).read(mark.key);
    reading.exponent(mark.codeword)
}

/// Addresses by position, in the mesh's own frame with its axes as they were in the host's.
fn by_position(mesh: &Mesh, host: Option<&Pose>, turn: Turn) -> Vec<u64> {
    let pose = Pose::of(mesh)
        .zip(host)
        .map(|(pose, host)| pose.aligned_with(host));
    let cells = pose.map_or(Vec::new(), |pose| address::cells(&mesh.positions, &pose));
    cells
        .into_iter()
        .map(|cell| address::by_position(cell, turn))
        .collect()
}

/// Makes all shorter alike where the RMS, each vertex measured by its limit, is beyond it.
fn scale_to_rms(displacement: &mut [DVec3], limits: &[f64]) {
    let largest = limits.iter().copied().fold(0.0, f64::max);
    let square = |(d, limit): (&DVec3, &f64)| {
        let times = largest / limit;
        d.length_squared() * (times * times)
    };
    let squares: f64 = displacement.iter().zip(limits).map(square).sum();
    let scale = largest / (squares / displacement.len() as f64).sqrt();
    if scale < 1.0 {
        displacement.iter_mut().for_each(|d| *d *= scale);
    }
}

/// How features answer to displacements along vertex normals, at the host's positions: ring i's feature changes by
/// `(x_i - mean over neighbours j of x_j (n_j . ring normal i)) / l_i`. Unknowns are in units of the ring sizes.
struct Linearization<'a> {
    neighbourhoods: &'a Neighbourhoods,
    features: Features,
    normals: &'a [DVec3],
    /// Unit of each unknown, in scene units: the ring's size; 0 for a vertex that cannot move.
    units: Vec<f64>,
}

/// What one ring is to become: its feature's change from the host's, in the linear model, and how much that matters.
struct Goal {
    vertex: usize,
    change: f64,
    weight: f64,
}

impl<'a> Linearization<'a> {
    fn new(
        neighbourhoods: &'a Neighbourhoods,
        features: Features,
        normals: &'a [DVec3],
        fixed: &[u32],
    ) -> Self {
        let mut units = features.sizes.clone();
        fixed
            .iter()
            .for_each(|&vertex| units[vertex as usize] = 0.0);
        Linearization {
            neighbourhoods,
            features,
            normals,
            units,
        }
    }

    /// (vertex, coefficient) of the displacements, in scene units, that move one ring's feature.
    fn row(&self, vertex: usize) -> impl Iterator<Item = (usize, f64)> {
        let neighbours = self.neighbourhoods.rings.neighbours(vertex);
        let (own, size) = (self.features.normals[vertex], self.features.sizes[vertex]);
        let share = 1.0 / (neighbours.len() as f64 * size);
        let others = neighbours
            .iter()
            .map(move |&n| (n as usize, -share * self.normals[n as usize].dot(own)));
        std::iter::once((vertex, 1.0 / size)).chain(others)
    }

    /// The nearest point of the symbol's lattice, seen from the feature's present value.
    fn goal(&self, vertex: usize, offset: f64, owned: &Owned, mark: &Mark, along: &[f64]) -> Goal {
        let coset = if mark.codeword.sign(owned.symbol) > 0.0 {
            0.0
        } else {
            0.5
        };
        let phase = offset / STEP + owned.dither - coset;
        let error = phase.round() - phase;
        let reached: f64 = self
            .row(vertex)
            .map(|(v, coefficient)| coefficient * along[v])
            .sum();
        Goal {
            vertex,
            change: reached + error * STEP,
            weight: curvature(error).max(LEAST_WEIGHT),
        }
    }

    /// Displacements along the normals, in scene units: minimises the weighted squared distance to the goals plus the
    /// ridge, by conjugate gradients on the normal equations.
    fn solve(&self, goals: &[Goal]) -> Vec<f64> {
        let rows = SparseRows::new(goals.iter().map(|goal| {
            self.row(goal.vertex)
                .map(|(v, coefficient)| (v, coefficient * self.units[v]))
        }));
        let weighted = |values: &mut dyn Iterator<Item = f64>| {
            let weights = goals.iter().map(|goal| goal.weight);
            rows.transposed(
                weights.zip(values).map(|(weight, value)| weight * value),
                self.units.len(),
            )
        };
        let normal = |x: &[f64]| {
            let mut y = weighted(&mut rows.times(x));
            y.iter_mut().zip(x).for_each(|(y, x)| *y += RIDGE * x);
            y
        };
        let target = weighted(&mut goals.iter().map(|goal| goal.change));
        let mut scaled = vec![0.0; target.len()];
        conjugate_gradients(
            normal,
            unconditioned,
            &target,
            &mut scaled,
            CG_TOLERANCE,
            CG_STEPS,
        );
        scaled
            .iter()
            .zip(&self.units)
            .map(|(x, unit)| x * unit)
            .collect()
    }
}

/// A sparse matrix by rows.
struct SparseRows {
    ends: Vec<usize>,
    entries: Vec<(u32, f64)>,
}

impl SparseRows {
    fn new(rows: impl Iterator<Item = impl Iterator<Item = (usize, f64)>>) -> SparseRows {
        let (mut ends, mut entries) = (Vec::new(), Vec::new());
        for row in rows {
            entries.extend(row.map(|(column, value)| (column as u32, value)));
            ends.push(entries.len());
        }
        SparseRows { ends, entries }
    }

    fn rows(&self) -> impl Iterator<Item = &[(u32, f64)]> {
        self.ends.iter().scan(0, |start, &end| {
            let row = &self.entries[*start..end];
            *start = end;
            Some(row)
        })
    }

    fn times(&self, x: &[f64]) -> impl Iterator<Item = f64> {
        self.rows().map(|row| {
            row.iter()
                .map(|&(column, value)| value * x[column as usize])
                .sum()
        })
    }

    fn transposed(&self, y: impl Iterator<Item = f64>, num_columns: usize) -> Vec<f64> {
        let mut sums = vec![0.0; num_columns];
        for (row, y) in self.rows().zip(y) {
            row.iter()
                .for_each(|&(column, value)| sums[column as usize] += value * y);
        }
        sums
    }
}
