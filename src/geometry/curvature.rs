//! Gaussian and mean curvature at vertices, by the two methods that the seed paper names: discrete differential geometry
//! (Meyer, Desbrun, Schroder and Barr 2003) and fitting quadrics.

use crate::mesh::{Mesh, Rings};
use glam::DVec3;
use nalgebra::{SMatrix, SVector};
use std::f64::consts::{PI, TAU};

/// Cotangents are held below this: those of angles thinner than about a degree say more of rounding than of the surface.
const STEEPEST: f64 = 50.0;
/// Neighbours with more neighbours than this are hubs of a fan, whose ring is not near.
const HUB: usize = 32;
/// The part of its system's trace that a fit adds to the diagonal: where points are too few, or lie on too few lines, it takes
/// the flattest of the quadrics that fit.
const RIDGE: f64 = 1e-9;

/// Curvature at V vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curvature {
    /// Gaussian curvature, in inverse squared scene units.
    pub gaussian: Vec<f64>,
    /// Mean curvature, in inverse scene units: positive where the surface bulges outwards.
    pub mean: Vec<f64>,
}

impl Curvature {
    /// The principal curvatures of a vertex, the larger first, in inverse scene units. Where estimates contradict each other,
    /// H^2 < K, both are H.
    pub fn principal(&self, vertex: usize) -> [f64; 2] {
        let mean = self.mean[vertex];
        let half = (mean * mean - self.gaussian[vertex]).max(0.0).sqrt();
        [mean + half, mean - half]
    }
}

/// Integrals of curvature over the cells of V vertices: they have no scale (Gaussian) or that of a length (mean), and stay
/// finite where cells vanish.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CurvatureIntegrals {
    /// Of Gaussian curvature, radians: the angle defect, 2 pi (on borders pi) less the angles of the faces. Over a closed surface,
    /// or one whose borders are simple, their sum is 2 pi times the Euler characteristic (Gauss-Bonnet, exactly).
    pub gaussian: Vec<f64>,
    /// Of mean curvature, scene units: of the cotangent formula, along the vertex normal.
    pub mean: Vec<f64>,
    /// The cells' areas, squared scene units: Meyer's mixed areas, which divide the surface among its vertices.
    pub area: Vec<f64>,
}

impl CurvatureIntegrals {
    /// Curvature itself: the integrals over the areas, 0 where there is none.
    pub fn curvature(&self) -> Curvature {
        let over_area = |integrals: &[f64]| -> Vec<f64> {
            let pairs = integrals.iter().zip(&self.area);
            pairs
                .map(|(integral, &area)| if area > 0.0 { integral / area } else { 0.0 })
                .collect()
        };
        Curvature {
            gaussian: over_area(&self.gaussian),
            mean: over_area(&self.mean),
        }
    }
}

/// Discrete differential geometry: Meyer et al. 2003, equations 8 to 10. `normals` are the mesh's [`vertex_normals`](super::vertex_normals). O(F).
pub fn curvature_integrals(mesh: &Mesh, rings: &Rings, normals: &[DVec3]) -> CurvatureIntegrals {
    let num_vertices = mesh.positions.len();
    let full = |v: usize| match rings.valence(v) {
        0 => 0.0,
        _ if rings.is_closed(v) => TAU,
        _ => PI,
    };
    let mut gaussian: Vec<f64> = (0..num_vertices).map(full).collect();
    let mut flux = vec![DVec3::ZERO; num_vertices];
    let mut area = vec![0.0; num_vertices];
    for &triangle in &mesh.triangles {
        let corners = mesh.corners(triangle);
        let (sides, dots) = sides_and_dots(corners);
        let twice_area = sides[0].cross(sides[1]).length();
        let cotangents = cotangents(corners);
        let obtuse = dots.iter().position(|&dot| dot < 0.0);
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let vertex = triangle[i] as usize;
            gaussian[vertex] -= libm::atan2(twice_area, dots[i]);
            flux[vertex] += sides[j] * cotangents[j] - sides[k] * cotangents[k];
            area[vertex] += match obtuse {
                Some(at) if at == i => twice_area / 4.0,
                Some(_) => twice_area / 8.0,
                None if twice_area > 0.0 => {
                    (sides[j].length_squared() * dots[j] + sides[k].length_squared() * dots[k])
                        / (8.0 * twice_area)
                }
                None => 0.0,
            };
        }
    }
    let mean = flux
        .iter()
        .zip(normals)
        .map(|(flux, normal)| flux.dot(*normal) / 4.0)
        .collect();
    CurvatureIntegrals {
        gaussian,
        mean,
        area,
    }
}

