//! What RING measures of a suspect without a key, and how a key reads it.

use super::address::{self, Cell, Turn};
use super::feature::{Features, Neighbourhoods};
use super::{Ownership, STEP};
use crate::carrier::Hypothesis;
use crate::code::SoftSymbol;
use crate::geometry::Pose;
use crate::key::Key;
use crate::mesh::Mesh;
use std::f64::consts::TAU;

/// Only rings with a smaller feature are read: one hypothesis each. Affine maps leave the flat rings as they are, but not
/// the frame that positions are seen in.
const CUTS: [f32; 3] = [f32::INFINITY, 0.12, 0.04];

/// The largest weight of an address. Without a limit the few addresses that thousands of rings share (a vertex of valence 6
/// among its like) outweigh all others: ln p of the bunny is -1640 to -2800, as the key owns them or not; with it, -3550.
const LIMIT: f64 = 2.0;

/// Key-free measurement of a mesh: the features of its rings by address.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Sorted, so that the order of vertices in a file leaves no trace.
    samples: Vec<Sample>,
    /// For each hypothesis, the rings summed by address, addresses ascending.
    sums: Vec<Vec<Sum>>,
}

/// One ring.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    by_connectivity: u64,
    by_geometry: u64,
    cell: Cell,
    offset: f32,
}

/// All rings of one address: the sum of `exp(2 pi i f / STEP)`, divided by the square root of their number, its length at
/// most [`LIMIT`]. The rings of one address share its dither, so this sum, not the single ring, is what the bound counts.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sum {
    address: u64,
    re: f64,
    im: f64,
}

/// What RING could hold in a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// Distinct addresses of the kind that the embedder would take.
    pub num_addresses: usize,
    /// Vertices that could carry a symbol.
    pub num_rings: usize,
}

impl Capacity {
    /// The capacity of a mesh.
    pub fn of(mesh: &Mesh) -> Capacity {
        let neighbourhoods = Neighbourhoods::new(mesh);
        let features = Features::new(&mesh.positions, &neighbourhoods);
        let by_connectivity = address::by_connectivity(&neighbourhoods.rings);
        let by_geometry = address::by_geometry(&mesh.positions, &neighbourhoods, &features);
        let (_, num_addresses) =
            address::choose(mesh, &by_connectivity, &by_geometry, &features.usable);
        Capacity {
            num_addresses,
            num_rings: features.usable.len(),
        }
    }
}

impl Measurement {
    /// Measures a mesh.
    pub fn new(mesh: &Mesh) -> Measurement {
        let neighbourhoods = Neighbourhoods::new(mesh);
        let features = Features::new(&mesh.positions, &neighbourhoods);
        let by_connectivity = address::by_connectivity(&neighbourhoods.rings);
        let by_geometry = address::by_geometry(&mesh.positions, &neighbourhoods, &features);
        let cells = match Pose::of(mesh) {
            Some(pose) => address::cells(&mesh.positions, &pose),
            None => vec![[0; 3]; mesh.positions.len()],
        };
        let samples = features.usable.iter().map(|&v| v as usize).map(|v| Sample {
            by_connectivity: by_connectivity[v],
            by_geometry: by_geometry[v],
            cell: cells[v],
            offset: features.offsets[v] as f32,
        });
        Measurement::from_samples(samples.collect())
    }

    fn from_samples(mut samples: Vec<Sample>) -> Measurement {
        let rank = |s: &Sample| (s.by_connectivity, s.by_geometry, s.cell, s.offset.to_bits());
        samples.sort_unstable_by_key(rank);
        let sums = sums(&samples);
        Measurement { samples, sums }
    }

    /// The soft symbols of a key, one list for each of ten hypotheses: two kinds of address and three
    /// cuts, and four turns of the frame.
    pub fn read(&self, key: &Key) -> Vec<Hypothesis> {
        let ownership = Ownership::of(key);
        self.sums
            .iter()
            .map(|sums| Hypothesis {
                symbols: sums.iter().filter_map(|sum| sum.read(&ownership)).collect(),
                num_addresses: sums.len(),
            })
            .collect()
    }

    /// Bytes in a stored ring.
    const SAMPLE_BYTES: usize = 26;

    /// The measurement as bytes: 26 for each ring.
    pub fn to_bytes(&self) -> Vec<u8> {
        let encode = |s: &Sample| {
            let mut bytes = [0; Self::SAMPLE_BYTES];
            bytes[..8].copy_from_slice(&s.by_connectivity.to_le_bytes());
            bytes[8..16].copy_from_slice(&s.by_geometry.to_le_bytes());
            for (slot, number) in bytes[16..22].chunks_exact_mut(2).zip(s.cell) {
                slot.copy_from_slice(&number.to_le_bytes());
            }
            bytes[22..].copy_from_slice(&s.offset.to_le_bytes());
            bytes
        };
        self.samples.iter().flat_map(encode).collect()
    }

