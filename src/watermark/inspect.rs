//! What a model is made of.

use super::{Error, Model};
use crate::digest::sha256;
use crate::document::{Container, Document};
use crate::geometry::diagonal;
use crate::mesh::Edges;
use crate::progress::Stage;
use crate::scene::Scene;
use serde::Serialize;

/// A model in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Inspection {
    /// `glb` or `gltf`.
    pub container: &'static str,
    /// Bytes of the main file.
    pub bytes: usize,
    /// Of the scene, every instance counted, welded.
    pub vertices: usize,
    /// Of the scene, without degenerate ones.
    pub triangles: usize,
    /// Sets of triangles that are joined by edges.
    pub components: usize,
    /// Edges with one triangle.
    pub boundary_edges: usize,
    /// Edges with three triangles or more.
    pub non_manifold_edges: usize,
    /// Diagonal of the bounding box, in scene units.
    pub diagonal: f64,
    /// Meshes in the document.
    pub meshes: usize,
    /// Their primitives.
    pub primitives: usize,
    /// Nodes in the document.
    pub nodes: usize,
    /// As the document says.
    pub extensions_used: Vec<String>,
    /// What is strewn far from the model, in sentences: it is left out of all that is said here, and would not be marked.
    pub warnings: Vec<String>,
    /// SHA-256 of the main file.
    pub sha256: String,
}

/// Describes a model. What it can hold is [`capacity`](crate::capacity)'s to say, which takes longer.
///
/// # Errors
/// As [`measure`](crate::measure).
pub fn inspect<'a>(model: impl Into<Model<'a>>) -> Result<Inspection, Error> {
    let mut model = model.into();
    model.step(Stage::Read, 0.0)?;
    let document = Document::read(model.bytes, model.files)?;
    let scene = Scene::gather(&document)?;
    let warnings = scene.strays_in_words().into_iter().collect();
    let mesh = scene.mesh;
    model.step(Stage::Measure, 0.0)?;
    let edges = Edges::new(&mesh);
    Ok(Inspection {
        container: match document.container() {
            Container::Glb => "glb",
            Container::Gltf => "gltf",
        },
        bytes: model.bytes.len(),
        vertices: mesh.positions.len(),
        triangles: mesh.triangles.len(),
        components: edges.num_components(),
        boundary_edges: edges.num_boundary(),
        non_manifold_edges: edges.num_non_manifold(),
        diagonal: diagonal(&mesh.positions),
        meshes: document.meshes().len(),
        primitives: document
            .meshes()
            .iter()
            .map(|mesh| mesh.primitives.len())
            .sum(),
        nodes: document.num_stated_nodes(),
        extensions_used: document.extensions_used().to_vec(),
        warnings,
        sha256: sha256(model.bytes),
    })
}
