//! The mean filter of normals (Yagou, Ohtake and Belyaev 2002), equations 2 to 4 of the seed paper.

use crate::geometry::face_areas;
use crate::mesh::{Edges, Mesh};
use glam::{DMat3, DVec3};

/// Triangles are taken to be no thinner than this, twice the area over the square of the side across from the vertex.
const THINNEST: f64 = 1e-6;
/// The part of its system's trace that is added to the diagonal: in a plane a vertex may lie anywhere, and stays.
const RIDGE: f64 = 1e-9;

/// Averages the normals of faces and fits vertices to them, `steps` times. Vertices are fitted one after another, in their order,
/// each to where those before it have gone: the sum of equation 3 over the mesh falls with every one, which it does not when all
/// move at once. Vertices whose rings are not closed stay.
pub fn mean_filter(mesh: &Mesh, steps: u32) -> Mesh {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let faces_at = FacesAt::new(mesh);
    let mut filtered = mesh.clone();
    for _ in 0..steps {
        let normals = averaged(&filtered, &faces_at);
        for v in (0..mesh.positions.len()).filter(|&v| rings.is_closed(v)) {
            filtered.positions[v] = fitted(&filtered, faces_at.of(v), &normals, v);
        }
    }
    filtered
}

/// Equation 2: m(T), the direction of the sum of A(S) n(S) over the triangles S that have an edge or a vertex in common with T,
/// and T itself.
fn averaged(mesh: &Mesh, faces_at: &FacesAt) -> Vec<DVec3> {
    let areas = face_areas(mesh);
    let mut near = Vec::new();
    let average = |triangle: &[u32; 3]| {
        near.clear();
        triangle
            .iter()
            .for_each(|&v| near.extend(faces_at.of(v as usize)));
        near.sort_unstable();
        near.dedup();
        let sum: DVec3 = near.iter().map(|&face: &u32| areas[face as usize]).sum();
        sum.normalize_or_zero()
    };
    mesh.triangles.iter().map(average).collect()
}

/// Equation 4: where a vertex P minimises equation 3, the sum of A(T) |n(T) - m(T)|^2 over its triangles, while all others stay and
/// A(T) is what it is: with n(T) as area vector over A(T), which is linear in P, three linear equations. (With A(T) following P the
/// sum is 2 (|a| - a . m) for area vectors a: hardly anything then holds a vertex along the surface, and triangles fold.)
fn fitted(mesh: &Mesh, faces: &[u32], normals: &[DVec3], vertex: usize) -> DVec3 {
    let position = mesh.positions[vertex];
    let (mut system, mut slope) = (DMat3::ZERO, DVec3::ZERO);
    for &face in faces {
        let triangle = mesh.triangles[face as usize];
        let at = triangle
            .iter()
            .position(|&v| v as usize == vertex)
            .unwrap_or(0);
        let [b, c] = [1, 2].map(|next| mesh.positions[triangle[(at + next) % 3] as usize]);
        let (across, twice_area) = (c - b, (b - position).cross(c - position));
        let size = twice_area.length().max(THINNEST * across.length_squared());
        if size > 0.0 {
            slope += (twice_area / size - normals[face as usize]).cross(across);
            let square = DMat3::from_diagonal(DVec3::splat(across.length_squared()));
            let outer = DMat3::from_cols(across * across.x, across * across.y, across * across.z);
            system += (square - outer) * (1.0 / size);
        }
    }
    let ridge = RIDGE * (system.x_axis.x + system.y_axis.y + system.z_axis.z);
    if ridge > 0.0 {
        position - (system + DMat3::from_diagonal(DVec3::splat(ridge))).inverse() * slope
    } else {
        position
    }
}

/// The faces at each vertex, ascending.
struct FacesAt {
    starts: Vec<usize>,
    faces: Vec<u32>,
}

impl FacesAt {
    fn new(mesh: &Mesh) -> FacesAt {
        let mut starts = vec![0; mesh.positions.len() + 1];
        for vertex in mesh.triangles.iter().flatten() {
            starts[*vertex as usize + 1] += 1;
        }
        for v in 0..mesh.positions.len() {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut faces = vec![0; 3 * mesh.triangles.len()];
        for (name, triangle) in (0..).zip(&mesh.triangles) {
            for &vertex in triangle {
                let slot = &mut next[vertex as usize];
                faces[*slot] = name;
                *slot += 1;
            }
        }
        FacesAt { starts, faces }
    }

    fn of(&self, vertex: usize) -> &[u32] {
        &self.faces[self.starts[vertex]..self.starts[vertex + 1]]
    }
}
