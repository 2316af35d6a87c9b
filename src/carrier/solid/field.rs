//! The flux at every point of the frame, interpolated: what a lattice sees in any of thousands of turns.
//!
//! The flux does not depend on how a lattice lies, so it is taken once at a fine grid, and read off between its points.

use super::cluster::Cluster;
use super::grid::{Grid, ceil, floor};
use super::lattice::RADIUS;
use super::window::weight;
use glam::DVec3;

/// Grid points in a pitch. The error of what is read between them is then 0.2 % of the largest step, as RMS, and 1 % of the
/// smallest.
const FINENESS: f64 = 7.0;

/// The energy in a grid cell below which none of its points has a weight.
const LEAST_ENERGY: f32 = 0.1;

/// The flux and the energy of a window about any point, for one pitch: both as coefficients of cubic B-splines.
pub struct Field {
    pub pitch: f64,
    /// In units: a table half as large is twice as near.
    grid: Grid<[i16; 2]>,
    units: [f32; 2],
    /// The grid in blocks, and a bit for each of their points: whether there is energy.
    blocks: Vec<u64>,
}

/// Grid points along a block's edge.
const BLOCK: usize = 4;

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
        interpolate(&mut sums);
        let units = [0, 1].map(|part| {
            let sizes = sums.values.iter().map(|value| value[part].abs());
            sizes.fold(1e-30, f32::max) / f32::from(i16::MAX)
        });
        let rounded =
            |value: &[f32; 2]| [0, 1].map(|part| (value[part] / units[part]).round() as i16);
        let mut field = Field {
            pitch,
            grid: Grid {
                low: sums.low,
                size: sums.size,
                values: sums.values.iter().map(rounded).collect(),
            },
            units,
            blocks: vec![0; sums.size.map(|size| size.div_ceil(BLOCK)).iter().product()],
        };
        for (place, value) in sums.values.iter().enumerate() {
            if value[1] > LEAST_ENERGY {
                let index = sums.index(place);
                let offset = std::array::from_fn(|axis| (index[axis] - sums.low[axis]) as usize);
                let (block, bit) = field.block(offset);
                field.blocks[block] |= bit;
            }
        }
        field
    }

    /// The block of a grid point and its bit there, by its distance from the lowest.
    fn block(&self, [i, j, k]: [usize; 3]) -> (usize, u64) {
        let [_, y, z] = self.grid.size.map(|size| size.div_ceil(BLOCK));
        let block = (i / BLOCK * y + j / BLOCK) * z + k / BLOCK;
        let bit = (i % BLOCK * BLOCK + j % BLOCK) * BLOCK + k % BLOCK;
        (block, 1 << bit)
    }

    /// A point of the frame in units of the grid.
    fn scaled(&self, point: DVec3) -> DVec3 {
        point * (FINENESS / self.pitch)
    }

    /// The grid point below a scaled point, if what is needed to interpolate there is within the grid.
    fn below(&self, scaled: DVec3) -> Option<usize> {
        let index = scaled.to_array().map(floor);
        let offset: [usize; 3] =
            std::array::from_fn(|axis| index[axis].wrapping_sub(self.grid.low[axis]) as usize);
        if !(0..3).all(|axis| (1..self.grid.size[axis] - 2).contains(&offset[axis])) {
            return None;
        }
        let (block, bit) = self.block(offset);
        (self.blocks[block] & bit != 0).then(|| self.grid.place(index))
    }

    /// Whether a window about a point sees anything to speak of.
    pub fn sees(&self, point: DVec3) -> bool {
        self.below(self.scaled(point)).is_some()
    }

    /// Flux and weight of the window about a point.
    pub fn at(&self, point: DVec3) -> Option<(f64, f64)> {
        let scaled = self.scaled(point);
        self.between(self.below(scaled)?, scaled)
    }

    /// The same at a scaled point, from the place of the grid point below it.
    fn between(&self, place: usize, scaled: DVec3) -> Option<(f64, f64)> {
        let [x, y, z] = scaled
            .to_array()
            .map(|coordinate| splines(coordinate - f64::from(floor(coordinate))));
        let (plane, row) = (self.grid.size[1] * self.grid.size[2], self.grid.size[2]);
        let mut sums = [[0.0f32; 2]; 4];
        for (i, x) in x.iter().enumerate() {
            for (j, y) in y.iter().enumerate() {
                let start = place + i * plane + j * row - plane - row - 1;
                let share = x * y;
                for (sum, value) in sums.iter_mut().zip(&self.grid.values[start..start + 4]) {
                    sum[0] += share * f32::from(value[0]);
                    sum[1] += share * f32::from(value[1]);
                }
            }
        }
        let [flux, energy] = [0, 1].map(|part| {
            let terms = sums.iter().zip(z).map(|(sum, z)| sum[part] * z);
            f64::from(self.units[part] * terms.sum::<f32>())
        });
        let weight = weight(energy.max(0.0));
        (weight > 0.0).then_some((flux, weight))
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

/// The values of the cubic B-splines about the points -1, 0, 1 and 2 at t, 0 to 1.
fn splines(t: f64) -> [f32; 4] {
    let u = 1.0 - t;
    let splines = [
        u * u * u / 6.0,
        (4.0 - 3.0 * t * t * (2.0 - t)) / 6.0,
        (4.0 - 3.0 * u * u * (2.0 - u)) / 6.0,
        t * t * t / 6.0,
    ];
    splines.map(|spline| spline as f32)
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
    fn what_is_read_errs_by_less_than_two_percent_of_the_smallest_step() {
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
            assert!(both > 0.95, "{name}: {both} of the windows are in both");
            let square = errors.iter().map(|error| error * error).sum::<f64>();
            let rms = (square / errors.len() as f64).sqrt();
            assert!(rms > 0.0 && rms < 0.02, "{name}: {rms} steps");
        }
    }
}
