//! The statistic: the windowed flux of the oriented surface at the points of a lattice, a band-passed occupancy field.
//!
//! It is an integral over the surface, so tessellation drops out. In units of the lattice's pitch, with q = |y - L| / R < 1
//! about a lattice point L, `F = integral of (1 - q^2)^2 (y - L) . dA`; a displacement d of the surface changes it by
//! `integral of g d . dA` with `g = (1 - q^2)(3 - 7 q^2)`. The surface is first gathered in small cells, each kept as a
//! centroid, an area vector and the first moment `m = sum (y - centroid) . a`: one evaluation then costs a few operations
//! for each cell and window.

use crate::geometry::{Pose, Quadrature};
use crate::mesh::Mesh;
use crate::order::order_by;
use glam::{DMat3, DVec3};

/// Radius of a window, in pitches.
pub const RADIUS: f64 = 1.2;

/// Triangles are split until their edges are no longer than this, in pitches.
pub const EDGE: f64 = 1.0 / 3.0;

/// Cells are so many times smaller than the lattice's pitch: four would be worth a fiftieth of the exponent, and double the
/// evidence.
pub const CELLS_PER_PITCH: f64 = 3.0;

/// What lies further from the centre, in units of the frame, is left out: it has no neighbours to make windows with.
pub const EXTENT: f64 = 4.0;

/// Parts that a surface is split into, at most, unless it has more triangles. A fence of 640 triangles in long planks has 1.8
/// million, the most of 41 models that artists made; the usual has 0.3 million.
pub const MOST_PARTS: u64 = 1 << 21;

/// Clusters that are kept of a surface, at most, the heaviest. Of the same models none has more than 25 200, for the area of what
/// is read is limited; needles without an area can be met in any number of cells.
pub const MOST_CLUSTERS: usize = 1 << 16;

/// Lattice points in the box of all clusters, at most: what tables are made for. Of the same models the largest has 59 000, a
/// plant; most have 20 000. Specks far from everything else make it large, and are then left out.
const MOST_POINTS: f64 = (1 << 17) as f64;

/// A small piece of surface, in the canonical frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cluster {
    /// Area-weighted centroid.
    pub centre: DVec3,
    /// Sum of area vectors.
    pub area: DVec3,
    /// Sum of `(y - centre) . a`.
    pub moment: f64,
    /// Sum of areas.
    pub weight: f64,
}

/// Gathers a surface in clusters fine enough for a pitch, in the frame of a pose, in increasing order of their cells. The
/// triangles have to face outwards. What the suspect's maker can ask for is limited: time and memory of all that follows depend on
/// [`MOST_CLUSTERS`] and on [`fits`], not on the file.
pub fn clusters(mesh: &Mesh, pose: &Pose, pitch: f64) -> Vec<Cluster> {
    let cell = pitch / CELLS_PER_PITCH;
    let corners = mesh
        .triangles
        .iter()
        .map(|&triangle| mesh.corners(triangle));
    let quadrature = Quadrature::new(EDGE * pitch * pose.size).at_most(MOST_PARTS, corners);
    let to_frame = pose.axes.transpose() * (1.0 / (pose.size * pose.size));
    let mut cells = Cells::default();
    for &triangle in &mesh.triangles {
        for sample in quadrature.samples(mesh.corners(triangle)) {
            let y = pose.canonical(sample.point);
            if y.abs().max_element() >= EXTENT {
                continue;
            }
            let corner = (y / cell).floor();
            let area = to_frame * sample.area;
            let weight = area.length();
            let offset = y - corner * cell;
            let sum = cells.at(number(corner));
            sum.centre += offset * weight;
            sum.area += area;
            sum.moment += offset.dot(area);
            sum.weight += weight;
        }
    }
    let order = order_by(cells.found.iter().map(|(number, _)| *number));
    let clusters = order.iter().map(|&(number, index)| {
        let sum = cells.found[index as usize].1;
        let centre = sum.centre / sum.weight;
        Cluster {
            centre: corner(number) * cell + centre,
            moment: sum.moment - centre.dot(sum.area),
            ..sum
        }
    });
    let clusters = clusters.filter(|cluster| cluster.weight > 0.0).collect();
    nearest(heaviest(clusters), pitch)
}

