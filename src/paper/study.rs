//! The whole study of one mesh.

use super::figure_5::{Figure5, figure_5};
use super::smoothing::Smoothing;
use super::spherical::Barycentre;
use super::table_1::{HostsOptions, HostsRow, hosts};
use crate::carrier::CarrierError;
use crate::mesh::Mesh;
use crate::progress::{Progress, Stage, step};

/// Iterations of MeshSmooth that the paper reports, and none.
const ITERATIONS: [u32; 3] = [0, 1, 2];

/// The paper's table and figure for a mesh.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Study {
    /// V.
    pub vertices: usize,
    /// F.
    pub triangles: usize,
    /// MeshSmooth 0, 1 and 2.
    pub table_1: Vec<HostsRow>,
    /// Averages over keys.
    pub figure_5: Figure5,
}

/// Table I and Fig. 5 for a mesh as it is. `seed` is what hosts, keys and texts are drawn with; errors are averaged over `num_keys`
/// keys.
pub fn study(
    mesh: &Mesh,
    seed: u64,
    num_keys: u32,
    progress: &mut dyn Progress,
) -> Result<Study, CarrierError> {
    let options = HostsOptions {
        seed,
        ..HostsOptions::default()
    };
    let mut table_1 = Vec::new();
    for (number, iterations) in ITERATIONS.into_iter().enumerate() {
        let done = number as f64 / ITERATIONS.len() as f64;
        step(progress, Stage::Measure, done)?;
        table_1.push(hosts(mesh, Smoothing::MeshSmooth, iterations, &options));
    }
    let first = seed.min(u64::MAX - u64::from(num_keys));
    let keys = first..first + u64::from(num_keys);
    Ok(Study {
        vertices: mesh.positions.len(),
        triangles: mesh.triangles.len(),
        table_1,
        figure_5: figure_5(mesh, Barycentre::Vertices, keys, progress)?,
    })
}
