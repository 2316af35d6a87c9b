//! What programs do to coordinates when they write a file.

use super::similarity;
use crate::geometry::diagonal;
use crate::mesh::Mesh;
use crate::random::Random;
use glam::DVec3;

/// Metres in an inch.
const INCH: f64 = 0.0254;

/// From y up to z up, in f32: no more than an exchange of numbers and signs.
pub fn swap_axes(mesh: &Mesh) -> Mesh {
    single(mesh, |p| DVec3::new(p.x, -p.z, p.y))
}

/// Node transforms multiplied into the positions: a random similarity, rounded to f32 where it leads.
pub fn bake(mesh: &Mesh, seed: u64) -> Mesh {
    single(&similarity(mesh, seed), |p| p)
}

/// From inches to metres, and to where a large scene has the model: `diagonals` of its bounding box away from the origin, in a random
/// direction. Rounded to f32 there, which leaves about `23 - log2(diagonals)` bits.
pub fn convert_units(mesh: &Mesh, diagonals: f64, seed: u64) -> Mesh {
    let place = Random::new(seed).direction() * (diagonals * diagonal(&mesh.positions));
    single(mesh, |p| (p + place) * INCH)
}

/// The mirror image, turned inside out, so that its outside is outside again.
pub fn mirror(mesh: &Mesh) -> Mesh {
    let positions = mesh.positions.iter();
    Mesh {
        positions: positions.map(|p| DVec3::new(-p.x, p.y, p.z)).collect(),
        triangles: mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    }
}

/// In f32.
fn single(mesh: &Mesh, place: impl Fn(DVec3) -> DVec3) -> Mesh {
    let positions = mesh.positions.iter();
    mesh.with_positions(positions.map(|&p| place(p).as_vec3().as_dvec3()).collect())
}
