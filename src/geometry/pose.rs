//! The canonical frame of a surface, from its area moments: what stays when a model is moved, turned or scaled.
//!
//! Moments are integrals over the surface, exact for triangles, so tessellation does not matter. O(F).

use super::linear::symmetric_eigen;
use super::orientation::oriented;
use crate::mesh::Mesh;
use glam::{DMat3, DVec3};

/// The frame of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Area centroid, in scene units.
    pub centre: DVec3,
    /// Square root of the trace of the area covariance, in scene units.
    pub size: f64,
    /// Principal axes as columns, in decreasing order of spread, right-handed. Their signs are arbitrary: turning two of
    /// them over gives as good a frame.
    pub axes: DMat3,
    /// Share of each axis in the trace, decreasing; together 1.
    pub spreads: DVec3,
}

/// Axes whose spreads have a greater ratio than this may lie anywhere in their plane.
const DEGENERATE: f64 = 0.98;

impl Pose {
    /// Half turns about the axes: what their signs leave open.
    pub const HALF_TURNS: [DVec3; 4] = [
        DVec3::new(1.0, 1.0, 1.0),
        DVec3::new(1.0, -1.0, -1.0),
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(-1.0, -1.0, 1.0),
    ];

    /// The pose of a mesh; `None` without area.
    pub fn of(mesh: &Mesh) -> Option<Pose> {
        let (mut total, mut first) = (0.0, DVec3::ZERO);
        for (area, corners) in areas(mesh) {
            total += area;
            first += (corners[0] + corners[1] + corners[2]) * (area / 3.0);
        }
        let centre = first / total;
        let mut covariance = DMat3::ZERO;
        for (area, corners) in areas(mesh) {
            let [p, q, r] = corners.map(|corner| corner - centre);
            let sum = p + q + r;
            let moment = [sum, p, q, r].into_iter().map(outer).sum::<DMat3>();
            covariance += moment * (area / (12.0 * total));
        }
        Pose::of_moments(centre, covariance)
    }

    /// The frame of a shape with a centre and a covariance; `None` where that has no positive trace.
    pub fn of_moments(centre: DVec3, covariance: DMat3) -> Option<Pose> {
        let trace = covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z;
        if !(trace > 0.0 && trace.is_finite()) {
            return None;
        }
        let (spreads, axes) = eigen(covariance * (1.0 / trace));
        Some(Pose {
            centre,
            size: trace.sqrt(),
            axes,
            spreads,
        })
    }

    /// The pose by volume moments: quieter than [`Pose::of`] under every change of tessellation. Boundaries, the directed
    /// edges with one face, are closed by fans to their centroids. `None` for surfaces that enclose too little to have such
    /// moments.
    ///
    /// The mesh's triangles have to face outwards, as [`outward`](super::outward) makes them.
    pub fn of_volume(mesh: &Mesh, boundary: &[(u32, u32)]) -> Option<Pose> {
        // Any point near the surface will do to measure from.
        let origin = mesh.positions.iter().sum::<DVec3>() / mesh.positions.len() as f64;
        let caps = caps(mesh, boundary);
        let faces = mesh
            .triangles
            .iter()
            .map(|&triangle| mesh.corners(triangle));
        let (mut area, mut volume, mut first, mut second) = (0.0, 0.0, DVec3::ZERO, [0.0; 6]);
        for corners in faces.chain(caps) {
            let [p, q, r] = corners.map(|corner| corner - origin);
            area += (q - p).cross(r - p).length() * 0.5;
            let part = p.dot(q.cross(r)) / 6.0;
            let sum = p + q + r;
            volume += part;
            first += sum * part;
            let products =
                |i: usize, j: usize| sum[i] * sum[j] + p[i] * p[j] + q[i] * q[j] + r[i] * r[j];
            let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
            for (entry, (i, j)) in second.iter_mut().zip(pairs) {
                *entry += products(i, j) * part;
            }
        }
        let encloses = volume.abs() > 0.01 * area * area.sqrt();
        if !encloses {
            return None;
        }
        let centre = first / (4.0 * volume);
        let [xx, xy, xz, yy, yz, zz] = second.map(|entry| entry / (20.0 * volume));
        let rows = [xx, xy, xz, xy, yy, yz, xz, yz, zz];
        let covariance = DMat3::from_cols_array(&rows) - outer(centre);
        Pose::of_moments(origin + centre, covariance).filter(|pose| pose.spreads.z > 0.002)
    }

    /// The pose of a mesh whose triangles face outwards, and of its boundary: by volume moments, or by area moments where it
    /// encloses next to nothing.
    pub fn of_oriented(mesh: &Mesh, boundary: &[(u32, u32)]) -> Option<Pose> {
        Pose::of_volume(mesh, boundary).or_else(|| Pose::of(mesh))
    }

