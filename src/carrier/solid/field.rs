//! The flux at every point of the frame, by Taylor's polynomials: what a lattice sees in any of thousands of turns.
//!
//! The flux does not depend on how a lattice lies, so it is taken once at a fine grid, with its derivatives there.

use super::cluster::Cluster;
use super::grid::{Grid, ceil, floor};
use super::lattice::RADIUS;
use super::window::weight;
use glam::DVec3;

/// Grid points in a pitch. The error of what is read about them is then 1 % of the largest step, as RMS, and 6 % of the smallest; how the
/// turns of a scan lie errs by more. With 5 it is a third of that in three times the memory, and finds no more marks in spheres.
const FINENESS: f64 = 3.5;

/// The energy at a grid point below which no point near it has a weight.
const LEAST_ENERGY: f32 = 0.1;

/// The flux and the energy of a window about any point, for one pitch.
pub struct Field {
    pub pitch: f64,
    blocks: Grid<Block>,
    /// Of the grid points with energy, block by block.
    near: Vec<Near>,
}

/// Grid points along a block's edge.
const BLOCK: i32 = 4;

/// A cube of grid points: most of the frame is far from the surface, and holds nothing.
#[derive(Clone, Copy, Default)]
struct Block {
    /// A bit for each of its points: whether there is energy.
    bits: u64,
    /// How many points with energy are in the blocks before it.
    before: u32,
}

/// Taylor's polynomials about a grid point, in units of the grid: of the flux to the second order, of the energy to the first. In one
/// line of a processor's cache: a scan reads millions of them, in no order.
#[repr(align(64))]
struct Near {
    flux: f32,
    slope: [f32; 3],
    /// Half of the second derivatives by x twice, y twice and z twice; whole ones by y and z, z and x, x and y.
    curvature: [f32; 6],
    energy: f32,
    energy_slope: [f32; 3],
}

impl Field {
    /// The field of a surface.
    pub fn new(clusters: &[Cluster], pitch: f64) -> Field {
        let scale = FINENESS / pitch;
        let positions = clusters.iter().map(|cluster| cluster.centre * scale);
        let mut sums = Grid::about(positions, FINENESS * RADIUS + 2.0, [0.0f32; 2]);
        let per_area = 1.0 / (pitch * pitch);
        for cluster in clusters {
            let piece = Cluster {
                centre: cluster.centre * scale,
                area: cluster.area * (per_area / FINENESS),
                moment: cluster.moment * per_area / pitch,
                weight: cluster.weight * per_area,
            };
            add(&piece, &mut sums);
        }
        // No window at the rim of the grid sees anything, so each of these has neighbours.
        let has_energy = |index| {
            let place = sums.find(index);
            place.is_some_and(|place| sums.values[place][1] > LEAST_ENERGY)
        };
        let corner = |size: [usize; 3]| [0, 1, 2].map(|axis| sums.low[axis] + size[axis] as i32);
        let corners = [sums.low, corner(sums.size)].map(|corner| {
            DVec3::from_array(corner.map(|index| f64::from(index.div_euclid(BLOCK))))
        });
        let mut blocks = Grid::about(corners.into_iter(), 0.0, Block::default());
        let mut places = Vec::new();
        for number in 0..blocks.values.len() {
            let first = blocks.index(number).map(|index| index * BLOCK);
            let block = &mut blocks.values[number];
            block.before = places.len() as u32;
            for bit in 0..BLOCK * BLOCK * BLOCK {
                let within = [bit / (BLOCK * BLOCK), bit / BLOCK % BLOCK, bit % BLOCK];
                let index = [0, 1, 2].map(|axis| first[axis] + within[axis]);
                if has_energy(index) {
                    block.bits |= 1 << bit;
                    places.push(sums.place(index));
                }
            }
        }
        interpolate(&mut sums);
        let near = places.iter().map(|&place| Near::of(&sums, place));
        Field {
            pitch,
            near: near.collect(),
            blocks,
        }
    }

