//! Spherical coordinates about a barycentre: the distance from it, in units of a scale, is what is quantized; the direction
//! stays.

use crate::geometry::Pose;
use crate::mesh::Mesh;
use glam::DVec3;

/// Which barycentre, and which scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Barycentre {
    /// Mean of the vertices, and the mean of their distances from it: Vasic and Vasic 2012. Moves when vertices come or go.
    Vertices,
    /// Mean of the surface, and the mean distance of its triangles' centroids: as good on any tessellation of a surface.
    Area,
    /// Centroid of the enclosed volume, and the root of its covariance's trace: hardly moved by what roughens the surface.
    Volume,
}

/// An origin and a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spherical {
    /// The barycentre, in scene units.
    pub origin: DVec3,
    /// The unit of distances, in scene units; greater than 0.
    pub scale: f64,
}

impl Spherical {
    /// The coordinates of a mesh; `None` where it has no extent.
    pub fn of(mesh: &Mesh, barycentre: Barycentre) -> Option<Spherical> {
        let (origin, scale) = match barycentre {
            Barycentre::Vertices => {
                let points = mesh.positions.iter().map(|&point| (1.0, point));
                mean_and_distance(points)
            }
            Barycentre::Area => mean_and_distance(mesh.triangles.iter().map(|&triangle| {
                let [a, b, c] = mesh.corners(triangle);
                ((b - a).cross(c - a).length(), (a + b + c) / 3.0)
            })),
            Barycentre::Volume => Pose::of_surface(mesh).map(|pose| (pose.centre, pose.size))?,
        };
        let is_usable = origin.is_finite() && scale > 0.0 && scale.is_finite();
        is_usable.then_some(Spherical { origin, scale })
    }

    /// Distance of a point from the origin, in units of the scale.
    pub fn radius(&self, point: DVec3) -> f64 {
        point.distance(self.origin) / self.scale
    }

    /// The point in the same direction at another distance; the point itself where it has no direction.
    pub fn at_radius(&self, point: DVec3, radius: f64) -> DVec3 {
        match (point - self.origin).try_normalize() {
            Some(direction) => self.origin + direction * (radius * self.scale),
            None => point,
        }
    }
}

/// Weighted mean of points, and the weighted mean of their distances from it.
fn mean_and_distance(points: impl Iterator<Item = (f64, DVec3)> + Clone) -> (DVec3, f64) {
    let (total, sum) = points
        .clone()
        .fold((0.0, DVec3::ZERO), |(total, sum), (weight, point)| {
            (total + weight, sum + point * weight)
        });
    let mean = sum / total;
    let distances: f64 = points.map(|(weight, p)| weight * p.distance(mean)).sum();
    (mean, distances / total)
}
