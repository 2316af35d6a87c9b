//! What a model is made of, and what it could hold.

use super::Error;
use crate::carrier::{Carrier, ring, solid};
use crate::digest::sha256;
use crate::document::{Container, Document, Files};
use crate::geometry::diagonal;
use crate::mesh::Edges;
use crate::scene::Scene;
use serde::Serialize;

/// A model in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
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
    /// What each carrier could hold.
    pub capacity: Vec<CarrierCapacity>,
    /// SHA-256 of the main file.
    pub sha256: String,
}

/// What one carrier could hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct CarrierCapacity {
    /// Which carrier.
    pub name: Carrier,
    /// Distinct addresses.
    pub addresses: usize,
    /// Distinct addresses that a mark of 48 bits needs.
    pub needed_addresses: usize,
}

/// Describes a model.
pub fn inspect(model: &[u8], files: &Files) -> Result<Inspection, Error> {
    let document = Document::read(model, files)?;
    let mesh = Scene::gather(&document)?.mesh;
    let edges = Edges::new(&mesh);
    Ok(Inspection {
        container: match document.container() {
            Container::Glb => "glb",
            Container::Gltf => "gltf",
        },
        bytes: model.len(),
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
        nodes: document.nodes().len(),
        extensions_used: document.extensions_used().to_vec(),
        capacity: vec![
            CarrierCapacity {
                name: Carrier::Solid,
                addresses: solid::num_windows(&mesh),
                needed_addresses: solid::NEEDED_WINDOWS,
            },
            CarrierCapacity {
                name: Carrier::Ring,
                addresses: ring::num_addresses(&mesh),
                needed_addresses: ring::NEEDED_ADDRESSES,
            },
        ],
        sha256: sha256(model),
    })
}
