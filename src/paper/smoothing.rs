//! The methods that the study compares, each with the strength of one iteration.

use crate::attack::{
    bilaplacian, catmull_clark, loop_scheme, mean_curvature_flow, mean_filter, midpoint, smooth,
    sqrt3, taubin,
};
use crate::mesh::Mesh;

/// A smoothing method. In all of them the vertices of the mesh keep their indices.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "camelCase")]
pub enum Smoothing {
    /// The paper's: Catmull and Clark's subdivision.
    MeshSmooth,
    /// Loop's subdivision.
    Loop,
    /// Kobbelt's square root of 3 subdivision.
    Sqrt3,
    /// Division of every triangle in four, which moves nothing: new vertices alone.
    Midpoint,
    /// Half a step of the umbrella operator.
    Laplacian,
    /// Half a step of the umbrella operator's square.
    Bilaplacian,
    /// Mean curvature flow for half a square of the mean edge.
    MeanCurvatureFlow,
    /// Taubin's lambda 0.5 and mu -0.53.
    Taubin,
    /// The mean filter of normals.
    MeanFilter,
}

impl Smoothing {
    /// Every method.
    pub const ALL: [Smoothing; 9] = [
        Smoothing::MeshSmooth,
        Smoothing::Loop,
        Smoothing::Sqrt3,
        Smoothing::Midpoint,
        Smoothing::Laplacian,
        Smoothing::Bilaplacian,
        Smoothing::MeanCurvatureFlow,
        Smoothing::Taubin,
        Smoothing::MeanFilter,
    ];

    /// The name that scripts and pages use.
    pub fn name(self) -> &'static str {
        match self {
            Smoothing::MeshSmooth => "meshSmooth",
            Smoothing::Loop => "loop",
            Smoothing::Sqrt3 => "sqrt3",
            Smoothing::Midpoint => "midpoint",
            Smoothing::Laplacian => "laplacian",
            Smoothing::Bilaplacian => "bilaplacian",
            Smoothing::MeanCurvatureFlow => "meanCurvatureFlow",
            Smoothing::Taubin => "taubin",
            Smoothing::MeanFilter => "meanFilter",
        }
    }

    /// The method of a name.
    pub fn from_name(name: &str) -> Option<Smoothing> {
        Self::ALL
            .into_iter()
            .find(|smoothing| smoothing.name() == name)
    }

    /// Smooths a mesh.
    pub fn apply(self, mesh: &Mesh, iterations: u32) -> Mesh {
        let each =
            |round: fn(&Mesh) -> Mesh| (0..iterations).fold(mesh.clone(), |mesh, _| round(&mesh));
        match self {
            Smoothing::MeshSmooth => catmull_clark(mesh, iterations),
            Smoothing::Loop => each(loop_scheme),
            Smoothing::Sqrt3 => each(sqrt3),
            Smoothing::Midpoint => each(midpoint),
            Smoothing::Laplacian => smooth(mesh, 0.5, iterations),
            Smoothing::Bilaplacian => bilaplacian(mesh, 0.5, iterations),
            Smoothing::MeanCurvatureFlow => mean_curvature_flow(mesh, 0.5, iterations),
            Smoothing::Taubin => taubin(mesh, 0.5, -0.53, iterations),
            Smoothing::MeanFilter => mean_filter(mesh, iterations),
        }
    }
}
