//! Fig. 3 and Fig. 4: what the study shows on a mesh, the hosts before and after smoothing among it.

use super::smoothing::Smoothing;
use super::stability::{Ranking, ranked};
use crate::geometry::{diagonal, fitted_curvature, vertex_normals};
use crate::mesh::{Edges, Mesh};

/// Numbers at every vertex of a mesh.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Fields {
    /// Gaussian curvature by quadrics, inverse squared scene units.
    pub gaussian: Vec<f64>,
    /// Mean curvature by quadrics, inverse scene units: positive where the surface bulges outwards.
    pub mean: Vec<f64>,
    /// Place in the ranking: 1 for the most stable vertex, down to 0; 0 too for those that were rejected.
    pub stability: Vec<f64>,
}

/// Curvature and stability of a mesh.
pub fn fields(mesh: &Mesh, ranking: Ranking) -> Fields {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let curvature = fitted_curvature(mesh, &rings, &vertex_normals(mesh));
    let order = ranked(mesh, ranking, 1);
    let last = order.len().saturating_sub(1).max(1) as f64;
    let mut stability = vec![0.0; mesh.positions.len()];
    for (place, &vertex) in order.iter().enumerate() {
        stability[vertex as usize] = 1.0 - place as f64 / last;
    }
    Fields {
        gaussian: curvature.gaussian,
        mean: curvature.mean,
        stability,
    }
}

/// Hosts before and after smoothing.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Tracing {
    /// The smoothed mesh: three coordinates a vertex, in scene units.
    pub positions: Vec<f64>,
    /// Three vertices a triangle.
    pub triangles: Vec<u32>,
    /// How far smoothing moved each vertex that was there before, as a fraction of the diagonal.
    pub deviation: Vec<f64>,
    /// The hosts, the most stable first. They have the same indices in the smoothed mesh.
    pub hosts: Vec<u32>,
    /// Whether each host is among as many best vertices of the smoothed mesh.
    pub found: Vec<bool>,
    /// Those best vertices, the most stable first.
    pub hosts_after: Vec<u32>,
}

/// Smooths a mesh and looks for its hosts.
pub fn trace(
    mesh: &Mesh,
    smoothing: Smoothing,
    iterations: u32,
    ranking: Ranking,
    num_hosts: usize,
) -> Tracing {
    let smoothed = smoothing.apply(mesh, iterations);
    let [hosts, hosts_after] = [mesh, &smoothed].map(|mesh| {
        let mut order = ranked(mesh, ranking, 1);
        order.truncate(num_hosts);
        order
    });
    let mut is_best = vec![false; smoothed.positions.len()];
    hosts_after.iter().for_each(|&v| is_best[v as usize] = true);
    let diagonal = diagonal(&mesh.positions);
    let pairs = mesh.positions.iter().zip(&smoothed.positions);
    Tracing {
        deviation: pairs
            .map(|(before, after)| {
                if diagonal > 0.0 {
                    before.distance(*after) / diagonal
                } else {
                    0.0
                }
            })
            .collect(),
        found: hosts.iter().map(|&v| is_best[v as usize]).collect(),
        hosts,
        hosts_after,
        positions: smoothed
            .positions
            .iter()
            .flat_map(|p| p.to_array())
            .collect(),
        triangles: smoothed.triangles.into_iter().flatten().collect(),
    }
}