/// The heaviest clusters, in their order, if there are too many.
fn heaviest(clusters: Vec<Cluster>) -> Vec<Cluster> {
    if clusters.len() <= MOST_CLUSTERS {
        return clusters;
    }
    let by_weight = order_by(clusters.iter().map(|cluster| !cluster.weight.to_bits()));
    let mut kept: Vec<u32> = by_weight[..MOST_CLUSTERS]
        .iter()
        .map(|kept| kept.1)
        .collect();
    kept.sort_unstable();
    kept.iter().map(|&kept| clusters[kept as usize]).collect()
}

/// The clusters, in their order, without those that lie farthest along an axis if the box of all is too large.
fn nearest(mut clusters: Vec<Cluster>, pitch: f64) -> Vec<Cluster> {
    let reach = |cluster: &Cluster| cluster.centre.abs().max_element();
    if fits(clusters.iter().map(|cluster| cluster.centre), pitch) {
        return clusters;
    }
    let by_reach = order_by(clusters.iter().map(|cluster| reach(cluster).to_bits()));
    let mut within = Span::default();
    let farthest = by_reach.iter().find(|(_, index)| {
        within.add(clusters[*index as usize].centre);
        !within.fits(pitch)
    });
    if let Some(&(farthest, _)) = farthest {
        clusters.retain(|cluster| reach(cluster).to_bits() < farthest);
    }
    clusters
}

/// Whether the box of some positions is small enough for tables.
pub fn fits(positions: impl Iterator<Item = DVec3>, pitch: f64) -> bool {
    let mut span = Span::default();
    positions.for_each(|position| span.add(position));
    span.fits(pitch)
}

/// The box of some positions.
struct Span {
    low: DVec3,
    high: DVec3,
}

impl Default for Span {
    fn default() -> Span {
        Span {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
        }
    }
}

impl Span {
    fn add(&mut self, position: DVec3) {
        self.low = self.low.min(position);
        self.high = self.high.max(position);
    }

    /// Whether the lattice points whose windows reach into the box are few enough.
    fn fits(&self, pitch: f64) -> bool {
        let points = (self.high - self.low).max(DVec3::ZERO) / pitch + 2.0 * RADIUS;
        points.element_product() <= MOST_POINTS
    }
}

/// Cells are counted from here, so that their coordinates are not negative.
const ORIGIN: i64 = 1 << 19;

/// The number of a cell, by its integer coordinates.
pub fn number(corner: DVec3) -> u64 {
    let part = |coordinate: f64| (coordinate as i64 + ORIGIN) as u64;
    part(corner.x) << 40 | part(corner.y) << 20 | part(corner.z)
}

/// The integer coordinates of a cell.
pub fn corner(number: u64) -> DVec3 {
    let part = |shift: u32| ((number >> shift & 0xf_ffff) as i64 - ORIGIN) as f64;
    DVec3::new(part(40), part(20), part(0))
}

/// Sums by cell: an open hash table that keeps the order in which cells were met.
#[derive(Default)]
struct Cells {
    found: Vec<(u64, Cluster)>,
    /// Index in `found` plus 1; 0 is free. A power of two, at most half full.
    slots: Vec<u32>,
}

impl Cells {
    fn at(&mut self, number: u64) -> &mut Cluster {
        if 2 * self.found.len() >= self.slots.len() {
            self.slots = vec![0; (4 * self.found.len()).next_power_of_two().max(1024)];
            for index in 0..self.found.len() {
                let slot = self.slot(self.found[index].0);
                self.slots[slot] = index as u32 + 1;
            }
        }
        let slot = self.slot(number);
        if self.slots[slot] == 0 {
            self.found.push((number, Cluster::default()));
            self.slots[slot] = self.found.len() as u32;
        }
        &mut self.found[self.slots[slot] as usize - 1].1
    }

    /// Where a number is, or would be (Fibonacci hashing, linear probing).
    fn slot(&self, number: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mut slot = (number.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.slots[slot] != 0 && self.found[self.slots[slot] as usize - 1].0 != number {
            slot = (slot + 1) & mask;
        }
        slot
    }
}

/// Where a lattice lies in the canonical frame: a point y has lattice coordinates `rotation^T (y - origin) / pitch`, in
/// which lattice points are whole numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    pub rotation: DMat3,
    pub origin: DVec3,
    pub pitch: f64,
}