/// The cotangents of a triangle's angles. Those of a thin triangle are all made smaller by one factor: its part of the Dirichlet
/// energy stays positive.
pub fn cotangents(corners: [DVec3; 3]) -> [f64; 3] {
    let (sides, dots) = sides_and_dots(corners);
    let longest = sides
        .iter()
        .map(|side| side.length_squared())
        .fold(0.0, f64::max);
    let twice_area = sides[0].cross(sides[1]).length().max(longest / STEEPEST);
    dots.map(|dot| {
        if twice_area > 0.0 {
            dot / twice_area
        } else {
            0.0
        }
    })
}

/// By corner: the side across from it, and the product of the other two, seen from it.
fn sides_and_dots(corners: [DVec3; 3]) -> ([DVec3; 3], [f64; 3]) {
    let sides = [0, 1, 2].map(|i| corners[(i + 2) % 3] - corners[(i + 1) % 3]);
    (
        sides,
        [0, 1, 2].map(|i| -sides[(i + 1) % 3].dot(sides[(i + 2) % 3])),
    )
}

/// Fitting quadrics: in the tangent frame of each vertex, z = a x^2 + b xy + c y^2 + d x + e y through the vertex and, by least
/// squares, its neighbours and theirs. 0 without neighbours. `normals` are the mesh's
/// [`vertex_normals`](super::vertex_normals). O(V).
pub fn fitted_curvature(mesh: &Mesh, rings: &Rings, normals: &[DVec3]) -> Curvature {
    let mut curvature = Curvature::default();
    let mut near = Vec::new();
    let mut seen = vec![u32::MAX; mesh.positions.len()];
    for (v, &normal) in normals.iter().enumerate() {
        near.clear();
        seen[v] = v as u32;
        let mut add = |w: u32| {
            if std::mem::replace(&mut seen[w as usize], v as u32) != v as u32 {
                near.push(mesh.positions[w as usize] - mesh.positions[v]);
            }
        };
        for &neighbour in rings.neighbours(v) {
            add(neighbour);
            if rings.valence(neighbour as usize) <= HUB {
                rings
                    .neighbours(neighbour as usize)
                    .iter()
                    .for_each(|&w| add(w));
            }
        }
        let [gaussian, mean] = quadric_curvature(&near, normal);
        curvature.gaussian.push(gaussian);
        curvature.mean.push(mean);
    }
    curvature
}

/// Gaussian and mean curvature at the origin of the quadric through it that fits points best.
fn quadric_curvature(points: &[DVec3], normal: DVec3) -> [f64; 2] {
    let radius = points
        .iter()
        .map(|p| p.length_squared())
        .fold(0.0, f64::max)
        .sqrt();
    if radius == 0.0 || normal == DVec3::ZERO {
        return [0.0; 2];
    }
    let (u, v) = normal.any_orthonormal_pair();
    let mut system = SMatrix::<f64, 5, 5>::zeros();
    let mut right = SVector::<f64, 5>::zeros();
    for point in points {
        let (x, y, z) = (
            point.dot(u) / radius,
            point.dot(v) / radius,
            point.dot(normal) / radius,
        );
        let row = SVector::from([x * x, x * y, y * y, x, y]);
        system.ger(1.0, &row, &row, 1.0);
        right.axpy(z, &row, 1.0);
    }
    let ridge = RIDGE * system.trace();
    let Some(factors) = (system + SMatrix::identity() * ridge).cholesky() else {
        return [0.0; 2];
    };
    let [a, b, c, d, e] = factors.solve(&right).data.0[0];
    // Of the second fundamental form over the first.
    let slope = 1.0 + d * d + e * e;
    let gaussian = (4.0 * a * c - b * b) / (slope * slope);
    let mean = -(a * (1.0 + e * e) + c * (1.0 + d * d) - b * d * e) / (slope * slope.sqrt());
    [gaussian / (radius * radius), mean / radius]
}
