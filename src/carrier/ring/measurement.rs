//! What RING measures of a suspect without a key, and how a key reads it.

use super::address::{self, AddressKind, Cell, Turn};
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

/// Every way of reading, in a fixed order.
fn hypotheses() -> impl Iterator<Item = (AddressKind, f32)> {
    let local = [AddressKind::Connectivity, AddressKind::Geometry];
    let local = local
        .into_iter()
        .flat_map(|kind| CUTS.map(|cut| (kind, cut)));
    local.chain(Turn::ALL.map(|turn| (AddressKind::Position(turn), f32::INFINITY)))
}

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

impl Sample {
    fn address(&self, kind: AddressKind) -> u64 {
        match kind {
            AddressKind::Connectivity => self.by_connectivity,
            AddressKind::Geometry => self.by_geometry,
            AddressKind::Position(turn) => address::by_position(self.cell, turn),
        }
    }
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
        let phasors: Vec<Phasor> = samples.iter().map(Phasor::new).collect();
        let sums = hypotheses()
            .map(|(kind, cut)| sums(&samples, &phasors, kind, cut))
            .collect();
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

/// The sums by address of one hypothesis. Samples are in a canonical order, and so are the terms of each sum.
fn sums(samples: &[Sample], phasors: &[Phasor], kind: AddressKind, cut: f32) -> Vec<Sum> {
    let below = samples
        .iter()
        .enumerate()
        .filter(|(_, sample)| sample.offset.abs() < cut);
    let mut rings: Vec<(u64, usize)> = below
        .map(|(index, sample)| (sample.address(kind), index))
        .collect();
    rings.sort_unstable();
    rings
        .chunk_by(|a, b| a.0 == b.0)
        .map(|group| {
            let phasors = || group.iter().map(|&(_, index)| &phasors[index]);
            let (re, im) = phasors().fold((0.0, 0.0), |(re, im), p| (re + p.re, im + p.im));
            let length = libm::hypot(re, im);
            let scale = (LIMIT / length).min(1.0 / (group.len() as f64).sqrt());
            Sum {
                address: group[0].0,
                re: re * scale,
                im: im * scale,
            }
        })
        .collect()
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
