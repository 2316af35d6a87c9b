//! The statistic: the windowed flux of the oriented surface at the points of a lattice, a band-passed occupancy field.
//!
//! It is an integral over the surface, so tessellation drops out. With q = |y - L| / R < 1 about a lattice point L,
//! `F = integral of (1 - q^2)^2 (y - L) . dA`; a displacement d of the surface changes it by `integral of g d . dA` with
//! `g = (1 - q^2)(3 - 7 q^2)`. The surface is first gathered in small cells, each kept as a centroid, an area vector and the
//! first moment `m = sum (y - centroid) . a`: one evaluation then costs a few operations for each cell and window.

use super::{PITCH, RADIUS};
use crate::geometry::{Pose, samples};
use crate::mesh::Mesh;
use crate::order::order_by;
use glam::{DMat3, DVec3};

/// Cells are so many times smaller than the lattice's pitch.
const CELLS_PER_PITCH: f64 = 5.0;
/// What lies further from the centre, in units of the frame, is left out: it has no neighbours to make windows with.
const EXTENT: f64 = 8.0;

/// A small piece of surface, in the canonical frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// Area-weighted centroid.
    pub centre: DVec3,
    /// Sum of area vectors.
    pub area: DVec3,
    /// Sum of `(y - centre) . a`.
    pub moment: f64,
    /// Sum of areas.
    pub weight: f64,
}

/// Gathers a surface in clusters, in the frame of a pose. The triangles have to face outwards.
pub fn clusters(mesh: &Mesh, pose: &Pose) -> Vec<Cluster> {
    let cell = PITCH / CELLS_PER_PITCH;
    let number = |coordinate: f64| ((coordinate + EXTENT) / cell) as u64;
    let pieces: Vec<(DVec3, DVec3)> = samples(mesh, PITCH * pose.size / 3.0)
        .into_iter()
        .map(|sample| {
            (
                pose.canonical(sample.point),
                pose.axes.transpose() * sample.area / (pose.size * pose.size),
            )
        })
        .filter(|(y, _)| y.abs().max_element() < EXTENT)
        .collect();
    let order = order_by(
        pieces
            .iter()
            .map(|(y, _)| number(y.x) << 40 | number(y.y) << 20 | number(y.z)),
    );
    order
        .chunk_by(|a, b| a.0 == b.0)
        .map(|cell| cluster(cell.iter().map(|&(_, piece)| pieces[piece as usize])))
        .collect()
}

fn cluster(pieces: impl Iterator<Item = (DVec3, DVec3)> + Clone) -> Cluster {
    let (mut weight, mut first, mut area, mut count, mut mean) =
        (0.0, DVec3::ZERO, DVec3::ZERO, 0.0, DVec3::ZERO);
    for (y, a) in pieces.clone() {
        let size = a.length();
        weight += size;
        first += y * size;
        area += a;
        mean += y;
        count += 1.0;
    }
    let centre = if weight > 0.0 {
        first / weight
    } else {
        mean / count
    };
    let moment = pieces.map(|(y, a)| (y - centre).dot(a)).sum();
    Cluster {
        centre,
        area,
        moment,
        weight,
    }
}

/// Where a lattice lies in the canonical frame: a point y has lattice coordinates `rotation^T (y - origin) / scale`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    pub rotation: DMat3,
    pub origin: DVec3,
    pub scale: f64,
}

impl Placement {
    /// This placement moved by a small similarity: translation and rotation vector in lattice coordinates, log of the scale.
    pub fn nudged(&self, x: &[f64; 7]) -> Placement {
        Placement {
            rotation: self.rotation * rotation(DVec3::new(x[3], x[4], x[5])),
            origin: self.origin + self.rotation * DVec3::new(x[0], x[1], x[2]) * self.scale,
            scale: self.scale * libm::exp(x[6]),
        }
    }

    /// The lattice coordinates of a point.
    pub fn lattice(&self, y: DVec3) -> DVec3 {
        self.rotation.transpose() * (y - self.origin) / self.scale
    }
}

