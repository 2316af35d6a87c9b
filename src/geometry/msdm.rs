//! Mesh structural distortion: curvature about vertices, and how its statistics differ (Lavoue et al. 2006).

use super::{dihedrals, face_areas, vertex_normals};
use crate::mesh::{Edges, Mesh, Rings};
use glam::{DMat3, DVec3};

/// Radius of the balls of curvature. All lengths are fractions of the longest side of the reference's bounding box.
const BALL: f64 = 0.005;
/// Radius of the windows.
const WINDOW: f64 = 0.015;
/// Width of their Gaussian weights.
const WIDTH: f64 = 0.008;
/// Windows.
const CENTRES: usize = 1024;

/// The cubic mean of the windows' distortions between two meshes of the same triangles, consistently wound. `size` is the unit of
/// length; windows are the first one's. 0 without windows.
pub(super) fn distortion(mesh: &Mesh, other: &Mesh, size: f64) -> f64 {
    let edges = Edges::new(mesh);
    let rings = edges.rings(mesh.positions.len());
    let curvatures = [mesh, other].map(|mesh| curvature(mesh, &edges, &rings, size));
    let mut walk = Walk::new(mesh, &rings);
    let step = mesh.positions.len().div_ceil(CENTRES).max(1);
    let centres = (0..mesh.positions.len()).step_by(step);
    let (mut sum, mut count) = (0.0, 0);
    for centre in centres.filter(|&v| rings.valence(v) > 0) {
        let mut near = walk.within(centre, WINDOW * size).to_vec();
        let ring = rings.neighbours(centre).iter().copied();
        near.extend(ring.filter(|&v| !walk.has_seen(v)));
        let mut window = Window::default();
        for v in near.into_iter().map(|v| v as usize) {
            let distance = mesh.positions[v].distance(mesh.positions[centre]);
            let exponent = distance / (WIDTH * size);
            let weight = libm::exp(-exponent * exponent / 2.0);
            window.add(weight, curvatures.each_ref().map(|values| values[v]));
        }
        sum += window.cubed_distortion();
        count += 1;
    }
    libm::cbrt(sum / f64::from(count.max(1)))
}

/// V values: the mean size of the two principal curvatures, times `size`. They are the normal cycle's: over a ball, of each edge its
/// angle times its length along its direction, over the ball's area.
fn curvature(mesh: &Mesh, edges: &Edges, rings: &Rings, size: f64) -> Vec<f64> {
    let face_areas = face_areas(mesh);
    let mut areas = vec![0.0; mesh.positions.len()];
    for (triangle, area) in mesh.triangles.iter().zip(&face_areas) {
        triangle
            .iter()
            .for_each(|&v| areas[v as usize] += area.length() / 3.0);
    }
    let mut cycles = vec![DMat3::ZERO; mesh.positions.len()];
    for dihedral in dihedrals(mesh, edges, &face_areas) {
        let [a, b] = dihedral.ends.map(|v| v as usize);
        let along = mesh.positions[b] - mesh.positions[a];
        let length = along.length();
        if length > 0.0 {
            let half = along * (dihedral.angle / (2.0 * length));
            let cycle = DMat3::from_cols(half * along.x, half * along.y, half * along.z);
            cycles[a] += cycle;
            cycles[b] += cycle;
        }
    }
    let normals = vertex_normals(mesh);
    let mut walk = Walk::new(mesh, rings);
    let of = |v: usize| {
        let (mut cycle, mut area) = (DMat3::ZERO, 0.0);
        for &near in walk.within(v, BALL * size) {
            cycle += cycles[near as usize];
            area += areas[near as usize];
        }
        if area <= 0.0 || normals[v] == DVec3::ZERO {
            return 0.0;
        }
        let (x, y) = normals[v].any_orthonormal_pair();
        let (xx, xy, yy) = (x.dot(cycle * x), x.dot(cycle * y), y.dot(cycle * y));
        // |k1| + |k2| is the larger of |k1 + k2| and |k1 - k2|.
        let difference = ((xx - yy) * (xx - yy) + 4.0 * xy * xy).sqrt();
        (xx + yy).abs().max(difference) / area * size / 2.0
    };
    (0..mesh.positions.len()).map(of).collect()
}

/// Weighted sums over a window.
#[derive(Default)]
struct Window {
    weight: f64,
    first: [f64; 2],
    second: [f64; 2],
    product: f64,
}

impl Window {
    fn add(&mut self, weight: f64, values: [f64; 2]) {
        self.weight += weight;
        for (i, value) in values.into_iter().enumerate() {
            self.first[i] += weight * value;
            self.second[i] += weight * value * value;
        }
        self.product += weight * values[0] * values[1];
    }

    fn cubed_distortion(&self) -> f64 {
        let means = self.first.map(|sum| sum / self.weight);
        let deviations = [0, 1].map(|i| {
            let variance = self.second[i] / self.weight - means[i] * means[i];
            variance.max(0.0).sqrt()
        });
        let covariance = self.product / self.weight - means[0] * means[1];
        let difference = |[a, b]: [f64; 2]| (a - b).abs() / (a.max(b) + 1.0);
        let product = deviations[0] * deviations[1];
        let structure = (product - covariance).abs() / (product + 1.0);
        let cube = |x: f64| x * x * x;
        0.4 * cube(difference(means)) + 0.4 * cube(difference(deviations)) + 0.2 * cube(structure)
    }
}

/// Vertices about a vertex.
struct Walk<'a> {
    mesh: &'a Mesh,
    rings: &'a Rings,
    /// By vertex, the last centre from which it was reached.
    seen: Vec<u32>,
    near: Vec<u32>,
    centre: u32,
}

impl<'a> Walk<'a> {
    fn new(mesh: &'a Mesh, rings: &'a Rings) -> Walk<'a> {
        Walk {
            mesh,
            rings,
            seen: vec![u32::MAX; mesh.positions.len()],
            near: Vec::new(),
            centre: u32::MAX,
        }
    }

    /// A vertex, and those that edges lead to from it without leaving a ball about it.
    fn within(&mut self, centre: usize, radius: f64) -> &[u32] {
        self.centre = centre as u32;
        self.near.clear();
        self.near.push(self.centre);
        self.seen[centre] = self.centre;
        let mut next = 0;
        while next < self.near.len() {
            for &v in self.rings.neighbours(self.near[next] as usize) {
                let place = self.mesh.positions[v as usize];
                let is_near = place.distance(self.mesh.positions[centre]) <= radius;
                if is_near && self.seen[v as usize] != self.centre {
                    self.seen[v as usize] = self.centre;
                    self.near.push(v);
                }
            }
            next += 1;
        }
        &self.near
    }

    /// Whether the last walk came to a vertex.
    fn has_seen(&self, vertex: u32) -> bool {
        self.seen[vertex as usize] == self.centre
    }
}