    /// The nearest grid point to a point of the frame, if it has energy, and where the point lies from there.
    fn nearest(&self, point: DVec3) -> Option<(&Near, DVec3)> {
        let scaled = point * (FINENESS / self.pitch);
        let index = scaled.to_array().map(|coordinate| floor(coordinate + 0.5));
        let block = self
            .blocks
            .find(index.map(|index| index.div_euclid(BLOCK)))?;
        let Block { bits, before } = self.blocks.values[block];
        let [i, j, k] = index.map(|index| index.rem_euclid(BLOCK));
        let bit = 1 << ((i * BLOCK + j) * BLOCK + k);
        if bits & bit == 0 {
            return None;
        }
        let near = before + (bits & (bit - 1)).count_ones();
        let from = scaled - DVec3::from_array(index.map(f64::from));
        Some((&self.near[near as usize], from))
    }

    /// Whether a window about a point sees anything to speak of.
    pub fn sees(&self, point: DVec3) -> bool {
        self.nearest(point).is_some()
    }

    /// Flux and weight of the window about a point.
    pub fn at(&self, point: DVec3) -> Option<(f64, f64)> {
        let (near, from) = self.nearest(point)?;
        let (flux, energy) = near.at(from.to_array().map(|coordinate| coordinate as f32));
        let weight = weight(f64::from(energy.max(0.0)));
        (weight > 0.0).then_some((f64::from(flux), weight))
    }
}

impl Near {
    /// From the coefficients of B-splines about a place of a grid.
    fn of(coefficients: &Grid<[f32; 2]>, place: usize) -> Near {
        /// What the coefficients before, at and after a point give its value, its slope and half of its curvature.
        const VALUE: [f32; 3] = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];
        const SLOPE: [f32; 3] = [-0.5, 0.0, 0.5];
        const CURVATURE: [f32; 3] = [0.5, -1.0, 0.5];
        let [_, ny, nz] = coefficients.size;
        let along = |z: [f32; 3], part: usize| {
            [0, 1, 2].map(|i| {
                [0, 1, 2].map(|j| {
                    let start = place + i * ny * nz + j * nz - ny * nz - nz - 1;
                    let values = &coefficients.values[start..start + 3];
                    values
                        .iter()
                        .zip(z)
                        .map(|(value, z)| value[part] * z)
                        .sum::<f32>()
                })
            })
        };
        let across = |rows: &[[f32; 3]; 3], x: [f32; 3], y: [f32; 3]| -> f32 {
            let row = |row: &[f32; 3]| row.iter().zip(y).map(|(value, y)| value * y).sum::<f32>();
            rows.iter().zip(x).map(|(values, x)| row(values) * x).sum()
        };
        let [value, slope, curvature] = [VALUE, SLOPE, CURVATURE].map(|z| along(z, 0));
        let energies = [VALUE, SLOPE].map(|z| along(z, 1));
        Near {
            flux: across(&value, VALUE, VALUE),
            slope: [
                across(&value, SLOPE, VALUE),
                across(&value, VALUE, SLOPE),
                across(&slope, VALUE, VALUE),
            ],
            curvature: [
                across(&value, CURVATURE, VALUE),
                across(&value, VALUE, CURVATURE),
                across(&curvature, VALUE, VALUE),
                across(&slope, VALUE, SLOPE),
                across(&slope, SLOPE, VALUE),
                across(&value, SLOPE, SLOPE),
            ],
            energy: across(&energies[0], VALUE, VALUE),
            energy_slope: [
                across(&energies[0], SLOPE, VALUE),
                across(&energies[0], VALUE, SLOPE),
                across(&energies[1], VALUE, VALUE),
            ],
        }
    }

    /// Flux and energy at some distance from the grid point.
    fn at(&self, [x, y, z]: [f32; 3]) -> (f32, f32) {
        let [a, b, c] = self.slope;
        let [xx, yy, zz, yz, zx, xy] = self.curvature;
        let flux = self.flux
            + x * (a + xx * x + xy * y)
            + y * (b + yy * y + yz * z)
            + z * (c + zz * z + zx * x);
        let [a, b, c] = self.energy_slope;
        (flux, self.energy + a * x + b * y + c * z)
    }
}

