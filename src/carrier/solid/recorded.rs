//! What is kept of an original for one key, and reading with that alone: the fluxes of the key's windows.
//!
//! The suspect lies on the original about as it should, by registration. Its own fluxes say the rest: they are brought to the recorded ones
//! by the affine map that leaves least, and what is left in windows that are whole is what the embedder moved them by, and noise.

use super::cluster::{Cluster, clusters};
use super::informed::{Frames, centre};
use super::lattice::{Lattice, Placement, RADIUS, for_each_near};
use super::pitch::PITCHES;
use super::quantizer::{STEPS, phase};
use super::window::{Window, sensitivity, windows};
use crate::carrier::{Place, StoredError, Way, possible, take};
use crate::geometry::{Motion, Pose, affine_fit, oriented};
use crate::key::Key;
use crate::mesh::Mesh;
use glam::{DMat3, DVec3};

/// Fluxes are kept in this many parts of the smallest step.
const PARTS: f64 = 32.0;
/// Weights in so many parts of 1.
const WEIGHTS: f64 = 32.0;
/// How much less or more surface a window may see, and where the suspect's boundary is in it.
const WHOLE: f64 = 0.1;
const WHOLE_AT_BOUNDARY: f64 = 0.03;
/// Windows without which nothing is said.
const LEAST_WINDOWS: usize = 40;
const ROUNDS: usize = 6;
/// A window's difference counts up to so many steps.
const MOST: f64 = 0.5;
/// Frames and windows of a record, at most: for files that are made to cost much.
const MOST_FRAMES: usize = 17;
const MOST_WINDOWS: usize = 1 << 14;

/// What is kept of an original for one key.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    frames: Vec<RecordedFrame>,
}

#[derive(Clone, Debug, PartialEq)]
struct RecordedFrame {
    pose: Pose,
    ln_num_shares: f64,
    laid: Vec<RecordedWindows>,
}

#[derive(Clone, Debug, PartialEq)]
struct RecordedWindows {
    pitch: usize,
    finest: usize,
    /// In increasing order of index.
    windows: Vec<Window>,
}

impl Recorded {
    /// What a key has to look for in an original.
    pub fn new(frames: &Frames, key: &Key) -> Recorded {
        let lattice = Lattice::of(key);
        let mut kept = Vec::new();
        for frame in &frames.frames {
            let (candidates, finest) = frame.pitches();
            let clusters = clusters(&frame.mesh, &frame.pose, finest);
            let number = |pitch: f64| PITCHES.iter().position(|own| *own == pitch);
            let laid = candidates.iter().filter_map(|&pitch| {
                let placement = lattice.placed(DMat3::IDENTITY, pitch);
                let unit = STEPS[STEPS.len() - 1] / pitch / PARTS;
                let mut windows = windows(&clusters, &placement);
                windows.truncate(MOST_WINDOWS);
                for window in &mut windows {
                    window.flux = (window.flux / unit).round() * unit;
                    let most = f64::from(u8::MAX) / WEIGHTS;
                    let weight = window.weight.clamp(1.0 / WEIGHTS, most);
                    window.weight = (weight * WEIGHTS).round() / WEIGHTS;
                }
                Some(RecordedWindows {
                    pitch: number(pitch)?,
                    finest: number(finest)?,
                    windows,
                })
            });
            kept.push(RecordedFrame {
                pose: frame.pose,
                ln_num_shares: frame.ln_num_shares,
                laid: laid.collect(),
            });
        }
        Recorded { frames: kept }
    }

