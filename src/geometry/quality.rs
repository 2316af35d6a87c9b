//! What an attack costs the model: distances and a perceptual metric.

use super::msdm::distortion;
use super::{Surface, diagonal, outward, registered};
use crate::mesh::Mesh;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Points of a surface, and at most as many of its vertices, whose distance from the other is taken.
const SAMPLES: usize = 4096;
/// Multiples, modulo 1, that spread points evenly over a square (Roberts 2018): of the plastic number's powers.
const SPREAD: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];
/// A surface has something that the other has not if its RMS distance is so many times the other's,
const APART: f64 = 10.0;
/// or this part of the diagonal, below which surfaces are the same.
const SAME: f64 = 1e-9;
/// A copy has been moved as a whole if putting it back takes away more than this part of its displacement.
const MOVED: f64 = 0.5;

/// How an attacked mesh differs from what it was. All are `None` where one of them has no area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Quality {
    /// Root mean square distance of the surfaces, as a fraction of the reference's diagonal.
    pub rms_rel: Option<f64>,
    /// The largest distance, as a fraction of the reference's diagonal: over samples, so a lower bound.
    pub hausdorff_rel: Option<f64>,
    /// Mesh structural distortion, 0 to 1: how visible the difference is. See [`Quality::between`].
    pub msdm: Option<f64>,
}

impl Quality {
    /// Compares surfaces. Distances are taken from points spread evenly over one surface, and from its vertices, to the other surface; of
    /// the two directions the one that finds less counts, so that what was cut off, or put beside the model, costs nothing. A copy with the
    /// reference's triangles that was moved as a whole (turned, shifted, scaled, mirrored) is put back first.
    ///
    /// `msdm` is the mesh structural distortion measure of Lavoue et al. (2006), with the parameters of the LIRIS benchmark (Wang et
    /// al. 2010); D is the longest side of the reference's bounding box. Curvature, (|k1| + |k2|) / 2 D, is that of the normal cycle over
    /// the vertices within 0.005 D (Cohen-Steiner and Morvan 2003). About a vertex, within 0.015 D, its means m, deviations s and
    /// covariance s12, with Gaussian weights of width 0.008 D, give three comparisons
    ///
    /// L = |m1 - m2| / (max(m1, m2) + 1), C = |s1 - s2| / (max(s1, s2) + 1), S = |s1 s2 - s12| / (s1 s2 + 1),
    ///
    /// and (0.4 L^3 + 0.4 C^3 + 0.2 S^3)^(1/3); the measure is the cubic mean of that. It needs vertices that correspond. Where they do
    /// not, each mesh is compared with its own copy whose vertices lie on the nearest points of the other surface, and the larger
    /// distortion counts: other triangles on the same surface cost nothing, nor do flips, which leave all vertices on
    /// both. A direction in which distances are more than ten times the other's is left out: there something is missing.
    ///
    /// Departures: at most 1024 vertices are centres; on coarse meshes a window has at least a vertex and its neighbours; an edge counts
    /// half for each of its ends, and a ball has the vertices that edges lead to within it. MSDM2 (Lavoue 2011), which also projects,
    /// interpolates curvature and has several scales: its numbers differ.
    ///
    /// O(F log F).
    pub fn between(reference: &Mesh, attacked: &Mesh) -> Quality {
        if reference.area() <= 0.0 || attacked.area() <= 0.0 {
            return Quality::default();
        }
        let corresponds = correspond(reference, attacked);
        let mut meshes = if corresponds {
            [reference.clone(), put_back(attacked, reference)]
        } else {
            [reference, attacked].map(Mesh::welded)
        };
        meshes
            .iter_mut()
            .for_each(|mesh| mesh.triangles = outward(mesh));
        let surfaces = meshes.each_ref().map(Surface::new);
        let ways = [(0, 1), (1, 0)];
        let found = ways.map(|(i, j)| distances(&meshes[i], &surfaces[j]));
        let size = diagonal(&reference.positions);
        let nearer = if found[0].0 <= found[1].0 {
            found[0]
        } else {
            found[1]
        };

        let longest = longest_side(reference);
        let msdm = if corresponds {
            let moved = meshes[0].with_positions(meshes[1].positions.clone());
            distortion(&meshes[0], &moved, longest)
        } else {
            let most = APART * nearer.0.max(SAME * size);
            let whole = ways.iter().zip(found).filter(|(_, (rms, _))| *rms <= most);
            let distortions = whole.map(|(&(i, j), _)| {
                distortion(&meshes[i], &laid(&meshes[i], &surfaces[j]), longest)
            });
            distortions.fold(0.0, f64::max)
        };
        Quality {
            rms_rel: Some(nearer.0 / size),
            hausdorff_rel: Some(nearer.1 / size),
            msdm: Some(msdm),
        }
    }
}

