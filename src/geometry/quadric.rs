//! Quadric error metrics (Garland and Heckbert 1997): what it costs a surface to lose a vertex.

use crate::mesh::{Mesh, Rings};
use glam::{DMat3, DVec3};

/// Pull of a guess on the minimum, against the planes: it decides where they leave the choice.
const REGULARISATION: f64 = 1e-6;

/// Sum of squared distances from planes: x.Ax + 2 b.x + c.
#[derive(Clone, Copy)]
pub struct Quadric {
    a: DMat3,
    b: DVec3,
    c: f64,
}

impl Quadric {
    /// No plane.
    pub const ZERO: Quadric = Quadric {
        a: DMat3::ZERO,
        b: DVec3::ZERO,
        c: 0.0,
    };

    /// The squared distance from a plane through a point, times `weight`; `normal` of length 1.
    pub fn plane(normal: DVec3, through: DVec3, weight: f64) -> Quadric {
        let offset = -normal.dot(through);
        let axis = |n: f64| normal * (n * weight);
        Quadric {
            a: DMat3::from_cols(axis(normal.x), axis(normal.y), axis(normal.z)),
            b: normal * (offset * weight),
            c: offset * offset * weight,
        }
    }

    /// The planes of both.
    pub fn plus(&self, other: &Quadric) -> Quadric {
        Quadric {
            a: self.a + other.a,
            b: self.b + other.b,
            c: self.c + other.c,
        }
    }

    /// Its value at a point, in units of the weights times squared length.
    pub fn at(&self, x: DVec3) -> f64 {
        x.dot(self.a * x) + 2.0 * self.b.dot(x) + self.c
    }

    /// Where it is least; near `guess` where the planes leave that open.
    pub fn minimum(&self, guess: DVec3) -> DVec3 {
        let trace = self.a.x_axis.x + self.a.y_axis.y + self.a.z_axis.z;
        let pull = REGULARISATION * trace;
        if pull <= 0.0 {
            return guess;
        }
        let system = self.a + DMat3::from_diagonal(DVec3::splat(pull));
        system.inverse() * (guess * pull - self.b)
    }
}

/// V costs: what the cheapest collapse of each vertex onto a neighbour takes from the surface, in area times squared length:
/// the squared distances of the neighbour from the planes of the vertex's faces, weighted by their areas. (The neighbour's own
/// planes add nothing: it lies in them.) Infinite without neighbours. Winding does not matter.
pub fn collapse_costs(mesh: &Mesh, rings: &Rings) -> Vec<f64> {
    // Each with the vertex as origin, so that nothing is lost far from the scene's.
    let mut quadrics = vec![Quadric::ZERO; mesh.positions.len()];
    for &face in &mesh.triangles {
        let [a, b, c] = mesh.corners(face);
        let normal = (b - a).cross(c - a);
        let area = normal.length() / 2.0;
        let plane = Quadric::plane(normal.normalize_or_zero(), DVec3::ZERO, area);
        for vertex in face {
            quadrics[vertex as usize] = quadrics[vertex as usize].plus(&plane);
        }
    }
    let cheapest = |v: usize| {
        let costs = rings.neighbours(v).iter().map(|&neighbour| {
            quadrics[v].at(mesh.positions[neighbour as usize] - mesh.positions[v])
        });
        costs.fold(f64::INFINITY, f64::min)
    };
    (0..mesh.positions.len()).map(cheapest).collect()
}