    /// Calls `visit` with every declared way of reading a suspect that lies on the original in some ways, until it returns `true`.
    pub fn read(
        &self,
        suspect: &Mesh,
        motions: &[Motion],
        key: &Key,
        visit: &mut dyn FnMut(Way) -> bool,
    ) {
        let lattice = Lattice::of(key);
        for frame in &self.frames {
            let num_ways = frame.laid.len() * motions.len() * STEPS.len();
            let ln_num_tests = libm::log(num_ways as f64) + frame.ln_num_shares;
            for laid in &frame.laid {
                for (list, motion) in motions.iter().enumerate() {
                    let placement = lattice.placed(DMat3::IDENTITY, PITCHES[laid.pitch]);
                    let moved = motion.of_mesh(suspect);
                    let Some(differences) = laid.differences(&moved, &frame.pose, &placement)
                    else {
                        continue;
                    };
                    for step in STEPS {
                        let way = Way {
                            places: laid.places(
                                &differences,
                                &lattice,
                                &frame.pose,
                                &placement,
                                step,
                            ),
                            ln_num_tests,
                            list,
                            radius: RADIUS * placement.pitch * frame.pose.size,
                        };
                        if visit(way) {
                            return;
                        }
                    }
                }
            }
        }
    }

    /// The record as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = vec![self.frames.len() as u8];
        for frame in &self.frames {
            let pose = &frame.pose;
            let mut numbers = pose.centre.to_array().to_vec();
            numbers.push(pose.size);
            numbers.extend(pose.axes.to_cols_array());
            numbers.push(frame.ln_num_shares);
            numbers.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
            bytes.push(frame.laid.len() as u8);
            frame.laid.iter().for_each(|laid| laid.write(&mut bytes));
        }
        bytes
    }

    /// A record from the beginning of bytes, which is taken off.
    ///
    /// # Errors
    /// Where they are none.
    pub fn read_bytes(bytes: &mut &[u8]) -> Result<Recorded, StoredError> {
        let [num_frames] = take(bytes)?;
        possible(usize::from(num_frames) <= MOST_FRAMES, "too many frames")?;
        let mut frames = Vec::new();
        for _ in 0..num_frames {
            let mut numbers = [0.0; 14];
            for number in &mut numbers {
                *number = f64::from_le_bytes(take(bytes)?);
                possible(number.is_finite(), "a number that is none")?;
            }
            let [x, y, z, size, axes @ .., ln_num_shares] = numbers;
            possible(size > 0.0, "a frame without size")?;
            let [num_laid] = take(bytes)?;
            possible(usize::from(num_laid) <= 2, "more pitches than are used")?;
            let mut laid = Vec::new();
            for _ in 0..num_laid {
                laid.push(RecordedWindows::read(bytes)?);
            }
            frames.push(RecordedFrame {
                pose: Pose {
                    centre: DVec3::new(x, y, z),
                    size,
                    axes: DMat3::from_cols_array(&axes),
                    spreads: DVec3::splat(1.0 / 3.0),
                },
                ln_num_shares,
                laid,
            });
        }
        Ok(Recorded { frames })
    }
}

impl RecordedWindows {
    /// How far each window that the suspect shows whole is from what was recorded, in lattice units; `None` where these are too few.
    fn differences(&self, moved: &Mesh, pose: &Pose, placement: &Placement) -> Option<Vec<f64>> {
        let (mesh, boundary) = oriented(moved);
        let mut positions: Vec<DVec3> = mesh.positions.iter().map(|p| pose.canonical(*p)).collect();
        let unit = Pose {
            centre: DVec3::ZERO,
            size: 1.0,
            axes: DMat3::IDENTITY,
            spreads: pose.spreads,
        };
        let mut last = None;
        for round in 0..=ROUNDS {
            let now = mesh.with_positions(positions.clone());
            let clusters = clusters(&now, &unit, PITCHES[self.finest]);
            let at_boundary = self.at_boundary(&now, &boundary, placement);
            let seen = windows(&clusters, placement);
            let mut differences = vec![f64::NAN; self.windows.len()];
            for (place, own) in self.windows.iter().enumerate() {
                let Ok(found) = seen.binary_search_by_key(&own.index, |window| window.index) else {
                    continue;
                };
                let ratio = (seen[found].weight + 0.5) / (own.weight + 0.5);
                let most = match at_boundary[place] {
                    true => WHOLE_AT_BOUNDARY,
                    false => WHOLE,
                };
                // Far from where it should be at first, a suspect's windows differ by more.
                let slack = if round < 2 { 2.0 } else { 1.0 };
                if (ratio * ratio - 1.0).abs() < slack * most {
                    differences[place] = seen[found].flux - own.flux;
                }
            }
            let rows = self.answers(&clusters, placement);
            let used: Vec<usize> = (0..differences.len())
                .filter(|&place| differences[place].is_finite())
                .collect();
            if used.len() < LEAST_WINDOWS {
                return None;
            }
            let rows: Vec<[f64; 12]> = used.iter().map(|&place| rows[place]).collect();
            let values: Vec<f64> = used.iter().map(|&place| differences[place]).collect();
            let (fit, left) = affine_fit(&rows, &values)?;
            for (&place, left) in used.iter().zip(&left) {
                differences[place] = *left;
            }
            last = Some(differences);
            // In lattice coordinates, an affine map by which the suspect is away from the original.
            let linear = DMat3::from_cols_array(&std::array::from_fn(|i| fit[i]));
            let shift = DVec3::new(fit[9], fit[10], fit[11]);
            for p in &mut positions {
                let y = placement.lattice(*p);
                *p = placement.point(y - (linear * y + shift));
            }
        }
        last
    }

