//! What RING measures of a suspect without a key, and how a key reads it.

use super::address::{self, AddressKind};
use super::feature::{Features, Neighbourhoods};
use super::{Ownership, STEP};
use crate::carrier::Hypothesis;
use crate::code::SoftSymbol;
use crate::key::Key;
use crate::mesh::Mesh;
use std::f64::consts::TAU;

/// Only rings with a smaller feature are read: one hypothesis each. Affine maps leave the flat rings as they are.
const CUTS: [f32; 3] = [f32::INFINITY, 0.12, 0.04];

/// The largest weight of an address. Without a limit the few addresses that thousands of rings share (a vertex of valence 6
/// among its like) outweigh all others: ln p of the bunny is -1640 to -2800, as the key owns them or not; with it, -3550.
const LIMIT: f64 = 2.0;

/// Key-free measurement of a mesh: the features of its rings by address.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Sorted, so that the order of vertices in a file leaves no trace.
    samples: Vec<Sample>,
    /// For each kind of address and each cut, the rings summed by address, addresses ascending.
    sums: Vec<Vec<Sum>>,
}

/// One ring.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    by_connectivity: u64,
    by_geometry: u64,
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
        let (_, num_addresses) = address::choose(&by_connectivity, &by_geometry, &features.usable);
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
        let samples = features.usable.iter().map(|&v| v as usize).map(|v| Sample {
            by_connectivity: by_connectivity[v],
            by_geometry: by_geometry[v],
            offset: features.offsets[v] as f32,
        });
        Measurement::from_samples(samples.collect())
    }

    fn from_samples(mut samples: Vec<Sample>) -> Measurement {
        let rank = |s: &Sample| (s.by_connectivity, s.by_geometry, s.offset.to_bits());
        samples.sort_unstable_by_key(rank);
        let sums = AddressKind::ALL
            .into_iter()
            .flat_map(|kind| sums(&samples, kind))
            .collect();
        Measurement { samples, sums }
    }

    /// The soft symbols of a key, one list for each kind of address and each cut: six hypotheses.
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
    const SAMPLE_BYTES: usize = 20;

    /// The measurement as bytes: 20 for each ring.
    pub fn to_bytes(&self) -> Vec<u8> {
        let encode = |s: &Sample| {
            let mut bytes = [0; Self::SAMPLE_BYTES];
            bytes[..8].copy_from_slice(&s.by_connectivity.to_le_bytes());
            bytes[8..16].copy_from_slice(&s.by_geometry.to_le_bytes());
            bytes[16..].copy_from_slice(&s.offset.to_le_bytes());
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
                let offset = f32::from_le_bytes(rest.try_into().ok()?);
                offset.is_finite().then(|| Sample {
                    by_connectivity: u64::from_le_bytes(*by_connectivity),
                    by_geometry: u64::from_le_bytes(*by_geometry),
                    offset,
                })
            })
            .collect();
        rest.is_empty()
            .then(|| samples.map(Measurement::from_samples))
            .flatten()
    }
}

/// The sums by address of one kind, for each cut.
fn sums(samples: &[Sample], kind: AddressKind) -> Vec<Vec<Sum>> {
    let mut rings: Vec<(u64, f32, f64, f64)> = samples
        .iter()
        .map(|sample| {
            let phase = TAU * f64::from(sample.offset) / STEP;
            let address = match kind {
                AddressKind::Connectivity => sample.by_connectivity,
                AddressKind::Geometry => sample.by_geometry,
            };
            (address, sample.offset, libm::cos(phase), libm::sin(phase))
        })
        .collect();
    rings.sort_unstable_by_key(|&(address, offset, ..)| (address, offset.to_bits()));
    let below = |cut: f32| {
        rings
            .chunk_by(|a, b| a.0 == b.0)
            .filter_map(|group| {
                let (count, re, im) = group
                    .iter()
                    .filter(|(_, offset, ..)| offset.abs() < cut)
                    .fold((0, 0.0, 0.0), |(count, re, im), ring| {
                        (count + 1, re + ring.2, im + ring.3)
                    });
                let length = libm::hypot(re, im);
                let scale = (LIMIT / length).min(1.0 / f64::from(count).sqrt());
                (count > 0).then_some(Sum {
                    address: group[0].0,
                    re: re * scale,
                    im: im * scale,
                })
            })
            .collect()
    };
    CUTS.map(below).into()
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
