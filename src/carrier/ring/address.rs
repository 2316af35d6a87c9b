//! The address of a ring: who it is, whatever it is called in a file.

use super::feature::{Features, Neighbourhoods};
use crate::geometry::Pose;
use crate::mesh::{Mesh, Rings};
use crate::order::order_by;
use glam::DVec3;

/// What an address is a hash of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddressKind {
    /// The valences within two edges: says nothing of geometry, so that any displacement leaves it alone.
    Connectivity,
    /// The valence and coarse ratios of the ring's lengths: for meshes whose connectivity is regular.
    Geometry,
    /// The cell of the model's own frame that the vertex lies in, with the frame's axes turned one of four ways: for regular
    /// and small meshes. A crop moves the frame, and the mark is lost.
    Position(Turn),
}

/// Which of a frame's axes are turned over: none, or two of the three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    None,
    AboutFirst,
    AboutSecond,
    AboutThird,
}

impl Turn {
    pub const ALL: [Turn; 4] = [
        Turn::None,
        Turn::AboutFirst,
        Turn::AboutSecond,
        Turn::AboutThird,
    ];

    fn turned_axes(self) -> [bool; 3] {
        match self {
            Turn::None => [false, false, false],
            Turn::AboutFirst => [false, true, true],
            Turn::AboutSecond => [true, false, true],
            Turn::AboutThird => [true, true, false],
        }
    }
}

/// Below so many addresses of one kind, the embedder looks at the next.
const FEW_ADDRESSES: usize = 300;

/// Side of a cell, in units of the frame: about 1.3 % of the diagonal. Of a regular mesh, quantization to 12 bits puts 3 % of
/// the vertices into another cell.
const CELL: f64 = 0.06;

/// Frames whose axes are less distinct are not used: rounding would turn them.
const LEAST_DISTINCTNESS: f64 = 0.01;

/// The kind of address that an embedder takes, with the number of addresses whose rings carry symbols: the first that has
/// enough, for each survives more than the next; else that with most.
pub fn choose(
    mesh: &Mesh,
    by_connectivity: &[u64],
    by_geometry: &[u64],
    usable: &[u32],
    instances: &[u32],
) -> (AddressKind, usize) {
    let count = |addresses: &[u64]| lone(&used(addresses, usable), usable, instances).count();
    let connectivity = count(by_connectivity);
    if connectivity >= FEW_ADDRESSES {
        return (AddressKind::Connectivity, connectivity);
    }
    let geometry = count(by_geometry);
    if geometry >= FEW_ADDRESSES {
        return (AddressKind::Geometry, geometry);
    }
    let pose = Pose::of(mesh).filter(|pose| pose.distinctness() >= LEAST_DISTINCTNESS);
    let position = pose.map_or(0, |pose| {
        let cells = cells(&mesh.positions, &pose).into_iter();
        let by_position: Vec<u64> = cells.map(|cell| by_position(cell, Turn::None)).collect();
        count(&by_position)
    });
    let kinds = [
        (AddressKind::Connectivity, connectivity),
        (AddressKind::Geometry, geometry),
        (AddressKind::Position(Turn::None), position),
    ];
    kinds
        .into_iter()
        .rev()
        .max_by_key(|&(_, count)| count)
        .unwrap_or(kinds[0])
}

/// The usable rings that carry symbols, ascending: those whose address no other ring has, but instances of their own. Rings of one address
/// share its dither, so marked ones would agree with each other, and anybody could see that without the key: by 66 standard
/// deviations on the bunny. Vertices with one number in `instances` are instances of one.
pub fn carriers(addresses: &[u64], usable: &[u32], instances: &[u32]) -> Vec<u32> {
    // A mesh that has lost its frame has no addresses.
    if addresses.is_empty() {
        return Vec::new();
    }
    let order = used(addresses, usable);
    let groups = lone(&order, usable, instances).flatten();
    let mut carriers: Vec<u32> = groups.map(|&(_, index)| usable[index as usize]).collect();
    carriers.sort_unstable();
    carriers
}

/// The addresses of usable rings, ascending, each with its ring's place among them.
fn used(addresses: &[u64], usable: &[u32]) -> Vec<(u64, u32)> {
    order_by(usable.iter().map(|&v| addresses[v as usize]))
}