    /// How each window answers to an affine movement of the surface, in lattice coordinates: the columns of a linear map, and a shift.
    fn answers(&self, clusters: &[Cluster], placement: &Placement) -> Vec<[f64; 12]> {
        let back = placement.rotation.transpose();
        let per_area = 1.0 / (placement.pitch * placement.pitch);
        let mut answers = vec![[0.0; 12]; self.windows.len()];
        for cluster in clusters {
            let y = placement.lattice(cluster.centre);
            let area = back * cluster.area * per_area;
            for_each_near(y, RADIUS, |index, _, q2| {
                let Some(place) = self.place(index) else {
                    return;
                };
                let push = area * sensitivity(q2);
                let row = &mut answers[place];
                for column in 0..3 {
                    for axis in 0..3 {
                        row[3 * column + axis] += push[axis] * y[column];
                    }
                    row[9 + column] += push[column];
                }
            });
        }
        answers
    }

    fn at_boundary(
        &self,
        mesh: &Mesh,
        boundary: &[(u32, u32)],
        placement: &Placement,
    ) -> Vec<bool> {
        let mut is_at = vec![false; self.windows.len()];
        for &(a, b) in boundary {
            let middle = (mesh.positions[a as usize] + mesh.positions[b as usize]) / 2.0;
            for_each_near(placement.lattice(middle), RADIUS, |index, _, _| {
                if let Some(place) = self.place(index) {
                    is_at[place] = true;
                }
            });
        }
        is_at
    }

    fn place(&self, index: [i32; 3]) -> Option<usize> {
        self.windows
            .binary_search_by_key(&index, |window| window.index)
            .ok()
    }

    /// The windows with their errors at a step, in the frame's units.
    fn places(
        &self,
        differences: &[f64],
        lattice: &Lattice,
        pose: &Pose,
        placement: &Placement,
        step: f64,
    ) -> Vec<Place> {
        let step = step / placement.pitch;
        let place = |(window, difference): (&Window, &f64)| {
            let (dither, symbol) = lattice.at(window.index);
            let phase = phase(window.flux / step, dither);
            let error = |coset: f64| {
                let phase = phase - coset;
                phase.round() - phase
            };
            let response = match difference.is_finite() {
                true => window.weight * (difference / step).clamp(-MOST, MOST),
                false => 0.0,
            };
            Place {
                symbol,
                response,
                errors: [error(0.5), error(0.0)],
                centre: centre(pose, placement, window.index),
            }
        };
        self.windows.iter().zip(differences).map(place).collect()
    }

