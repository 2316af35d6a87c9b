//! Points that are strewn over a surface, as many on equal areas.

use super::vertex_normals;
use crate::mesh::Mesh;
use crate::random::Random;
use glam::DVec3;

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where it is.
    pub position: DVec3,
    /// The normal there, of unit length: between those of the triangle's corners.
    pub normal: DVec3,
    /// The triangle that it is in.
    pub triangle: u32,
    /// Its barycentric coordinates there.
    pub weights: [f64; 3],
}

/// So many points, in the order of the triangles. None of a surface without area.
pub fn scattered(mesh: &Mesh, count: usize, seed: u64) -> Vec<Point> {
    let mut random = Random::new(seed);
    let normals = vertex_normals(mesh);
    let total = mesh.area();
    if !(total > 0.0 && total.is_finite()) {
        return Vec::new();
    }
    let spacing = total / count as f64;
    let mut points = Vec::with_capacity(count);
    // The area that is passed, in spacings, less the points that are made.
    let mut owed = random.unit();
    for (triangle, &corners) in (0..).zip(&mesh.triangles) {
        let [a, b, c] = mesh.corners(corners);
        let twice_area = (b - a).cross(c - a);
        owed += 0.5 * twice_area.length() / spacing;
        while owed >= 1.0 && points.len() < count {
            owed -= 1.0;
            let (root, share) = (random.unit().sqrt(), random.unit());
            let weights = [1.0 - root, root * (1.0 - share), root * share];
            let own = corners.map(|corner| normals[corner as usize]);
            let normal = own[0] * weights[0] + own[1] * weights[1] + own[2] * weights[2];
            points.push(Point {
                position: a * weights[0] + b * weights[1] + c * weights[2],
                normal: normal
                    .try_normalize()
                    .unwrap_or(twice_area.normalize_or_zero()),
                triangle,
                weights,
            });
        }
    }
    points
}
