//! Simplification by quadric error metrics.

use super::editing::Editable;
use crate::geometry::Quadric;
use crate::mesh::Mesh;
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The planes that hold a border in place, against those of the faces.
const BORDER_WEIGHT: f64 = 10.0;
/// Candidates that a collapse mostly gives at most: with room for so many, those out of date are dropped before it has to grow.
const MOST_AT_ONCE: usize = 64;

/// Simplifies until the `fraction` (0 to 1) of the faces is gone. Each collapse removes an edge, and two faces inside, so this
/// is about the fraction of the edges too. The LIRIS benchmark (Wang et al. 2010) removes 10 to 97.5 %.
pub fn simplify(mesh: &Mesh, fraction: f64) -> Mesh {
    simplify_to(
        mesh,
        ((1.0 - fraction) * mesh.triangles.len() as f64).round() as usize,
    )
}

/// Collapses edges, the one that changes the surface least first, until no more than `num_faces` are left: quadric error metrics
/// (Garland and Heckbert 1997), weighted by area, with their planes through borders. Inside, each collapse removes two faces.
/// Stops earlier where no collapse is left that keeps the surface's topology and turns no face over. O(F log F).
pub fn simplify_to(mesh: &Mesh, num_faces: usize) -> Mesh {
    let mut editable = Editable::new(mesh);
    let mut quadrics = quadrics(&editable, mesh);
    // Counts a vertex's changes: a candidate of another count is out of date.
    let mut ages = vec![0u32; mesh.positions.len()];
    let candidate = |editable: &Editable, quadrics: &[Quadric], ages: &[u32], a: u32, b: u32| {
        let (_, cost) = placed(editable, quadrics, a, b);
        // Costs are not negative, so their bits are in their order.
        Reverse((cost.to_bits(), a, b, ages[a as usize], ages[b as usize]))
    };
    let edges = editable.edges();
    let mut heap = BinaryHeap::with_capacity(edges.len() / 4 * 5 + MOST_AT_ONCE);
    heap.extend(
        edges
            .into_iter()
            .map(|[a, b]| candidate(&editable, &quadrics, &ages, a, b)),
    );
    while editable.num_faces() > num_faces {
        let Some(Reverse((_, a, b, age_a, age_b))) = heap.pop() else {
            break;
        };
        if (age_a, age_b) != (ages[a as usize], ages[b as usize]) {
            continue;
        }
        let (to, _) = placed(&editable, &quadrics, a, b);
        if !editable.collapse(a, b, to) {
            continue;
        }
        quadrics[a as usize] = quadrics[a as usize].plus(&quadrics[b as usize]);
        ages[a as usize] += 1;
        ages[b as usize] += 1;
        if heap.len() + MOST_AT_ONCE > heap.capacity() {
            heap.retain(|Reverse((_, a, b, age_a, age_b))| {
                (*age_a, *age_b) == (ages[*a as usize], ages[*b as usize])
            });
        }
        for neighbour in editable.neighbours(a) {
            let (a, b) = (a.min(neighbour), a.max(neighbour));
            heap.push(candidate(&editable, &quadrics, &ages, a, b));
        }
    }
    editable.into_mesh()
}

/// Where an edge's vertex goes, and what that costs.
fn placed(editable: &Editable, quadrics: &[Quadric], a: u32, b: u32) -> (DVec3, f64) {
    let sum = quadrics[a as usize].plus(&quadrics[b as usize]);
    let to = sum.minimum(editable.at(a).midpoint(editable.at(b)));
    (to, sum.at(to).max(0.0))
}

/// The planes of each vertex's faces, and those that stand on its borders.
fn quadrics(editable: &Editable, mesh: &Mesh) -> Vec<Quadric> {
    let mut quadrics = vec![Quadric::ZERO; mesh.positions.len()];
    let mut add = |vertex: u32, quadric: &Quadric| {
        quadrics[vertex as usize] = quadrics[vertex as usize].plus(quadric);
    };
    for &face in &mesh.triangles {
        let normal = editable.normal(face);
        let through = editable.at(face[0]);
        let quadric = Quadric::plane(normal.normalize_or_zero(), through, normal.length() / 2.0);
        face.iter().for_each(|&v| add(v, &quadric));
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (face[i], face[j])) {
            if editable.apexes(a, b).len() != 2 {
                let along = editable.at(b) - editable.at(a);
                let across = along.cross(normal).normalize_or_zero();
                let weight = BORDER_WEIGHT * along.length_squared();
                let quadric = Quadric::plane(across, editable.at(a), weight);
                [a, b].iter().for_each(|&v| add(v, &quadric));
            }
        }
    }
    quadrics
}