    /// The pitches' numbers, the box of the indices, how many windows there are; and of each how far its place in the box is after the one
    /// before (LEB128), its flux (zigzag, LEB128) and its weight in 1.
    fn write(&self, bytes: &mut Vec<u8>) {
        let low = self.corner(|a, b| a.min(b));
        let high = self.corner(|a, b| a.max(b));
        bytes.extend([self.pitch as u8, self.finest as u8]);
        for corner in [low, high] {
            corner
                .iter()
                .for_each(|x| bytes.extend((*x as i16).to_le_bytes()));
        }
        bytes.extend((self.windows.len() as u32).to_le_bytes());
        let unit = self.unit();
        let mut last = 0;
        for window in &self.windows {
            let place = linear(window.index, low, high);
            leb128(bytes, place - last);
            last = place;
            let flux = (window.flux / unit).round() as i64;
            leb128(bytes, (flux << 1 ^ flux >> 63) as u64);
            bytes.push((window.weight * WEIGHTS).round() as u8);
        }
    }

    fn read(bytes: &mut &[u8]) -> Result<RecordedWindows, StoredError> {
        let [pitch, finest] = take(bytes)?.map(usize::from);
        let is_known = pitch < PITCHES.len() && finest <= pitch;
        possible(is_known, "a pitch that is none")?;
        let mut corners = [[0i32; 3]; 2];
        for x in corners.iter_mut().flatten() {
            *x = i32::from(i16::from_le_bytes(take(bytes)?));
        }
        let [low, high] = corners;
        let is_box = (0..3).all(|axis| low[axis] <= high[axis] && high[axis] - low[axis] < 1 << 10);
        let num_windows = u32::from_le_bytes(take(bytes)?) as usize;
        possible(is_box && num_windows <= MOST_WINDOWS, "impossible windows")?;
        let mut recorded = RecordedWindows {
            pitch,
            finest,
            windows: Vec::new(),
        };
        let unit = recorded.unit();
        let mut place = 0u64;
        for number in 0..num_windows {
            let step = read_leb128(bytes)?;
            possible(number == 0 || step > 0, "a window twice")?;
            place = place.checked_add(step).ok_or(StoredError::Damaged)?;
            let size = [1, 2].map(|axis| (high[axis] - low[axis] + 1) as u64);
            let x = place / (size[0] * size[1]);
            possible(x <= (high[0] - low[0]) as u64, "a window outside its box")?;
            let rest = place % (size[0] * size[1]);
            let flux = read_leb128(bytes)?;
            let flux = (flux >> 1) as i64 ^ -((flux & 1) as i64);
            let [weight] = take(bytes)?;
            recorded.windows.push(Window {
                index: [
                    low[0] + x as i32,
                    low[1] + (rest / size[1]) as i32,
                    low[2] + (rest % size[1]) as i32,
                ],
                flux: flux as f64 * unit,
                weight: f64::from(weight) / WEIGHTS,
                dither: 0.0,
            });
        }
        Ok(recorded)
    }

    fn unit(&self) -> f64 {
        STEPS[STEPS.len() - 1] / PITCHES[self.pitch] / PARTS
    }

    fn corner(&self, of: fn(i32, i32) -> i32) -> [i32; 3] {
        let indices = self.windows.iter().map(|window| window.index);
        let both = |a: [i32; 3], b: [i32; 3]| std::array::from_fn(|axis| of(a[axis], b[axis]));
        indices.reduce(both).unwrap_or_default()
    }
}

/// The place of a lattice point in its box, row after row.
fn linear(index: [i32; 3], low: [i32; 3], high: [i32; 3]) -> u64 {
    let part = |axis: usize| (index[axis] - low[axis]) as u64;
    let size = |axis: usize| (high[axis] - low[axis] + 1) as u64;
    (part(0) * size(1) + part(1)) * size(2) + part(2)
}

fn leb128(bytes: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

fn read_leb128(bytes: &mut &[u8]) -> Result<u64, StoredError> {
    let mut number = 0u64;
    for shift in (0..63).step_by(7) {
        let [byte] = take(bytes)?;
        number |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Ok(number);
        }
    }
    Err(StoredError::Damaged)
}
