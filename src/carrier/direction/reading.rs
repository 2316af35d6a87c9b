//! Reading notes: what the cells of a suspect say, in every turn and at every scale that its frame leaves open.

use super::cells::{Cells, Ray};
use crate::code::Decoded;
use crate::detection::Statistic;
use crate::geometry::Pose;
use crate::mesh::Mesh;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Scales that are tried: 1 - 2 % to 1 + 2 %.
const SCALES: u32 = 81;
const LEAST_SCALE: f64 = 0.98;
const SCALE_STEP: f64 = 5e-4;

/// Vertices that are carried through all scales at a time: what the fast memory holds.
const CHUNK: usize = 2048;

/// Ways of reading whose words are decoded.
const CANDIDATES: usize = 6;

/// A vertex nearer than this to its cell's border, as a chord of the unit sphere with 640 cells, counts less.
const MARGIN: f64 = 0.02;

/// Evidence of one bit is cut off here.
const MOST: f64 = 12.0;

/// Limit of what one cell says against chance, in standard deviations: cells with many vertices are no better witnesses.
const MOST_OF_CELL: f64 = 2.0;

/// Words that are read from a mesh: in each of four turns and at each scale one, and its complement.
pub const NUM_TESTS: u32 = 4 * SCALES * 2;

/// One way of reading a suspect.
#[derive(Clone, Debug)]
pub struct CellReading {
    /// Evidence `ln P(0) / P(1)` of every bit of the codeword.
    pub evidence: Vec<f64>,
    /// What the code made of it.
    pub decoded: Decoded,
    /// The bit of each cell that has vertices, its value (positive for a 0), and what the value could be at most.
    cells: Vec<(u32, f64, f64)>,
}

/// Rays as they lie in the cells after a turn.
struct View {
    /// The cell and the weight (0 to 1) of every ray.
    places: Vec<(u32, f64)>,
    /// Sum of the squared weights in each cell.
    energies: Vec<f64>,
}

impl Cells {
    /// The ways of reading a mesh that stand out most, each decoded; none without a frame.
    pub fn read(&self, mesh: &Mesh) -> Vec<CellReading> {
        let Some(pose) = Pose::of_surface(mesh) else {
            return Vec::new();
        };
        let points = mesh.positions.iter().map(|&p| pose.canonical(p));
        let rays: Vec<Ray> = points.map(Ray::new).collect();
        let views = Pose::HALF_TURNS.map(|turn| self.view(&rays, turn));
        let mut peaks = Vec::new();
        for (energies, view) in self.scan(&rays, &views).iter().zip(&views) {
            let scales: Vec<f64> = scales().collect();
            for (number, &scale) in scales.iter().enumerate() {
                let near = &energies[number.saturating_sub(1)..(number + 2).min(energies.len())];
                if near.iter().all(|&other| other <= energies[number]) {
                    peaks.push((energies[number], scale, view));
                }
            }
        }
        peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = peaks.iter().take(CANDIDATES);
        best.map(|&(_, scale, view)| self.reading(&self.phasors(&rays, scale), view))
            .collect()
    }

    /// The energy of the bits, by turn and scale.
    fn scan(&self, rays: &[Ray], views: &[View; 4]) -> [Vec<f64>; 4] {
        let num_cells = self.sphere.len();
        let mut sums = vec![DVec2::ZERO; SCALES as usize * views.len() * num_cells];
        for first in (0..rays.len()).step_by(CHUNK) {
            let chunk = first..(first + CHUNK).min(rays.len());
            let mut phasors = self.phasors(&rays[chunk.clone()], LEAST_SCALE);
            let steps = self.phasors(&rays[chunk.clone()], SCALE_STEP);
            for sums in sums.chunks_exact_mut(views.len() * num_cells) {
                for (sums, view) in sums.chunks_exact_mut(num_cells).zip(views) {
                    gather(sums, &phasors, &view.places[chunk.clone()]);
                }
                let turned = phasors.iter_mut().zip(&steps);
                turned.for_each(|(phasor, step)| *phasor = step.rotate(*phasor));
            }
        }
        let mut energies = [const { Vec::new() }; 4];
        for sums in sums.chunks_exact(views.len() * num_cells) {
            let turns = energies.iter_mut().zip(views);
            for ((energies, view), sums) in turns.zip(sums.chunks_exact(num_cells)) {
                let bits = self.bits_of(&self.values(sums), view);
                energies.push(bits.iter().map(|z| z * z).sum());
            }
        }
        energies
    }

