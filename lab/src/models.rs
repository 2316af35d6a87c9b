//! What is marked: generated shapes, and files where there are some.

use glam::DVec3;
use meshmark::Files;
use meshmark::internals::document::Document;
use meshmark::internals::mesh::{Edges, Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use std::path::{Path, PathBuf};

/// What a model is like, and so which table it is in.
#[derive(Clone, Copy, PartialEq)]
pub enum Class {
    /// One closed or nearly closed surface with axes of its own.
    Plain,
    /// Without axes of its own.
    Symmetric,
    /// Of many parts, or of few vertices.
    Game,
}

impl Class {
    pub const ALL: [(Class, &str); 3] = [
        (Class::Plain, "Scanned, organic and machined shapes"),
        (Class::Symmetric, "Symmetric shapes"),
        (Class::Game, "Game assets, many parts and low-poly models"),
    ];
}

/// The smallest grid that a model is in.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
pub enum Size {
    Quick,
    Usual,
    Full,
}

pub struct Model {
    pub name: String,
    pub class: Class,
    /// A `.glb`.
    pub bytes: Vec<u8>,
    pub size: Size,
}

/// Vertices without which a file is no model to mark.
const FEWEST_VERTICES: usize = 500;
/// Of files: fewer vertices are low-poly, more components are many parts.
const LOW_POLY: usize = 2000;
const MANY_PARTS: usize = 5;
/// Of the default folder.
const SCENES: [&str; 3] = ["chr_knight.glb", "ShapeCollection.glb", "DenseSphere.glb"];
const SYMMETRIC: [&str; 1] = ["DenseSphere"];
const QUICK: [&str; 3] = ["rocker-arm", "cow", "chr_knight"];
const USUAL: [&str; 3] = ["stanford-bunny", "fandisk", "ShapeCollection"];

/// Every model, files first, and what files could not be read.
pub fn all(folder: Option<&Path>) -> Result<(Vec<Model>, Vec<String>), String> {
    let (mut models, unread) = from_files(folder)?;
    models.extend(generated());
    Ok((models, unread))
}

/// The files of a folder that have so many vertices, but no generated models.
pub fn of_folder(folder: &Path, fewest: usize) -> Result<Vec<Model>, String> {
    let read = files(folder)?.into_iter().map(|path| read(&path, fewest));
    // What cannot be read is no model to mark.
    Ok(read.flatten().flatten().collect())
}

/// The study's models: plain shapes from files, and two that are generated with four times the faces that the paper's has.
pub fn of_study(folder: Option<&Path>) -> Result<Vec<Model>, String> {
    let (mut models, _) = from_files(folder)?;
    models.retain(|model| model.class == Class::Plain);
    let shapes = [
        ("asteroid", shapes::asteroid(130, 180)),
        ("torus knot", shapes::torus_knot(366, 64)),
    ];
    models.extend(shapes.into_iter().map(|(name, mesh)| Model {
        name: name.to_owned(),
        class: Class::Plain,
        bytes: to_glb(&mesh),
        size: Size::Quick,
    }));
    Ok(models)
}

fn from_files(folder: Option<&Path>) -> Result<(Vec<Model>, Vec<String>), String> {
    let paths = match folder {
        Some(folder) => files(folder)?,
        None => {
            let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/models");
            let mut paths = if shared.exists() {
                files(&shared.join("obj"))?
            } else {
                Vec::new()
            };
            let scenes = SCENES.map(|scene| shared.join("gltf").join(scene));
            paths.extend(scenes.into_iter().filter(|path| path.exists()));
            paths
        }
    };
    let (mut models, mut unread) = (Vec::new(), Vec::new());
    for path in paths {
        match read(&path, FEWEST_VERTICES) {
            Ok(model) => models.extend(model),
            Err(error) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                unread.push(format!("{name}: {error}"));
            }
        }
    }
    Ok((models, unread))
}

/// Models of this project's own making.
pub fn generated() -> impl Iterator<Item = Model> {
    use Class::{Game, Plain, Symmetric};
    use Size::{Full, Quick, Usual};
    let shapes = [
        ("asteroid", Plain, shapes::asteroid(60, 90), Quick),
        ("torus knot", Plain, shapes::torus_knot(240, 32), Full),
        ("terrain", Plain, shapes::terrain(80), Usual),
        ("leaf", Plain, shapes::leaf(70, 90), Usual),
        ("machined part", Plain, shapes::cad_part(), Quick),
        ("torus", Symmetric, shapes::torus(120, 48), Quick),
        ("vase", Symmetric, shapes::vase(60, 80), Usual),
        (
            "sphere with relief",
            Symmetric,
            shapes::relief_sphere(60, 90),
            Full,
        ),
        ("capsule", Symmetric, shapes::capsule(60, 80), Full),
        ("icosphere", Symmetric, shapes::icosphere(4), Full),
        ("rover", Game, shapes::game_asset(), Quick),
        ("seven shapes", Game, shapes::seven_shapes(), Full),
        ("creature", Game, shapes::low_poly(), Full),
    ];
    shapes.into_iter().map(|(name, class, mesh, size)| Model {
        name: name.to_owned(),
        class,
        bytes: to_glb(&mesh),
        size,
    })
}

fn files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = std::fs::read_dir(folder);
    let entries = entries.map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| matches!(extension(path), "glb" | "obj"));
    paths.sort();
    Ok(paths)
}

fn extension(path: &Path) -> &str {
    path.extension().and_then(|e| e.to_str()).unwrap_or("")
}

/// A model, unless it is too small.
fn read(path: &Path, fewest: usize) -> Result<Option<Model>, String> {
    let bytes = match extension(path) {
        "obj" => to_glb(&read_obj(path)?),
        _ => std::fs::read(path).map_err(|error| error.to_string())?,
    };
    let mesh = gathered(&bytes)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let is_game =
        mesh.positions.len() < LOW_POLY || Edges::new(&mesh).num_components() > MANY_PARTS;
    let class = match (SYMMETRIC.contains(&&*name), is_game) {
        (true, _) => Class::Symmetric,
        (_, true) => Class::Game,
        _ => Class::Plain,
    };
    let size = match &*name {
        name if QUICK.contains(&name) => Size::Quick,
        name if USUAL.contains(&name) => Size::Usual,
        _ => Size::Full,
    };
    Ok((mesh.positions.len() >= fewest).then(|| Model {
        class,
        bytes,
        size,
        name: name.into_owned(),
    }))
}

/// The mesh of a `.glb`, as it is seen by whoever checks it.
pub fn gathered(bytes: &[u8]) -> Result<Mesh, String> {
    let document = Document::read(bytes, &Files::new()).map_err(|error| error.to_string())?;
    let scene = Scene::gather(&document).map_err(|error| error.to_string())?;
    Ok(scene.mesh)
}

/// The surface of a Wavefront .obj, polygons as fans.
fn read_obj(path: &Path) -> Result<Mesh, String> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    let (models, _) = tobj::load_obj(path, &options).map_err(|error| error.to_string())?;
    Ok(Mesh::joined(models.into_iter().map(|model| {
        let (positions, _) = model.mesh.positions.as_chunks();
        let (triangles, _) = model.mesh.indices.as_chunks();
        Mesh {
            positions: positions.iter().copied().map(DVec3::from_array).collect(),
            triangles: triangles.to_vec(),
        }
    })))
}
