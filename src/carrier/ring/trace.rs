//! What anybody sees of rings without a key, and what marks would show there: rings that share an address, and so a dither, agree at the
//! step.

use super::STEP;
use super::address::{self, Turn};
use super::feature::{Features, Neighbourhoods};
use crate::geometry::Pose;
use crate::mesh::Mesh;
use crate::order::order_by;
use glam::DVec3;
use std::f64::consts::TAU;

/// Other steps, in units of STEP, at which nothing was embedded: features that are alike by nature agree at them too.
const OTHERS: [f64; 4] = [0.75, 0.875, 1.125, 1.25];

/// What anybody sees of a ring.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    /// The vertex in its middle.
    pub vertex: u32,
    /// Its address by connectivity.
    pub by_connectivity: u64,
    /// The feature.
    pub offset: f64,
    /// The displacement of the vertex that adds 1 to it.
    pub direction: DVec3,
}

/// The rings of a mesh.
pub fn rings(mesh: &Mesh) -> Vec<Ring> {
    let neighbourhoods = Neighbourhoods::new(mesh);
    let features = Features::new(&mesh.positions, &neighbourhoods);
    let by_connectivity = address::by_connectivity(&neighbourhoods.rings);
    let ring = |&vertex: &u32| {
        let v = vertex as usize;
        Ring {
            vertex,
            by_connectivity: by_connectivity[v],
            offset: features.offsets[v],
            direction: features.normals[v] * features.sizes[v],
        }
    };
    features.usable.iter().map(ring).collect()
}

/// How much better rings of one address agree at the step than at others, in standard deviations of independent phases; of the
/// kind of address (by connectivity, by geometry, by position) that shows most. About 0 of a mesh that nobody marked.
pub fn trace(mesh: &Mesh) -> f64 {
    let neighbourhoods = Neighbourhoods::new(mesh);
    let features = Features::new(&mesh.positions, &neighbourhoods);
    let by_position = Pose::of(mesh).map(|pose| {
        let cells = address::cells(&mesh.positions, &pose).into_iter();
        cells
            .map(|cell| address::by_position(cell, Turn::None))
            .collect()
    });
    let kinds = [
        Some(address::by_connectivity(&neighbourhoods.rings)),
        Some(address::by_geometry(
            &mesh.positions,
            &neighbourhoods,
            &features,
        )),
        by_position,
    ];
    let stand_out = kinds.iter().flatten().map(|addresses: &Vec<u64>| {
        let agreement = |step: f64| agreement(addresses, &features, step);
        let others = OTHERS.map(|other| agreement(other * STEP));
        agreement(STEP) - others.into_iter().fold(0.0, f64::max)
    });
    stand_out.fold(0.0, f64::max)
}

/// Sum over addresses of |Z|^2 - n, with Z the sum of the phasors of n rings, over its standard deviation for independent phases, the
/// root of the sum of n (n - 1).
fn agreement(addresses: &[u64], features: &Features, step: f64) -> f64 {
    let usable = &features.usable;
    let order = order_by(usable.iter().map(|&vertex| addresses[vertex as usize]));
    let (mut excess, mut variance) = (0.0, 0.0);
    for group in order.chunk_by(|a, b| a.0 == b.0) {
        let phases = group
            .iter()
            .map(|&(_, index)| TAU * features.offsets[usable[index as usize] as usize] / step);
        let (re, im) = phases.fold((0.0, 0.0), |(re, im), phase| {
            (re + libm::cos(phase), im + libm::sin(phase))
        });
        let count = group.len() as f64;
        excess += re * re + im * im - count;
        variance += count * (count - 1.0);
    }
    if variance > 0.0 {
        excess / variance.sqrt()
    } else {
        0.0
    }
}
