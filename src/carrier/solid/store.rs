//! Clusters in few bytes: rounded far below what a quantizer notices.
//!
//! As bytes: the units of areas and of moments in 4 each, the number of clusters in 4; then the clusters in
//! increasing order of their cells. A cluster: the distance of its cell's number from the one before (LEB128), its centre
//! within the cell in 3 bytes, its area vector in 6, its moment in 2, its weight in 1. All integers are little-endian.

use super::cluster::{CELLS_PER_PITCH, Cluster, EXTENT, MOST_CLUSTERS, corner, fits, number};
use super::pitch::LARGEST_AREA;
use crate::carrier::{StoredError, possible, take};
use glam::DVec3;
use std::f64::consts::LN_2;

/// Steps in a cell's edge.
const OFFSETS: f64 = 256.0;
/// The largest of the rounded areas and moments.
const LARGEST: f64 = 32_767.0;

/// Steps in an octave of weights.
const WEIGHTS: f64 = 16.0;

/// Half a step of a weight is 2.2 %, and an area vector is as long as its area at most: what is stored may be so much longer.
const SLACK: f64 = 1.03;

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

    /// Takes a store whose clusters are fine enough for a pitch from the beginning of bytes.
    ///
    /// # Errors
    /// Where they are none, or hold numbers that no surface gives.
    pub fn read(bytes: &mut &[u8], pitch: f64) -> Result<Store, StoredError> {
        let area_unit = f32::from_le_bytes(take(bytes)?);
        let moment_unit = f32::from_le_bytes(take(bytes)?);
        let count = u32::from_le_bytes(take(bytes)?) as usize;
        let mut store = Store {
            pitch,
            area_unit,
            moment_unit,
            rounded: Vec::new(),
        };
        let (area, largest) = (f64::from(area_unit), LARGEST_AREA * pitch * pitch);
        possible(
            area > 0.0 && area * LARGEST <= SLACK * largest,
            "areas in a unit that no surface needs",
        )?;
        let moment = f64::from(moment_unit);
        possible(
            moment > 0.0 && moment <= 2.0 * store.cell() * area,
            "moments in a unit that no surface needs",
        )?;
        possible(
            count <= MOST_CLUSTERS,
            "more pieces than are kept of a surface",
        )?;
        let mut cell = None;
        for _ in 0..count {
            let rounded = Rounded::read(bytes, cell)?;
            cell = Some(rounded.cell);
            let reach = corner(rounded.cell).abs().max_element() * store.cell();
            possible(reach <= EXTENT + pitch, "a piece beyond the frame")?;
            store.rounded.push(rounded);
        }
        let clusters = store.clusters();
        let is_possible = |cluster: &Cluster| store.is_possible(cluster);
        possible(
            clusters.iter().all(is_possible),
            "a piece with more flux than its area gives",
        )?;
        let total: f64 = clusters.iter().map(|cluster| cluster.weight).sum();
        possible(
            total <= SLACK * largest + area * count as f64,
            "more area than is read at its pitch",
        )?;
        let centres = clusters.iter().map(|cluster| cluster.centre);
        // Rounding moves centres a little.
        possible(fits(centres, 1.01 * pitch), "pieces too far apart")?;
        Ok(store)
    }

    /// Whether a piece of surface of its area, within its cell, can have its area vector and its moment, but for rounding.
    fn is_possible(&self, cluster: &Cluster) -> bool {
        let area = SLACK * cluster.weight + f64::from(self.area_unit);
        let moment = 2.0 * self.cell() * area + f64::from(self.moment_unit);
        cluster.area.length() <= area && cluster.moment.abs() <= moment
    }
}

impl Rounded {
    /// Takes a cluster from the beginning of bytes that follows one in a cell.
    fn read(bytes: &mut &[u8], last: Option<u64>) -> Result<Rounded, StoredError> {
        let (mut gap, mut shift) = (0u64, 0);
        loop {
            let [byte] = take(bytes)?;
            let part = u64::from(byte & 0x7f).checked_shl(shift);
            gap |= part.ok_or(StoredError::Damaged)?;
            shift += 7;
            if byte < 0x80 {
                break;
            }
        }
        possible(last.is_none() || gap > 0, "two pieces in one cell")?;
        let cell = last.unwrap_or_default().checked_add(gap);
        let offset = take(bytes)?;
        let mut number = || Ok(i16::from_le_bytes(take(bytes)?));
        let area = [number()?, number()?, number()?];
        let moment = number()?;
        let [lightness] = take(bytes)?;
        Ok(Rounded {
            cell: cell.ok_or(StoredError::Damaged)?,
            offset,
            area,
            moment,
            lightness,
        })
    }
}