    /// A measurement from its bytes; `None` if they are not such.
    pub fn from_bytes(bytes: &[u8]) -> Option<Measurement> {
        let (samples, rest) = bytes.as_chunks::<{ Self::SAMPLE_BYTES }>();
        let samples: Option<Vec<Sample>> = samples
            .iter()
            .map(|bytes| {
                let (by_connectivity, rest) = bytes.split_first_chunk()?;
                let (by_geometry, rest) = rest.split_first_chunk()?;
                let (numbers, rest) = rest.split_first_chunk::<6>()?;
                let number = |i: usize| i16::from_le_bytes([numbers[2 * i], numbers[2 * i + 1]]);
                let offset = f32::from_le_bytes(rest.try_into().ok()?);
                offset.is_finite().then(|| Sample {
                    by_connectivity: u64::from_le_bytes(*by_connectivity),
                    by_geometry: u64::from_le_bytes(*by_geometry),
                    cell: [number(0), number(1), number(2)],
                    offset,
                })
            })
            .collect();
        rest.is_empty()
            .then(|| samples.map(Measurement::from_samples))
            .flatten()
    }
}

/// `exp(2 pi i f / STEP)` of a ring's feature.
struct Phasor {
    re: f64,
    im: f64,
}

impl Phasor {
    fn new(sample: &Sample) -> Phasor {
        let phase = TAU * f64::from(sample.offset) / STEP;
        Phasor {
            re: libm::cos(phase),
            im: libm::sin(phase),
        }
    }
}

/// The sums of all hypotheses: by connectivity and by geometry for each cut, by position for each turn. Samples are in a
/// canonical order, and so are the terms of each sum.
fn sums(samples: &[Sample]) -> Vec<Vec<Sum>> {
    let phasors: Vec<Phasor> = samples.iter().map(Phasor::new).collect();
    let rings = Rings {
        samples,
        phasors: &phasors,
    };
    let connectivity = rings.groups(|sample| sample.by_connectivity);
    let geometry = rings.groups(|sample| sample.by_geometry);
    let position = rings.groups(|sample| sample.cell);
    let by_connectivity =
        CUTS.map(|cut| rings.sums(&connectivity, cut, |sample| sample.by_connectivity));
    let by_geometry = CUTS.map(|cut| rings.sums(&geometry, cut, |sample| sample.by_geometry));
    let by_position = Turn::ALL.map(|turn| {
        rings.sums(&position, f32::INFINITY, |sample| {
            address::by_position(sample.cell, turn)
        })
    });
    by_connectivity
        .into_iter()
        .chain(by_geometry)
        .chain(by_position)
        .collect()
}

struct Rings<'a> {
    samples: &'a [Sample],
    phasors: &'a [Phasor],
}

impl Rings<'_> {
    /// The samples in groups of an equal key.
    fn groups<K: Ord>(&self, key: impl Fn(&Sample) -> K) -> Groups {
        let mut order: Vec<usize> = (0..self.samples.len()).collect();
        order.sort_by_key(|&index| key(&self.samples[index]));
        let same = |&a: &usize, &b: &usize| key(&self.samples[a]) == key(&self.samples[b]);
        let sizes = order.chunk_by(same).map(<[usize]>::len).collect();
        Groups { order, sizes }
    }

    /// One sum for each group that has rings with a feature below the cut.
    fn sums(&self, groups: &Groups, cut: f32, address: impl Fn(&Sample) -> u64) -> Vec<Sum> {
        let sum = |group: &[usize]| {
            let below = group
                .iter()
                .filter(|&&index| self.samples[index].offset.abs() < cut);
            let (count, re, im) = below
                .map(|&index| &self.phasors[index])
                .fold((0, 0.0, 0.0), |(count, re, im), phasor| {
                    (count + 1, re + phasor.re, im + phasor.im)
                });
            let scale = (LIMIT / libm::hypot(re, im)).min(1.0 / f64::from(count).sqrt());
            (count > 0).then(|| Sum {
                address: address(&self.samples[group[0]]),
                re: re * scale,
                im: im * scale,
            })
        };
        groups.iter().filter_map(sum).collect()
    }
}

/// Indices of samples in the order of a key, and how many of them have each of its values.
struct Groups {
    order: Vec<usize>,
    sizes: Vec<usize>,
}

impl Groups {
    fn iter(&self) -> impl Iterator<Item = &[usize]> {
        self.sizes
            .iter()
            .scan(self.order.as_slice(), |rest, &size| {
                let (group, after) = rest.split_at(size);
                *rest = after;
                Some(group)
            })
    }
}

impl Sum {
    fn read(&self, ownership: &Ownership) -> Option<SoftSymbol> {
        let owned = ownership.get(self.address)?;
        let phase = TAU * owned.dither;
        Some(SoftSymbol {
            symbol: owned.symbol,
            value: self.re * libm::cos(phase) - self.im * libm::sin(phase),
            weight: libm::hypot(self.re, self.im),
        })
    }
}
