//! Delaunay's triangles.

use super::editing::Editable;
use crate::mesh::Mesh;

/// Flips for each edge, on average: what does not end by then, as surfaces can that are not flat, stops.
const MOST: usize = 10;
/// Cosine of the angle between two faces, 30 degrees, from which a flip would carve the surface.
const FLAT: f64 = 0.866_025_403_784_438_6;
/// The sine of the angle by which two may sum to more than pi, so that four corners of one circle are left alone.
const LEAST: f64 = 1e-9;

/// Flips every edge whose opposite angles sum to more than pi, until none is left: the Delaunay triangulation of the surface's
/// vertices (Lawson 1977; on surfaces, Bobenko and Springborn 2007). Positions stay. So do edges between faces that differ by more than
/// 30 degrees, or whose flip would turn a face over, make one without area, or an edge that is there already. O(F) for most meshes.
pub fn delaunay(mesh: &Mesh) -> Mesh {
    let mut editable = Editable::new(mesh);
    let mut open = editable.edges();
    let mut left = MOST * open.len();
    // The first edge on top.
    open.reverse();
    while let Some([a, b]) = open.pop() {
        let Some([c, d]) = editable.opposite(a, b) else {
            continue;
        };
        if left == 0 || !is_to_flip(&editable, [a, b], [c, d]) || !editable.flip(a, b) {
            continue;
        }
        left -= 1;
        open.extend([[a, c], [c, b], [b, d], [d, a]]);
    }
    editable.mesh()
}

/// Whether the angles across from an edge sum to more than pi, on a surface that is nearly flat there.
fn is_to_flip(editable: &Editable, [a, b]: [u32; 2], apexes: [u32; 2]) -> bool {
    let [first, second] = apexes.map(|apex| {
        let (to_a, to_b) = (
            editable.at(a) - editable.at(apex),
            editable.at(b) - editable.at(apex),
        );
        let size = to_a.length() * to_b.length();
        let sine = to_a.cross(to_b).length();
        (sine / size, to_a.dot(to_b) / size)
    });
    let sine_of_sum = first.0 * second.1 + first.1 * second.0;
    sine_of_sum < -LEAST && !editable.is_crease(a, b, FLAT)
}