impl Placement {
    /// This placement moved by a small similarity: translation and rotation vector in the frame, log of the scale.
    pub fn nudged(&self, x: &[f64; 7]) -> Placement {
        Placement {
            rotation: self.rotation * rotation(DVec3::new(x[3], x[4], x[5])),
            origin: self.origin + self.rotation * DVec3::new(x[0], x[1], x[2]),
            pitch: self.pitch * libm::exp(x[6]),
        }
    }

    /// The lattice coordinates of a point.
    pub fn lattice(&self, y: DVec3) -> DVec3 {
        self.rotation.transpose() * (y - self.origin) / self.pitch
    }

    /// The point at lattice coordinates.
    pub fn point(&self, lattice: DVec3) -> DVec3 {
        self.rotation * lattice * self.pitch + self.origin
    }
}

/// The rotation by a vector's length about its direction.
fn rotation(vector: DVec3) -> DMat3 {
    let angle = vector.length();
    if angle < 1e-12 {
        return DMat3::IDENTITY;
    }
    let half = vector * (libm::sin(0.5 * angle) / angle);
    DMat3::from_quat(glam::DQuat::from_xyzw(
        half.x,
        half.y,
        half.z,
        libm::cos(0.5 * angle),
    ))
}

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

/// Calls `visit` with every lattice point within a radius of a position, the offset from it and the squared distance relative
/// to the radius.
pub fn for_each_near(y: DVec3, radius: f64, mut visit: impl FnMut([i32; 3], DVec3, f64)) {
    let first = (y - radius).ceil();
    let last = (y + radius).floor();
    let mut point = first;
    while point.x <= last.x {
        let x = y.x - point.x;
        point.y = first.y;
        while point.y <= last.y {
            let dy = y.y - point.y;
            let plane = x * x + dy * dy;
            point.z = first.z;
            while plane < radius * radius && point.z <= last.z {
                let z = y.z - point.z;
                let q2 = (plane + z * z) / (radius * radius);
                if q2 < 1.0 {
                    let index = [point.x as i32, point.y as i32, point.z as i32];
                    visit(index, DVec3::new(x, dy, z), q2);
                }
                point.z += 1.0;
            }
            point.y += 1.0;
        }
        point.x += 1.0;
    }
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

/// A box of lattice points with a value for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<T> {
    pub low: [i32; 3],
    pub size: [usize; 3],
    pub values: Vec<T>,
}

impl<T: Clone> Grid<T> {
    /// A box that holds the windows of all positions.
    pub fn about(positions: impl Iterator<Item = DVec3>, margin: f64, value: T) -> Grid<T> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for y in positions {
            low = low.min(y);
            high = high.max(y);
        }
        if !(low.is_finite() && high.is_finite()) {
            (low, high) = (DVec3::ZERO, DVec3::ZERO);
        }
        let low = (low - margin).floor();
        let size = ((high + margin).ceil() - low)
            .to_array()
            .map(|extent| extent as usize + 1);
        Grid {
            low: low.to_array().map(|coordinate| coordinate as i32),
            size,
            values: vec![value; size[0] * size[1] * size[2]],
        }
    }

    /// Where the value of a lattice point is, if it is in the box.
    pub fn find(&self, index: [i32; 3]) -> Option<usize> {
        let inside = |axis: usize| {
            let offset = index[axis] - self.low[axis];
            offset >= 0 && (offset as usize) < self.size[axis]
        };
        (0..3).all(inside).then(|| self.place(index))
    }

    /// Where the value of a lattice point is that is known to be in the box.
    pub fn place(&self, index: [i32; 3]) -> usize {
        let [i, j, k] = [0, 1, 2].map(|axis| (index[axis] - self.low[axis]) as usize);
        (i * self.size[1] + j) * self.size[2] + k
    }

    /// The lattice point of a place.
    pub fn index(&self, place: usize) -> [i32; 3] {
        let [_, y, z] = self.size;
        let part = |axis: usize, offset: usize| self.low[axis] + offset as i32;
        [
            part(0, place / (y * z)),
            part(1, place / z % y),
            part(2, place % z),
        ]
    }
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

/// The smallest whole number that is not below a coordinate.
pub fn ceil(coordinate: f64) -> i32 {
    let whole = coordinate as i32;
    whole + i32::from(f64::from(whole) < coordinate)
}

/// The largest whole number that is not above a coordinate.
pub fn floor(coordinate: f64) -> i32 {
    let whole = coordinate as i32;
    whole - i32::from(f64::from(whole) > coordinate)
}