    /// The same of any mesh.
    pub fn of_surface(mesh: &Mesh) -> Option<Pose> {
        let (mesh, boundary) = oriented(mesh);
        Pose::of_oriented(&mesh, &boundary)
    }

    /// The same frame with its axes nearest to another's: their signs, and where spreads are so near each other that axes may
    /// lie anywhere in their plane, their directions in it.
    pub fn aligned_with(self, other: &Pose) -> Pose {
        let near = |a: f64, b: f64| b > DEGENERATE * a;
        let [x, y, z] = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis];
        let [other_x, other_y, other_z] = [other.axes.x_axis, other.axes.y_axis, other.axes.z_axis];
        let sign = |axis: DVec3, other: DVec3| if axis.dot(other) < 0.0 { -axis } else { axis };
        let across =
            |axis: DVec3, other: DVec3| (other - axis * other.dot(axis)).normalize_or(other);
        let (first, second) = match (
            near(self.spreads.x, self.spreads.y),
            near(self.spreads.y, self.spreads.z),
        ) {
            (false, false) => (sign(x, other_x), sign(y, other_y)),
            (true, false) => {
                let third = sign(z, other_z);
                let first = across(third, other_x);
                (first, third.cross(first))
            }
            (false, true) => {
                let first = sign(x, other_x);
                (first, across(first, other_y))
            }
            (true, true) => (other_x, other_y),
        };
        Pose {
            axes: DMat3::from_cols(first, second, first.cross(second)),
            ..self
        }
    }

    /// The smallest relative difference between two successive spreads, 0 to 1: 0 for surfaces of revolution, whose axes
    /// are not determined.
    pub fn distinctness(&self) -> f64 {
        let between = |a: f64, b: f64| if a > 0.0 { (a - b) / (a + b) } else { 0.0 };
        between(self.spreads.x, self.spreads.y).min(between(self.spreads.y, self.spreads.z))
    }

    /// A point in the frame: in units of `size`, along the axes.
    pub fn canonical(&self, point: DVec3) -> DVec3 {
        self.axes.transpose() * (point - self.centre) / self.size
    }
}

/// Triangles that close every connected set of boundary edges by a fan to the edges' length-weighted centroid.
fn caps(mesh: &Mesh, boundary: &[(u32, u32)]) -> Vec<[DVec3; 3]> {
    let mut names: Vec<u32> = boundary.iter().flat_map(|&(a, b)| [a, b]).collect();
    names.sort_unstable();
    names.dedup();
    let index = |vertex: u32| names.partition_point(|&name| name < vertex);
    let mut parents: Vec<usize> = (0..names.len()).collect();
    for &(a, b) in boundary {
        let (a, b) = (root(&mut parents, index(a)), root(&mut parents, index(b)));
        parents[b] = a;
    }
    let mut centres = vec![(0.0, DVec3::ZERO); names.len()];
    for &(a, b) in boundary {
        let (p, q) = (mesh.positions[a as usize], mesh.positions[b as usize]);
        let length = p.distance(q);
        let (total, sum) = &mut centres[root(&mut parents, index(a))];
        *total += length;
        *sum += (p + q) * (0.5 * length);
    }
    let mut fan = Vec::with_capacity(boundary.len());
    for &(a, b) in boundary {
        let (total, sum) = centres[root(&mut parents, index(a))];
        if total > 0.0 {
            fan.push([
                mesh.positions[b as usize],
                mesh.positions[a as usize],
                sum / total,
            ]);
        }
    }
    fan
}

fn root(parents: &mut [usize], mut node: usize) -> usize {
    while parents[node] != node {
        parents[node] = parents[parents[node]];
        node = parents[node];
    }
    node
}

fn areas(mesh: &Mesh) -> impl Iterator<Item = (f64, [DVec3; 3])> {
    mesh.triangles.iter().map(|&triangle| {
        let [a, b, c] = mesh.corners(triangle);
        ((b - a).cross(c - a).length() * 0.5, [a, b, c])
    })
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// Eigenvalues in decreasing order and a right-handed basis of eigenvectors of a symmetric matrix.
pub(super) fn eigen(matrix: DMat3) -> (DVec3, DMat3) {
    let (values, vectors) = symmetric_eigen(matrix.to_cols_array_2d());
    let mut pairs = [0, 1, 2].map(|i| (values[i], DVec3::from_array(vectors[i])));
    pairs.sort_by(|x, y| y.0.total_cmp(&x.0));
    let [(x, first), (y, second), (z, _)] = pairs;
    (
        DVec3::new(x, y, z),
        DMat3::from_cols(first, second, first.cross(second)),
    )
}