    fn reading(&self, phasors: &[DVec2], view: &View) -> CellReading {
        let mut sums = vec![DVec2::ZERO; self.sphere.len()];
        gather(&mut sums, phasors, &view.places);
        let values = self.values(&sums);
        let clip = |z: &f64| (2.0 * z).clamp(-MOST, MOST);
        let evidence: Vec<f64> = self.bits_of(&values, view).iter().map(clip).collect();
        let lengths = sums.iter().map(|sum| sum.length());
        let cells = self.bits.iter().zip(values);
        let cells = cells.zip(lengths.zip(&view.energies));
        let occupied = cells.filter(|(_, (length, _))| *length > 0.0);
        CellReading {
            decoded: self.block.decode(&evidence),
            evidence,
            cells: occupied
                .map(|((&bit, value), (length, energy))| {
                    let most = (length / energy.sqrt()).min(MOST_OF_CELL);
                    (bit, value / length * most, most)
                })
                .collect(),
        }
    }

    /// The cells and weights of rays that are turned.
    fn view(&self, rays: &[Ray], turn: DVec3) -> View {
        let margin = MARGIN * (640.0 / self.sphere.len() as f64).sqrt();
        let place = |ray: &Ray| {
            let (cell, apart) = self.sphere.cell(ray.direction * turn);
            (cell as u32, (apart / margin).min(1.0))
        };
        let places: Vec<(u32, f64)> = rays.iter().map(place).collect();
        let mut energies = vec![0.0; self.sphere.len()];
        for &(cell, weight) in &places {
            energies[cell as usize] += weight * weight;
        }
        View { places, energies }
    }

    /// Each ray's phase in the quantizer, as a unit vector.
    fn phasors(&self, rays: &[Ray], scale: f64) -> Vec<DVec2> {
        let phasor = |ray: &Ray| {
            let (sine, cosine) = libm::sincos(TAU * (scale * ray.radius / self.step));
            DVec2::new(cosine, sine)
        };
        rays.iter().map(phasor).collect()
    }

    /// What each cell says of its bit: minus the sine of its phase less the dither, positive for a 0.
    fn values(&self, sums: &[DVec2]) -> Vec<f64> {
        let value = |(sum, dither): (&DVec2, &f64)| {
            let (sine, cosine) = libm::sincos(TAU * dither);
            sum.x * sine - sum.y * cosine
        };
        sums.iter().zip(&self.dithers).map(value).collect()
    }

    /// The values of the bits, in units of their standard deviation where nothing was written.
    fn bits_of(&self, values: &[f64], view: &View) -> Vec<f64> {
        let mut bits = vec![(0.0, 1e-9); self.block.code_bits()];
        for ((&bit, value), energy) in self.bits.iter().zip(values).zip(&view.energies) {
            let (total, variance) = &mut bits[bit as usize];
            *total += value;
            *variance += 0.5 * energy;
        }
        let normalized = |(total, variance): (f64, f64)| total / variance.sqrt();
        bits.into_iter().map(normalized).collect()
    }
}

impl CellReading {
    /// The decoded message or its complement, whichever is right.
    pub fn message(&self, is_right: impl Fn(&[u8]) -> bool) -> Option<Vec<u8>> {
        let decoded = self.decoded.message.clone();
        let complement = decoded.iter().map(|byte| !byte).collect();
        [decoded, complement]
            .into_iter()
            .find(|message| is_right(message))
    }

    /// How surprising it is that the cells agree with a codeword. Where the key had no part in making the mesh, each dither is
    /// uniform, whatever the mesh: the terms are as [`Statistic`] asks for.
    pub fn statistic(&self, word: &[bool]) -> Statistic {
        Statistic::new(self.cells.iter().map(|&(bit, value, most)| {
            let is_one = word.get(bit as usize).is_some_and(|&bit| bit);
            (if is_one { -value } else { value }, most)
        }))
    }
}

/// Adds weighted phasors to the sums of their cells.
fn gather(sums: &mut [DVec2], phasors: &[DVec2], places: &[(u32, f64)]) {
    for (phasor, &(cell, weight)) in phasors.iter().zip(places) {
        sums[cell as usize] += *phasor * weight;
    }
}

/// The scales that are tried.
fn scales() -> impl Iterator<Item = f64> {
    (0..SCALES).map(|number| LEAST_SCALE + SCALE_STEP * f64::from(number))
}
