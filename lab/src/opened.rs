//! A file of somebody's own, with its buffers.

use meshmark::internals::document::Document;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::Scene;
use meshmark::{Files, file_names};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Every .glb and .gltf in a folder and its folders, in order.
pub fn paths(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut paths = Vec::new();
    collect(folder, &mut paths)?;
    paths.sort();
    Ok(paths)
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<(), String> {
    let entries = std::fs::read_dir(folder);
    for entry in entries.map_err(|error| format!("{}: {error}", folder.display()))? {
        let path = entry.map_err(|error| error.to_string())?.path();
        if path.is_dir() {
            collect(&path, paths)?;
        } else if path.extension().is_some_and(|e| e == "glb" || e == "gltf") {
            paths.push(path);
        }
    }
    Ok(())
}

/// A model with its buffers.
pub struct Opened {
    pub bytes: Vec<u8>,
    pub files: Files,
}

impl Opened {
    pub fn new(path: &Path) -> Result<Opened, String> {
        let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
        let mut files = Files::new();
        for name in file_names(&bytes).map_err(|error| error.code().to_owned())? {
            let buffer = std::fs::read(path.with_file_name(&name));
            files.insert(name, buffer.map_err(|error| error.to_string())?);
        }
        Ok(Opened { bytes, files })
    }

    pub fn document(&self) -> Result<Document, String> {
        Document::read(&self.bytes, &self.files).map_err(|error| error.code().to_owned())
    }

    pub fn mesh(&self) -> Result<Mesh, String> {
        let scene = Scene::gather(&self.document()?).map_err(|error| error.code().to_owned())?;
        Ok(scene.mesh)
    }

    /// What its nodes show, rounded to single precision in world space: a mesh for each position accessor of a node.
    pub fn pieces(&self) -> Result<Vec<Mesh>, String> {
        Ok(self
            .rounded()?
            .into_iter()
            .map(|(_, piece)| piece)
            .collect())
    }

    /// The same, as one mesh for each node, with the node's name.
    pub fn objects(&self) -> Result<Vec<(String, Mesh)>, String> {
        let document = self.document()?;
        let mut of_node: BTreeMap<usize, Vec<Mesh>> = BTreeMap::new();
        for (node, piece) in self.rounded()? {
            of_node.entry(node).or_default().push(piece);
        }
        let named = |(node, pieces): (usize, Vec<Mesh>)| {
            let name = document.nodes().get(node);
            let name = name.and_then(|node| node.name.clone());
            (
                name.unwrap_or_else(|| format!("node {node}")),
                Mesh::joined(pieces),
            )
        };
        Ok(of_node.into_iter().map(named).collect())
    }

    fn rounded(&self) -> Result<Vec<(usize, Mesh)>, String> {
        let pieces = Scene::pieces(&self.document()?).map_err(|error| error.code().to_owned())?;
        let round = |(node, piece): (usize, Mesh)| {
            let positions = piece.positions.iter();
            let rounded = positions.map(|p| p.as_vec3().as_dvec3()).collect();
            (node, piece.with_positions(rounded))
        };
        Ok(pieces.into_iter().map(round).collect())
    }
}