/// The rings of each address that only instances of one ring have.
fn lone<'a>(
    order: &'a [(u64, u32)],
    usable: &'a [u32],
    instances: &'a [u32],
) -> impl Iterator<Item = &'a [(u64, u32)]> {
    let vertex = |index: u32| instances[usable[index as usize] as usize];
    let groups = order.chunk_by(|a, b| a.0 == b.0);
    groups.filter(move |group| {
        group
            .iter()
            .all(|&(_, index)| vertex(index) == vertex(group[0].1))
    })
}

/// V addresses by connectivity: two rounds of Weisfeiler-Leman refinement that start from the valences.
pub fn by_connectivity(rings: &Rings) -> Vec<u64> {
    let mut hashes: Vec<u64> = (0..rings.len())
        .map(|v| mix(rings.valence(v) as u64 + 77))
        .collect();
    for _ in 0..2 {
        hashes = (0..rings.len())
            .map(|v| {
                let start = hashes[v].wrapping_mul(0x9E37_79B9_7F4A_7C15);
                mix(rings
                    .neighbours(v)
                    .iter()
                    .fold(start, |sum, &n| sum.wrapping_add(hashes[n as usize])))
            })
            .collect();
    }
    hashes
}

/// V addresses by geometry: valence, and logarithms in bins of the ring's area to that of its neighbours' rings, of its
/// longest spoke to the shortest, and of its mean square spoke to its area.
pub fn by_geometry(
    positions: &[DVec3],
    neighbourhoods: &Neighbourhoods,
    features: &Features,
) -> Vec<u64> {
    let rings = &neighbourhoods.rings;
    let areas: Vec<f64> = features.sizes.iter().map(|size| size * size).collect();
    (0..rings.len())
        .map(|v| {
            let neighbours = rings.neighbours(v);
            let count = neighbours.len().max(1) as f64;
            let mean_area = neighbours.iter().map(|&n| areas[n as usize]).sum::<f64>() / count;
            let squares = || {
                neighbours
                    .iter()
                    .map(|&n| positions[v].distance_squared(positions[n as usize]))
            };
            let mean_square = squares().sum::<f64>() / count;
            let (shortest, longest) =
                squares().fold((f64::MAX, 0.0), |(s, l), q| (q.min(s), q.max(l)));
            let bins = [
                bin(areas[v] / mean_area, 0.15),
                bin((longest / shortest).sqrt(), 0.35),
                bin(mean_square / areas[v], 0.3),
            ];
            let packed = bins.iter().fold(neighbours.len() as u64, |packed, bin| {
                packed.wrapping_mul(1024).wrapping_add(*bin)
            });
            mix(packed.wrapping_add(12345))
        })
        .collect()
}

/// A cell of a frame, by its number along each axis.
pub type Cell = [i16; 3];

/// The farthest cell along an axis: what lies beyond counts as there.
pub const FARTHEST_CELL: i16 = 32_000;

/// The cells of V positions.
pub fn cells(positions: &[DVec3], pose: &Pose) -> Vec<Cell> {
    let farthest = f64::from(FARTHEST_CELL);
    let number = |coordinate: f64| (coordinate / CELL).floor().clamp(-farthest, farthest) as i16;
    positions
        .iter()
        .map(|&p| pose.canonical(p).to_array().map(number))
        .collect()
}

/// The address of a cell, seen in a turned frame, in which number n becomes -n - 1, which is `!n`. Different cells may have one
/// address: whoever reads sums by address, not by cell.
pub fn by_position(cell: Cell, turn: Turn) -> u64 {
    let numbers = cell.into_iter().zip(turn.turned_axes());
    let seen = numbers.map(|(number, turned)| if turned { !number } else { number });
    mix(seen.fold(54321, |hash, number| mix(hash).wrapping_add(number as u64)))
}

/// The bin of a ratio's binary logarithm, 12 to 1012; 512 for ratios that are no number.
fn bin(ratio: f64, width: f64) -> u64 {
    let bin = (libm::log2(ratio) / width).floor();
    if bin.is_finite() {
        (bin.clamp(-500.0, 500.0) + 512.0) as u64
    } else {
        512
    }
}

/// The finalizer of SplitMix64 (Steele, Lea and Flood 2014).
fn mix(x: u64) -> u64 {
    let x = (x ^ x >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ x >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ x >> 31
}
