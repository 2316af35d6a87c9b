//! The address of a ring: who it is, whatever it is called in a file.

use super::feature::{Features, Neighbourhoods};
use crate::mesh::Rings;
use glam::DVec3;

/// What an address is a hash of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddressKind {
    /// The valences within two edges: says nothing of geometry, so that any displacement leaves it alone.
    Connectivity,
    /// The valence and coarse ratios of the ring's lengths: for meshes whose connectivity is regular.
    Geometry,
}

impl AddressKind {
    pub const ALL: [AddressKind; 2] = [AddressKind::Connectivity, AddressKind::Geometry];
}

/// Distinct addresses without which a mark of 48 bits cannot be read: a key owns a quarter, and perfect agreement of
/// n addresses of equal weight gives ln p = -n + 48 ln 2 + ln 12, which must pass ln 1e-9.
pub const NEEDED_ADDRESSES: usize = 228;

/// Below so many distinct addresses by connectivity, the embedder takes addresses by geometry.
const FEW_ADDRESSES: usize = 300;

/// The kind of address that an embedder takes, with the number of distinct addresses it has to give.
pub fn choose(
    by_connectivity: &[u64],
    by_geometry: &[u64],
    usable: &[u32],
) -> (AddressKind, usize) {
    let (connectivity, geometry) = (
        num_distinct(by_connectivity, usable),
        num_distinct(by_geometry, usable),
    );
    if connectivity >= FEW_ADDRESSES || connectivity >= geometry {
        (AddressKind::Connectivity, connectivity)
    } else {
        (AddressKind::Geometry, geometry)
    }
}

fn num_distinct(addresses: &[u64], usable: &[u32]) -> usize {
    let mut used: Vec<u64> = usable.iter().map(|&v| addresses[v as usize]).collect();
    used.sort_unstable();
    used.dedup();
    used.len()
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
