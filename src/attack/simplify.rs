//! Simplification by quadric error metrics.

use super::collapse::{Collapse, Placement, Until};
use super::editing::Editable;
use crate::geometry::Quadric;
use crate::mesh::Mesh;
use glam::DVec3;

/// The planes that hold a border in place, against those of the faces.
const BORDER_WEIGHT: f64 = 10.0;

/// Simplifies until the `fraction` (0 to 1) of the edges is gone: quadric error metrics (Garland and Heckbert 1997), weighted by
/// area, with their planes through borders. Stops earlier where no collapse is left that keeps the surface's topology and turns
/// no face over. O(F log F).
pub fn simplify(mesh: &Mesh, fraction: f64) -> Mesh {
    let mut collapse = by_planes(mesh);
    collapse.run(Until::WithoutEdges(fraction));
    collapse.mesh()
}

/// The same until no more than `num_faces` are left.
pub fn simplify_to(mesh: &Mesh, num_faces: usize) -> Mesh {
    let mut collapse = by_planes(mesh);
    collapse.run(Until::Faces(num_faces));
    collapse.mesh()
}

fn by_planes(mesh: &Mesh) -> Collapse<Planes> {
    Collapse::new(mesh, |editable| Planes::new(mesh, editable))
}

/// The planes of each vertex's faces, and those that stand on its borders.
struct Planes(Vec<Quadric>);

impl Planes {
    fn new(mesh: &Mesh, editable: &Editable) -> Planes {
        let mut planes = Planes(vec![Quadric::ZERO; mesh.positions.len()]);
        for &face in &mesh.triangles {
            let normal = editable.normal(face);
            let through = editable.at(face[0]);
            let area = normal.length() / 2.0;
            let quadric = Quadric::plane(normal.normalize_or_zero(), through, area);
            face.iter().for_each(|&v| planes.add(v, &quadric));
            for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (face[i], face[j])) {
                if editable.is_border_edge(a, b) {
                    let along = editable.at(b) - editable.at(a);
                    let across = along.cross(normal).normalize_or_zero();
                    let weight = BORDER_WEIGHT * along.length_squared();
                    let quadric = Quadric::plane(across, editable.at(a), weight);
                    [a, b].iter().for_each(|&v| planes.add(v, &quadric));
                }
            }
        }
        planes
    }

    fn add(&mut self, vertex: u32, quadric: &Quadric) {
        self.0[vertex as usize] = self.0[vertex as usize].plus(quadric);
    }
}

impl Placement for Planes {
    fn place(&self, editable: &Editable, a: u32, b: u32) -> Option<(DVec3, f64)> {
        let sum = self.0[a as usize].plus(&self.0[b as usize]);
        let to = sum.minimum(editable.at(a).midpoint(editable.at(b)));
        Some((to, sum.at(to).max(0.0)))
    }

    fn merge(&mut self, kept: u32, lost: u32) {
        let quadric = self.0[lost as usize];
        self.add(kept, &quadric);
    }
}