/// Adds a piece of surface, its centre in units of the grid, to all windows that see it.
fn add(piece: &Cluster, sums: &mut Grid<[f32; 2]>) {
    const REACH: f64 = FINENESS * RADIUS;
    let (y, area) = (piece.centre, piece.area);
    let [x0, y0, _] = (y - REACH).to_array().map(ceil);
    for i in x0.. {
        let x = y.x - f64::from(i);
        if x <= -REACH {
            break;
        }
        for j in y0.. {
            let dy = y.y - f64::from(j);
            let left = REACH * REACH - x * x - dy * dy;
            if left <= 0.0 {
                if dy < 0.0 {
                    break;
                }
                continue;
            }
            let half = left.sqrt();
            let first = ceil(y.z - half);
            let count = (ceil(y.z + half) - first) as usize;
            let place = sums.place([i, j, first]);
            let across = (x * area.x + dy * area.y + piece.moment) as f32;
            let [left, z, z_area] = [left, y.z - f64::from(first), area.z].map(|f| f as f32);
            let weight = piece.weight as f32;
            for (k, sum) in sums.values[place..place + count].iter_mut().enumerate() {
                let z = z - k as f32;
                let inside = (left - z * z) * (1.0 / (REACH * REACH)) as f32;
                let g = inside * (7.0 * inside - 4.0);
                sum[0] += inside * inside * (across + z * z_area);
                sum[1] += weight * g * g;
            }
        }
    }
}

/// Replaces values by the coefficients of the cubic B-splines that go through them: a recursive filter there and back along
/// each axis (Unser, Aldroubi and Eden 1991). All is zero beyond the grid.
fn interpolate(grid: &mut Grid<[f32; 2]>) {
    /// The square root of 3, minus 2: the root of `z^2 + 4 z + 1` within the unit circle.
    const POLE: f32 = -0.267_949_2;
    let [nx, ny, nz] = grid.size;
    for (stride, len) in [(ny * nz, nx), (nz, ny), (1, nz)] {
        for line in grid.values.chunks_exact_mut(stride * len) {
            for place in stride..line.len() {
                let before = line[place - stride];
                let value = &mut line[place];
                *value = [0, 1].map(|part| value[part] + POLE * before[part]);
            }
            for place in (0..line.len()).rev() {
                let after = line
                    .get(place + stride)
                    .map_or([0.0; 2], |value| value.map(|v| v / 6.0));
                let value = &mut line[place];
                *value = [0, 1].map(|part| 6.0 * POLE * (after[part] - value[part]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::cluster::clusters;
    use super::super::lattice::Placement;
    use super::super::quantizer::STEPS;
    use super::super::window::windows;
    use super::*;
    use crate::geometry::{Pose, oriented};
    use crate::mesh::shapes;
    use glam::DMat3;

    #[test]
    fn what_is_read_errs_by_less_than_a_tenth_of_the_smallest_step() {
        const PITCH: f64 = 0.07;
        let shapes = [
            ("rock", shapes::asteroid(40, 60)),
            ("part", shapes::cad_part()),
            ("rover", shapes::game_asset()),
        ];
        for (name, mesh) in shapes {
            let (mesh, boundary) = oriented(&mesh);
            let pose = Pose::of_oriented(&mesh, &boundary).expect("it has a frame");
            let clusters = clusters(&mesh, &pose, PITCH);
            let placement = Placement {
                rotation: DMat3::IDENTITY,
                origin: DVec3::splat(0.3 * PITCH),
                pitch: PITCH,
            };
            let field = Field::new(&clusters, PITCH);
            let exact = windows(&clusters, &placement);
            let errors: Vec<f64> = exact
                .iter()
                .filter_map(|window| {
                    let index = DVec3::from_array(window.index.map(f64::from));
                    let (flux, _) = field.at(placement.point(index))?;
                    Some((flux - window.flux) * PITCH / STEPS[STEPS.len() - 1])
                })
                .collect();
            let both = errors.len() as f64 / exact.len() as f64;
            assert!(both > 0.94, "{name}: {both} of the windows are in both");
            let square = errors.iter().map(|error| error * error).sum::<f64>();
            let rms = (square / errors.len() as f64).sqrt();
            eprintln!("{name}: {rms}");
            assert!(rms > 0.0 && rms < 0.1, "{name}: {rms} steps");
        }
    }
}
