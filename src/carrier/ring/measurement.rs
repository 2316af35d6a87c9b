//! What RING measures of a suspect without a key, and how a key reads it.

use super::address::{self, Cell, FARTHEST_CELL, Turn};
use super::feature::{Features, Neighbourhoods};
use super::{Ownership, STEP};
use crate::carrier::{Hypothesis, Reading, StoredError, possible, take};
use crate::code::SoftSymbol;
use crate::geometry::Pose;
use crate::key::Key;
use crate::mesh::Mesh;
use crate::order::{order_by, order_by_words};
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

impl Sample {
    /// What samples are sorted by: equal for equal samples only.
    fn rank(&self) -> [u64; 4] {
        // Without the sign bit turned over, negative numbers would follow the others.
        let cell = self
            .cell
            .map(|number| u64::from(number as u16 ^ 0x8000))
            .into_iter()
            .fold(0, |cell, number| cell << 16 | number);
        let offset = u64::from(self.offset.to_bits());
        [self.by_connectivity, self.by_geometry, cell, offset]
    }
}

impl Sample {
    /// Takes a ring from the beginning of bytes.
    fn read(bytes: &mut &[u8]) -> Result<Sample, StoredError> {
        let by_connectivity = u64::from_le_bytes(take(bytes)?);
        let by_geometry = u64::from_le_bytes(take(bytes)?);
        let mut number = || Ok(i16::from_le_bytes(take(bytes)?));
        let cell: Cell = [number()?, number()?, number()?];
        let offset = f32::from_le_bytes(take(bytes)?);
        let range = -FARTHEST_CELL..=FARTHEST_CELL;
        possible(
            cell.iter().all(|number| range.contains(number)),
            "a ring in a cell beyond the last",
        )?;
        possible(offset.is_finite(), "a ring whose offset is no number")?;
        Ok(Sample {
            by_connectivity,
            by_geometry,
            cell,
            offset,
        })
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

impl Measurement {
    /// Measures a mesh.
    pub fn new(mesh: &Mesh) -> Measurement {
        Measurement::from_samples(samples(mesh))
    }

    fn from_samples(samples: Vec<Sample>) -> Measurement {
        let ranks: Vec<[u64; 4]> = samples.iter().map(Sample::rank).collect();
        let order = order_by_words(&ranks).into_iter();
        let samples: Vec<Sample> = order.map(|index| samples[index as usize]).collect();
        let sums = sums(&samples);
        Measurement { samples, sums }
    }

    /// The soft symbols of a key, one list for each of ten hypotheses: two kinds of address and three
    /// cuts, and four turns of the frame.
    pub fn read(&self, key: &Key) -> Reading {
        let ownership = Ownership::of(key);
        let read = |sums: &Vec<Sum>| Hypothesis {
            symbols: sums.iter().filter_map(|sum| sum.read(&ownership)).collect(),
            ln_num_tests: libm::log(self.sums.len() as f64),
            piece: 0,
        };
        let hypotheses: Vec<Hypothesis> = self.sums.iter().map(read).collect();
        Reading {
            hypotheses,
            num_addresses: self.sums.iter().map(Vec::len).max().unwrap_or(0),
        }
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

    /// A measurement from its bytes.
    ///
    /// # Errors
    /// Where they are none, or hold numbers that no ring gives.
    pub fn from_bytes(mut bytes: &[u8]) -> Result<Measurement, StoredError> {
        let mut samples = Vec::with_capacity(bytes.len() / Self::SAMPLE_BYTES);
        while !bytes.is_empty() {
            samples.push(Sample::read(&mut bytes)?);
        }
        Ok(Measurement::from_samples(samples))
    }
}

/// What a key reads of rings at addresses of one kind, which are known: as if all had been measured, and the others said nothing.
pub fn read_at(features: &Features, addresses: &[u64], key: &Key) -> Reading {
    let sample = |&v: &u32| Sample {
        by_connectivity: addresses[v as usize],
        by_geometry: 0,
        cell: [0; 3],
        offset: features.offsets[v as usize] as f32,
    };
    let samples: Vec<Sample> = features.usable.iter().map(sample).collect();
    let phasors: Vec<Phasor> = samples.iter().map(Phasor::new).collect();
    let rings = Rings {
        samples: &samples,
        phasors: &phasors,
    };
    let sums = rings.sums(
        &rings.groups(|sample| sample.by_connectivity),
        f32::INFINITY,
    );
    let ownership = Ownership::of(key);
    Reading {
        num_addresses: sums.len(),
        hypotheses: vec![Hypothesis {
            symbols: sums.iter().filter_map(|sum| sum.read(&ownership)).collect(),
            ln_num_tests: libm::log(NUM_HYPOTHESES as f64),
            piece: 0,
        }],
    }
}

/// Two kinds of address in all cuts, and all turns of the frame.
const NUM_HYPOTHESES: usize = 2 * CUTS.len() + Turn::ALL.len();

/// All rings of a mesh.
fn samples(mesh: &Mesh) -> Vec<Sample> {
    let neighbourhoods = Neighbourhoods::new(mesh);
    let features = Features::new(&mesh.positions, &neighbourhoods);
    let by_connectivity = address::by_connectivity(&neighbourhoods.rings);
    let by_geometry = address::by_geometry(&mesh.positions, &neighbourhoods, &features);
    let cells = match Pose::of(mesh) {
        Some(pose) => address::cells(&mesh.positions, &pose),
        None => vec![[0; 3]; mesh.positions.len()],
    };
    let sample = |v: usize| Sample {
        by_connectivity: by_connectivity[v],
        by_geometry: by_geometry[v],
        cell: cells[v],
        offset: features.offsets[v] as f32,
    };
    let usable = features.usable.iter();
    usable.map(|&v| sample(v as usize)).collect()
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
    let by_connectivity = CUTS.map(|cut| rings.sums(&connectivity, cut));
    let by_geometry = CUTS.map(|cut| rings.sums(&geometry, cut));
    let by_position = Turn::ALL.map(|turn| {
        let position = rings.groups(|sample| address::by_position(sample.cell, turn));
        rings.sums(&position, f32::INFINITY)
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
    /// The samples by their addresses, ascending.
    fn groups(&self, address: impl Fn(&Sample) -> u64) -> Vec<(u64, u32)> {
        order_by(self.samples.iter().map(address))
    }

    /// One sum for each address that has rings with a feature below the cut. Addresses are hashes, and a suspect may be made
    /// so that different cells have one: equal addresses share a dither, so they are one term.
    fn sums(&self, groups: &[(u64, u32)], cut: f32) -> Vec<Sum> {
        let sum = |group: &[(u64, u32)]| {
            let indices = group.iter().map(|&(_, index)| index as usize);
            let below = indices.filter(|&index| self.samples[index].offset.abs() < cut);
            let (count, re, im) = below
                .map(|index| &self.phasors[index])
                .fold((0, 0.0, 0.0), |(count, re, im), phasor| {
                    (count + 1, re + phasor.re, im + phasor.im)
                });
            let scale = (LIMIT / libm::hypot(re, im)).min(1.0 / f64::from(count).sqrt());
            (count > 0).then(|| Sum {
                address: group[0].0,
                re: re * scale,
                im: im * scale,
            })
        };
        groups.chunk_by(|a, b| a.0 == b.0).filter_map(sum).collect()
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
