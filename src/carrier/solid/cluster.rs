//! A surface in small pieces: each cell of a fine grid keeps of the surface in it a centroid, an area vector and the first
//! moment `m = sum (y - centroid) . a`. What a window sees of a cell then takes a few operations, however many triangles there are.

use super::grid::floor;
use super::lattice::RADIUS;
use crate::geometry::{Pose, Quadrature, Sample};
use crate::mesh::Mesh;
use crate::order::order_by;
use glam::DVec3;

/// Triangles are split until their parts are no longer or wider than this, in pitches. With a quarter 13 models that artists made hold a tenth
/// less.
pub const EDGE: f64 = 1.0 / 6.0;

/// Cells are so many times smaller than the lattice's pitch: four would be worth a fiftieth of the exponent, and double the
/// evidence.
pub const CELLS_PER_PITCH: f64 = 3.0;

/// What lies further from the centre, in units of the frame, is left out: it has no neighbours to make windows with.
pub const EXTENT: f64 = 4.0;

/// Parts that a surface is split into, at most, unless it has more triangles. Of 30 models that artists made a ship has the most, 0.24
/// million; the usual has 0.06 million.
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
    let (cell, per_cell) = (pitch / CELLS_PER_PITCH, CELLS_PER_PITCH / pitch);
    let in_frame = mesh.positions.iter().map(|point| pose.canonical(*point));
    let in_frame: Vec<DVec3> = in_frame.collect();
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| in_frame[vertex as usize]);
    let triangles = mesh.triangles.iter().map(corners);
    let quadrature = Quadrature::new(EDGE * pitch).at_most(MOST_PARTS, triangles.clone());
    let mut cells = Cells::default();
    for Sample { point, area, .. } in triangles.flat_map(|corners| quadrature.samples(corners)) {
        if point.abs().max_element() >= EXTENT {
            continue;
        }
        let corner = (point * per_cell).to_array();
        let corner = DVec3::from_array(corner.map(|c| f64::from(floor(c))));
        let offset = point - corner * cell;
        let weight = area.length();
        let sum = cells.at(number(corner));
        sum.centre += offset * weight;
        sum.area += area;
        sum.moment += offset.dot(area);
        sum.weight += weight;
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

/// Clusters of clusters: those in one cell of a grid become one. In increasing order of their cells.
pub fn merged(clusters: &[Cluster], cell: f64) -> Vec<Cluster> {
    let order = order_by(clusters.iter().map(|c| number((c.centre / cell).floor())));
    let cells = order.chunk_by(|a, b| a.0 == b.0);
    let merge = |cell: &[(u64, u32)]| {
        let members = || cell.iter().map(|&(_, index)| &clusters[index as usize]);
        let weight: f64 = members().map(|member| member.weight).sum();
        let weighted: DVec3 = members().map(|member| member.centre * member.weight).sum();
        let centre = weighted / weight;
        let moment = |member: &Cluster| member.moment + (member.centre - centre).dot(member.area);
        Cluster {
            centre,
            area: members().map(|member| member.area).sum(),
            moment: members().map(moment).sum(),
            weight,
        }
    };
    cells.map(merge).collect()
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
    /// The index of the cell that was met last: it is mostly met again.
    last: usize,
}

impl Cells {
    fn at(&mut self, number: u64) -> &mut Cluster {
        if self
            .found
            .get(self.last)
            .is_none_or(|last| last.0 != number)
        {
            self.last = self.find(number);
        }
        &mut self.found[self.last].1
    }

    /// The index of a cell, which is made if there is none yet.
    fn find(&mut self, number: u64) -> usize {
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
        self.slots[slot] as usize - 1
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