/// The mesh with its vertices on the nearest points of a surface.
fn laid(mesh: &Mesh, surface: &Surface) -> Mesh {
    let onto = |&p: &DVec3| surface.nearest(p).map_or(p, |nearest| nearest.point);
    mesh.with_positions(mesh.positions.iter().map(onto).collect())
}

/// The longest side of the bounding box.
fn longest_side(mesh: &Mesh) -> f64 {
    let far = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let positions = mesh.positions.iter();
    let (low, high) = positions.fold(far, |(low, high), &p| (low.min(p), high.max(p)));
    (high - low).max_element()
}

/// Whether the meshes have the same triangles, however wound.
fn correspond(a: &Mesh, b: &Mesh) -> bool {
    let sorted = |&triangle: &[u32; 3]| {
        let mut triangle = triangle;
        triangle.sort_unstable();
        triangle
    };
    a.positions.len() == b.positions.len()
        && a.triangles.len() == b.triangles.len()
        && a.triangles
            .iter()
            .map(sorted)
            .eq(b.triangles.iter().map(sorted))
}

/// The attacked mesh without what was done to all of it at once, if most of what was done is that.
fn put_back(attacked: &Mesh, reference: &Mesh) -> Mesh {
    let square = |positions: &[DVec3]| -> f64 {
        let pairs = positions.iter().zip(&reference.positions);
        pairs.map(|(p, q)| p.distance_squared(*q)).sum()
    };
    let registered = registered(&attacked.positions, &reference.positions);
    if square(&registered) < MOVED * MOVED * square(&attacked.positions) {
        attacked.with_positions(registered)
    } else {
        attacked.clone()
    }
}

/// RMS and largest distance of a mesh's surface from another one.
fn distances(mesh: &Mesh, surface: &Surface) -> (f64, f64) {
    let distance = |point: DVec3| {
        surface
            .nearest(point)
            .map_or(0.0, |nearest| nearest.distance)
    };
    let (mut square, mut largest) = (0.0, 0.0_f64);
    let points = spread(mesh);
    for &point in &points {
        let distance = distance(point);
        square += distance * distance;
        largest = largest.max(distance);
    }
    let step = mesh.triangles.len().div_ceil(SAMPLES).max(1);
    let corners = mesh.triangles.iter().step_by(step);
    let corners = corners.map(|&[a, _, _]| distance(mesh.positions[a as usize]));
    largest = corners.fold(largest, f64::max);
    ((square / points.len().max(1) as f64).sqrt(), largest)
}

/// As many points of a surface as are taken, each for the same area.
fn spread(mesh: &Mesh) -> Vec<DVec3> {
    let share = mesh.area() / SAMPLES as f64;
    let mut points = Vec::with_capacity(SAMPLES);
    let mut passed = 0.0;
    for &triangle in &mesh.triangles {
        let [a, b, c] = mesh.corners(triangle);
        passed += (b - a).cross(c - a).length() / 2.0;
        while points.len() < SAMPLES && (points.len() as f64 + 0.5) * share <= passed {
            let [u, v] = SPREAD.map(|multiple| multiple * (points.len() + 1) as f64 % 1.0);
            let root = u.sqrt();
            points.push(a * (1.0 - root) + b * (root * (1.0 - v)) + c * (root * v));
        }
    }
    points
}
