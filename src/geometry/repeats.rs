//! Triangles that are there more than once, turned over or not: a person sees one.

use crate::mesh::{Edges, Mesh};
use crate::order::order_by;
use glam::DVec3;

/// Says of each triangle whether it is the first with its three vertices, and turns some; `None` if all are.
///
/// Where both directions are there, the one that is left faces as the triangles of its patch do that are there in one; where there are
/// none, or as many of each, so that the patch's volume about its centroid is positive. O(F log F).
pub fn without_repeats(mesh: &mut Mesh) -> Option<Vec<bool>> {
    let mut kept = vec![true; mesh.triangles.len()];
    let mut has_both = vec![false; mesh.triangles.len()];
    for same in by_corners(mesh).chunk_by(|a, b| a.0 == b.0) {
        if let [(_, first), others @ ..] = same {
            let is_even = |triangle: u32| is_even(mesh.triangles[triangle as usize]);
            for &(_, other) in others {
                kept[other as usize] = false;
                has_both[*first as usize] |= is_even(other) != is_even(*first);
            }
        }
    }
    if has_both.contains(&true) {
        turn(mesh, &kept, &has_both);
    }
    kept.contains(&false).then_some(kept)
}

/// The triangles by their vertices, lowest first: equal ones side by side, in their order.
fn by_corners(mesh: &Mesh) -> Vec<([u32; 3], u32)> {
    let sorted = |triangle: u32| {
        let [a, b, c] = mesh.triangles[triangle as usize];
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        [low, a ^ b ^ c ^ low ^ high, high]
    };
    let numbers = 0..mesh.triangles.len() as u32;
    let side = |[low, middle, _]: [u32; 3]| u64::from(low) << 32 | u64::from(middle);
    let by_side = order_by(numbers.map(|triangle| side(sorted(triangle))));
    let mut all = Vec::with_capacity(by_side.len());
    for same in by_side.chunk_by(|a, b| a.0 == b.0) {
        let thirds = same
            .iter()
            .map(|&(_, triangle)| u64::from(sorted(triangle)[2]));
        match same {
            [(_, triangle)] => all.push((sorted(*triangle), *triangle)),
            _ => all.extend(order_by(thirds).into_iter().map(|(_, place)| {
                let triangle = same[place as usize].1;
                (sorted(triangle), triangle)
            })),
        }
    }
    all
}

/// Whether the corners are the rising ones, turned about.
fn is_even([a, b, c]: [u32; 3]) -> bool {
    [a < b, b < c, c < a].map(u32::from).iter().sum::<u32>() == 2
}

/// Turns those of the kept triangles whose direction is open.
fn turn(mesh: &mut Mesh, kept: &[bool], is_open: &[bool]) {
    let numbers = || (0..kept.len()).filter(|number| kept[*number]);
    let once = Mesh {
        triangles: numbers().map(|number| mesh.triangles[number]).collect(),
        positions: std::mem::take(&mut mesh.positions),
    };
    let winding = Edges::new(&once).winding();
    let faces = || {
        let turned = once.triangles.iter().zip(&winding.flips);
        let turned = turned.map(|(&[a, b, c], &flip)| if flip { [a, c, b] } else { [a, b, c] });
        let patches = winding.patches.iter().map(|&patch| patch as usize);
        numbers().zip(turned).zip(patches)
    };
    let mut patches = vec![Patch::default(); winding.num_patches];
    for (((number, triangle), patch), &flip) in faces().zip(&winding.flips) {
        let patch = &mut patches[patch];
        if !is_open[number] {
            patch.known += if flip { -1 } else { 1 };
        }
        let [a, b, c] = once.corners(triangle);
        let facing = (b - a).cross(c - a);
        patch.area += facing.length();
        patch.facing += facing;
        patch.first += (a + b + c) * (facing.length() / 3.0);
    }
    for ((_, triangle), patch) in faces() {
        let patch = &mut patches[patch];
        let centroid = patch.first / patch.area;
        let [a, b, c] = once.corners(triangle).map(|corner| corner - centroid);
        patch.volume += a.dot(b.cross(c));
    }
    for ((number, [a, b, c]), patch) in faces() {
        if is_open[number] {
            let is_inward = patches[patch].faces_inwards();
            mesh.triangles[number] = if is_inward { [a, c, b] } else { [a, b, c] };
        }
    }
    mesh.positions = once.positions;
}

/// Sums over a patch with consistent winding.
#[derive(Clone, Default)]
struct Patch {
    /// Triangles that face as they did, less those that were turned, of those that are there in one direction.
    known: i64,
    area: f64,
    facing: DVec3,
    first: DVec3,
    volume: f64,
}

impl Patch {
    fn faces_inwards(&self) -> bool {
        if self.known != 0 {
            return self.known < 0;
        }
        if self.volume != 0.0 {
            return self.volume < 0.0;
        }
        // A plane faces along the first axis that it can.
        let facing = self.facing.to_array();
        facing.into_iter().find(|part| *part != 0.0) < Some(0.0)
    }
}