/// The rotation by a vector's length about its direction.
fn rotation(vector: DVec3) -> DMat3 {
    let angle = vector.length();
    if angle < 1e-12 {
        return DMat3::IDENTITY;
    }
    let half = vector * (libm::sin(0.5 * angle) / angle);
    DMat3::from_quat(glam::DQuat::from_xyzw(
        half.x,
        half.y,
        half.z,
        libm::cos(0.5 * angle),
    ))
}

/// The flux at one lattice point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Index of the lattice point: the point is `PITCH * index`.
    pub index: [i32; 3],
    pub flux: f64,
    /// How much surface the window sees: 0 for too little to be used.
    pub weight: f64,
}

/// The lattice points that a position's windows belong to, with the offset from each and the squared relative distance.
pub fn windows_at(y: DVec3) -> impl Iterator<Item = ([i32; 3], DVec3, f64)> {
    let base = (y / PITCH)
        .floor()
        .to_array()
        .map(|coordinate| coordinate as i32);
    let steps = || -1..=2;
    let indices =
        steps().flat_map(move |i| steps().flat_map(move |j| steps().map(move |k| [i, j, k])));
    indices.filter_map(move |[i, j, k]| {
        let index = [base[0] + i, base[1] + j, base[2] + k];
        let offset = y - DVec3::new(index[0].into(), index[1].into(), index[2].into()) * PITCH;
        let q2 = offset.length_squared() / (RADIUS * RADIUS);
        (q2 < 1.0).then_some((index, offset, q2))
    })
}

/// Sensitivity of a window to a displacement of the surface within it.
pub fn sensitivity(q2: f64) -> f64 {
    (1.0 - q2) * (3.0 - 7.0 * q2)
}

/// Windows that see less than this, in units of the pitch, are not used; from there on the weight grows.
const LEAST_ENERGY: f64 = 0.5;

/// The windows that see enough of the surface, in increasing order of index.
pub fn windows(clusters: &[Cluster], placement: &Placement) -> Vec<Window> {
    let bound = (1.8 * EXTENT / PITCH) as i32 + 4;
    let turned: Vec<(DVec3, DVec3, f64, f64)> = clusters
        .iter()
        .map(|cluster| {
            let area_scale = 1.0 / (placement.scale * placement.scale);
            (
                placement.lattice(cluster.centre),
                placement.rotation.transpose() * cluster.area * area_scale,
                cluster.moment * area_scale / placement.scale,
                cluster.weight * area_scale,
            )
        })
        .collect();
    let inside = |y: DVec3| y.abs().max_element() < f64::from(bound - 3) * PITCH;
    let mut low = [bound; 3];
    let mut high = [-bound; 3];
    for (y, ..) in turned.iter().filter(|(y, ..)| inside(*y)) {
        let base = (*y / PITCH).floor().to_array();
        for axis in 0..3 {
            low[axis] = low[axis].min(base[axis] as i32 - 1);
            high[axis] = high[axis].max(base[axis] as i32 + 2);
        }
    }
    let size = [0, 1, 2].map(|axis| (high[axis] - low[axis] + 1).max(0) as usize);
    let mut field = vec![(0.0, 0.0); size[0] * size[1] * size[2]];
    for &(y, area, moment, weight) in turned.iter().filter(|(y, ..)| inside(*y)) {
        for (index, offset, q2) in windows_at(y) {
            let [i, j, k] = [0, 1, 2].map(|axis| (index[axis] - low[axis]) as usize);
            let (flux, energy) = &mut field[(i * size[1] + j) * size[2] + k];
            let window = (1.0 - q2) * (1.0 - q2);
            let g = sensitivity(q2);
            *flux += window * (offset.dot(area) + moment);
            *energy += weight * g * g;
        }
    }
    let mut windows = Vec::new();
    for (cell, &(flux, energy)) in field.iter().enumerate() {
        let weight = energy.sqrt() / PITCH - LEAST_ENERGY;
        if weight > 0.0 {
            let [i, j, k] = [
                cell / (size[1] * size[2]),
                cell / size[2] % size[1],
                cell % size[2],
            ];
            let index = [low[0] + i as i32, low[1] + j as i32, low[2] + k as i32];
            windows.push(Window {
                index,
                flux,
                weight,
            });
        }
    }
    windows
}
