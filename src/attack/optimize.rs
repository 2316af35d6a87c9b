//! Simplification by a face threshold.

use super::editing::Editable;
use crate::mesh::Mesh;
use glam::DVec3;

/// The largest face threshold, degrees.
const LARGEST: u32 = 90;
/// Sweeps with a threshold end when one takes less than this part of the faces.
const LITTLE: f64 = 0.01;

/// Merges faces that lie nearly in one plane until no more than `num_faces` are left: what a modelling program's "Optimize" does,
/// with which the seed paper prepares its model ("a face threshold value 10"). A vertex goes to a neighbour of a lower index if no
/// two of its faces' normals are farther apart than the threshold, which rises by degrees. Nothing cares for the shape of what is
/// left: unlike [`simplify_to`](super::simplify_to), it leaves thin triangles. Borders stay. The program's own algorithm is not
/// published. O(F) for each sweep.
pub fn optimize(mesh: &Mesh, num_faces: usize) -> Mesh {
    let mut editable = Editable::new(mesh);
    for degrees in 1..=LARGEST {
        let threshold = libm::cos(f64::from(degrees).to_radians());
        loop {
            let before = editable.num_faces();
            sweep(&mut editable, threshold, num_faces);
            if (before - editable.num_faces()) as f64 <= LITTLE * before as f64 {
                break;
            }
        }
        if editable.num_faces() <= num_faces {
            break;
        }
    }
    editable.mesh()
}

fn sweep(editable: &mut Editable, threshold: f64, num_faces: usize) {
    for lost in 0..editable.positions.len() as u32 {
        if editable.num_faces() <= num_faces {
            break;
        }
        if is_flat(editable, lost, threshold) && !editable.is_border(lost) {
            let neighbours = editable.neighbours(lost).into_iter();
            let mut lower = neighbours.filter(|&neighbour| neighbour < lost);
            lower.any(|kept| editable.collapse(kept, lost, editable.at(kept)));
        }
    }
}

/// Whether all faces at a vertex look the same way, by the cosine of the largest angle between two.
fn is_flat(editable: &Editable, vertex: u32, threshold: f64) -> bool {
    let normals = editable
        .faces_at(vertex)
        .map(|face| editable.normal(face).normalize_or_zero());
    let normals: Vec<DVec3> = normals.collect();
    let mut firsts = normals.iter().enumerate();
    firsts.all(|(number, a)| normals[..number].iter().all(|b| a.dot(*b) >= threshold))
}
