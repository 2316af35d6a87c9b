//! The statistic: the windowed flux of the oriented surface at the points of a lattice, a band-passed occupancy field.
//!
//! It is an integral over the surface, so tessellation drops out. In units of the lattice's pitch, with q = |y - L| / R < 1
//! about a lattice point L, `F = integral of (1 - q^2)^2 (y - L) . dA`; a displacement d of the surface changes it by
//! `integral of g d . dA` with `g = (1 - q^2)(3 - 7 q^2)`.

use super::cluster::Cluster;
use super::grid::{Grid, ceil};
use super::lattice::{Placement, RADIUS};

/// The flux at one lattice point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The lattice point.
    pub index: [i32; 3],
    pub flux: f64,
    /// How much surface the window sees.
    pub weight: f64,
    /// What the key adds to the phase, in steps of the quantizer: 0 until a key is there.
    pub dither: f64,
}

/// Sensitivity of a window to a displacement of the surface within it.
pub fn sensitivity(q2: f64) -> f64 {
    (1.0 - q2) * (3.0 - 7.0 * q2)
}

/// Windows that see less than this are not used; from there on the weight grows.
const LEAST_ENERGY: f64 = 0.5;

/// The weight of a window, from the integral of `g^2` over the surface that it sees; not positive for too little.
pub fn weight(energy: f64) -> f64 {
    energy.sqrt() - LEAST_ENERGY
}

/// The windows that see enough of the surface, in increasing order of index.
pub fn windows(clusters: &[Cluster], placement: &Placement) -> Vec<Window> {
    let back = placement.rotation.transpose();
    let per_area = 1.0 / (placement.pitch * placement.pitch);
    let positions = clusters
        .iter()
        .map(|cluster| placement.lattice(cluster.centre));
    let grid = Grid::about(positions, RADIUS, ());
    let mut sums = Sums::new(&grid);
    for cluster in clusters {
        let piece = Cluster {
            centre: placement.lattice(cluster.centre),
            area: back * cluster.area * per_area,
            moment: cluster.moment * per_area / placement.pitch,
            weight: cluster.weight * per_area,
        };
        sums.add(&piece, &grid);
    }
    let window = |place| {
        let weight = weight(sums.energies[place]);
        (weight > 0.0).then(|| Window {
            index: grid.index(place),
            flux: sums.fluxes[place],
            weight,
            dither: 0.0,
        })
    };
    (0..grid.values.len()).filter_map(window).collect()
}

/// Lattice points along an axis that a window of [`RADIUS`] can reach, rounded up to what a processor adds at once.
const LANES: usize = 4;
const REACHED: i32 = 3;

/// The integrals of all windows of a grid. What a window sees of a piece beyond its radius is an exact 0, so that rows of
/// windows are added to without asking which of them are near: that is four times as fast, and the sums are the same.
struct Sums {
    fluxes: Vec<f64>,
    energies: Vec<f64>,
}

impl Sums {
    fn new(grid: &Grid<()>) -> Sums {
        let len = grid.values.len();
        let spare = (grid.size[1] + 1) * grid.size[2] + LANES;
        Sums {
            fluxes: vec![0.0; len + spare],
            energies: vec![0.0; len + spare],
        }
    }

    /// Adds a piece in lattice coordinates.
    fn add(&mut self, piece: &Cluster, grid: &Grid<()>) {
        const SQUARE: f64 = RADIUS * RADIUS;
        let (y, area) = (piece.centre, piece.area);
        let [x0, y0, z0] = (y - RADIUS).to_array().map(ceil);
        let z: [f64; LANES] = std::array::from_fn(|lane| y.z - f64::from(z0 + lane as i32));
        let z_part = z.map(|z| z * area.z);
        let z_square = z.map(|z| z * z);
        for i in 0..REACHED {
            let x = y.x - f64::from(x0 + i);
            let start = grid.place([x0 + i, y0, z0]);
            for j in 0..REACHED {
                let dy = y.y - f64::from(y0 + j);
                let plane = x * x + dy * dy;
                if plane >= SQUARE {
                    continue;
                }
                let across = x * area.x + dy * area.y;
                let place = start + j as usize * grid.size[2];
                let q2 = z_square.map(|z_square| (plane + z_square) / SQUARE);
                let inside = q2.map(|q2| if q2 < 1.0 { 1.0 - q2 } else { 0.0 });
                let flux = each(|lane| {
                    inside[lane] * inside[lane] * (across + z_part[lane] + piece.moment)
                });
                let energy = each(|lane| {
                    let g = inside[lane] * (3.0 - 7.0 * q2[lane]);
                    piece.weight * g * g
                });
                add(&mut self.fluxes[place..], flux);
                add(&mut self.energies[place..], energy);
            }
        }
    }
}

fn each(f: impl FnMut(usize) -> f64) -> [f64; LANES] {
    std::array::from_fn(f)
}

/// Adds terms to the first of some sums.
fn add(sums: &mut [f64], terms: [f64; LANES]) {
    if let Some(sums) = sums.first_chunk_mut::<LANES>() {
        let added = each(|lane| sums[lane] + terms[lane]);
        *sums = added;
    }
}
