//! Clusters in few bytes: rounded far below what a quantizer notices.
//!
//! As bytes: the units of areas and of moments in 4 each, the number of clusters in 4; then the clusters in
//! increasing order of their cells. A cluster: the distance of its cell's number from the one before (LEB128), its centre
//! within the cell in 3 bytes, its area vector in 6, its moment in 2, its weight in 1. All integers are little-endian.

use super::flux::{CELLS_PER_PITCH, Cluster, EXTENT, corner, number};
use glam::DVec3;
use std::f64::consts::LN_2;

/// Steps in a cell's edge.
const OFFSETS: f64 = 256.0;
/// The largest of the rounded areas and moments.
const LARGEST: f64 = 32_767.0;

/// Steps in an octave of weights.
const WEIGHTS: f64 = 16.0;

/// The clusters of a surface, rounded.
#[derive(Clone, Debug, PartialEq)]
pub struct Store {
    /// The pitch that the clusters are fine enough for.
    pub pitch: f64,
    area_unit: f32,
    moment_unit: f32,
    rounded: Vec<Rounded>,
}

/// A cluster in whole numbers.
#[derive(Clone, Debug, PartialEq)]
struct Rounded {
    cell: u64,
    offset: [u8; 3],
    area: [i16; 3],
    moment: i16,
    /// How much lighter than the heaviest possible, in steps of octaves.
    lightness: u8,
}

impl Store {
    /// Rounds clusters that were gathered for a pitch, in increasing order of their cells.
    pub fn new(clusters: &[Cluster], pitch: f64) -> Store {
        let largest = |size: fn(&Cluster) -> f64| clusters.iter().map(size).fold(1e-30, f64::max);
        let unit = |largest: f64| (largest / LARGEST * (1.0 + 1e-6)) as f32;
        let mut store = Store {
            pitch,
            area_unit: unit(largest(|cluster| cluster.weight)),
            // Moving a centre to where it can be stored changes the moment by up to a part in 512 of the area times a cell.
            moment_unit: unit(largest(|cluster| {
                cluster.moment.abs() + 1e-3 * cluster.weight
            })),
            rounded: Vec::new(),
        };
        store.rounded = clusters
            .iter()
            .map(|cluster| store.round(cluster))
            .collect();
        store
    }

    /// The clusters, as near as they could be stored.
    pub fn clusters(&self) -> Vec<Cluster> {
        let area_unit = f64::from(self.area_unit);
        let cluster = |rounded: &Rounded| Cluster {
            centre: self.centre(rounded.cell, rounded.offset),
            area: DVec3::from_array(rounded.area.map(f64::from)) * area_unit,
            moment: f64::from(rounded.moment) * f64::from(self.moment_unit),
            weight: LARGEST
                * area_unit
                * libm::exp(-f64::from(rounded.lightness) * (LN_2 / WEIGHTS)),
        };
        self.rounded.iter().map(cluster).collect()
    }

    fn cell(&self) -> f64 {
        self.pitch / CELLS_PER_PITCH
    }

    fn centre(&self, cell: u64, offset: [u8; 3]) -> DVec3 {
        let within = offset.map(|part| (f64::from(part) + 0.5) / OFFSETS);
        (corner(cell) + DVec3::from_array(within)) * self.cell()
    }

    fn round(&self, cluster: &Cluster) -> Rounded {
        let scaled = cluster.centre / self.cell();
        let cell = scaled.floor();
        let offset = ((scaled - cell) * OFFSETS)
            .to_array()
            .map(|part| part as u8);
        let area = cluster.area / f64::from(self.area_unit);
        // The flux of the piece is to stay what it is, though its centre moves.
        let moved = cluster.centre - self.centre(number(cell), offset);
        let moment = cluster.moment + moved.dot(cluster.area);
        Rounded {
            cell: number(cell),
            offset,
            area: area.to_array().map(|part| part.round() as i16),
            moment: (moment / f64::from(self.moment_unit)).round() as i16,
            lightness: (libm::log(LARGEST * f64::from(self.area_unit) / cluster.weight)
                * (WEIGHTS / LN_2))
                .round() as u8,
        }
    }

    /// Appends the bytes.
    pub fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.area_unit.to_le_bytes());
        bytes.extend(self.moment_unit.to_le_bytes());
        bytes.extend((self.rounded.len() as u32).to_le_bytes());
        let mut last = 0;
        for rounded in &self.rounded {
            let mut gap = rounded.cell - last;
            last = rounded.cell;
            while gap >= 0x80 {
                bytes.push(gap as u8 | 0x80);
                gap >>= 7;
            }
            bytes.push(gap as u8);
            bytes.extend(rounded.offset);
            for number in rounded.area {
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend(rounded.moment.to_le_bytes());
            bytes.push(rounded.lightness);
        }
    }

    /// Takes a store whose clusters are fine enough for a pitch from the beginning of bytes; `None` if they are none.
    pub fn read(bytes: &mut &[u8], pitch: f64) -> Option<Store> {
        let area_unit = f32::from_le_bytes(take(bytes)?);
        let moment_unit = f32::from_le_bytes(take(bytes)?);
        let count = u32::from_le_bytes(take(bytes)?);
        let in_range = |number: f64| number > 0.0 && number < 1e6;
        if !(in_range(area_unit.into()) && in_range(moment_unit.into())) {
            return None;
        }
        let mut rounded = Vec::new();
        let mut cell = 0u64;
        for _ in 0..count {
            let (mut gap, mut shift) = (0u64, 0);
            loop {
                let [byte] = take(bytes)?;
                gap |= u64::from(byte & 0x7f).checked_shl(shift)?;
                shift += 7;
                if byte < 0x80 {
                    break;
                }
            }
            cell = cell.checked_add(gap)?;
            let reach = corner(cell).abs().max_element() * pitch / CELLS_PER_PITCH;
            if reach > EXTENT + pitch {
                return None;
            }
            let offset = take(bytes)?;
            let mut number = || Some(i16::from_le_bytes(take(bytes)?));
            let area = [number()?, number()?, number()?];
            let moment = number()?;
            let [lightness] = take(bytes)?;
            rounded.push(Rounded {
                cell,
                offset,
                area,
                moment,
                lightness,
            });
        }
        Some(Store {
            pitch,
            area_unit,
            moment_unit,
            rounded,
        })
    }
}

/// The first bytes of some, which are taken off.
pub fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*first)
}
