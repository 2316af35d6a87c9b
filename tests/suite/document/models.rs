//! Real files, which lie beside the project on some machines: `cargo xtask test` runs these tests there.

use std::fs;
use std::path::{Path, PathBuf};

use meshmark::internals::document::{Document, Files, Transform};

const MODELS: &str = "../shared/models/gltf";

/// Every model of the collection with all files of its folder.
fn models() -> Vec<(PathBuf, Vec<u8>, Files)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(MODELS);
    let mut folders = vec![root.clone()];
    let mut models = Vec::new();
    while let Some(folder) = folders.pop() {
        let Ok(entries) = fs::read_dir(&folder) else {
            continue;
        };
        let mut paths: Vec<PathBuf> = entries
            .map(|entry| entry.expect("an entry").path())
            .collect();
        paths.sort();
        folders.extend(paths.iter().filter(|path| path.is_dir()).cloned());
        let name = |path: &Path| {
            path.file_name()
                .expect("a name")
                .to_string_lossy()
                .into_owned()
        };
        let files: Files = paths
            .iter()
            .filter(|path| path.is_file())
            .map(|path| (name(path), fs::read(path).expect("a file")))
            .collect();
        for (file, bytes) in &files {
            if file.ends_with(".glb") || file.ends_with(".gltf") {
                models.push((folder.join(file), bytes.clone(), files.clone()));
            }
        }
    }
    assert!(!models.is_empty(), "there are no models in {MODELS}");
    models
}

fn is_compressed(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    text.contains("KHR_draco_mesh_compression") || text.contains("_meshopt_compression")
}

#[test]
#[ignore = "needs ../shared/models"]
fn real_files_are_written_byte_for_byte() {
    for (path, bytes, files) in models()
        .into_iter()
        .filter(|(_, bytes, _)| !is_compressed(bytes))
    {
        let mut document = Document::read(&bytes, &files)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let meshes = document.meshes().to_vec();
        for (mesh, content) in meshes.iter().enumerate() {
            for (part, primitive) in content.primitives.iter().enumerate() {
                document.triangles(mesh, part).expect("triangles");
                let accessor = primitive.position.expect("positions");
                let positions = document.positions(accessor).expect("positions");
                document
                    .set_positions(accessor, &positions)
                    .expect("the same positions");
                assert!(document.is_writable(accessor), "{}", path.display());
            }
        }
        let written = document.write().expect("a written document");
        assert!(
            written.model == bytes && written.files.is_empty(),
            "{}",
            path.display()
        );
    }
}

#[test]
#[ignore = "needs ../shared/models"]
fn compressed_real_files_are_read() {
    let compressed = models()
        .into_iter()
        .filter(|(_, bytes, _)| is_compressed(bytes));
    for (path, bytes, files) in compressed {
        let read = Document::read(&bytes, &files);
        let document = read.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let triangles: usize = (0..document.meshes()[0].primitives.len())
            .map(|part| document.triangles(0, part).expect("triangles").len())
            .sum();
        assert!(triangles > 0, "{}", path.display());
        let written = document.write().expect("a written document");
        assert!(written.model == bytes, "{}", path.display());
    }
}

#[test]
#[ignore = "needs ../shared/models"]
fn the_gltf_crate_agrees_about_real_files() {
    for (path, bytes, files) in models()
        .into_iter()
        .filter(|(_, bytes, _)| !is_compressed(bytes))
    {
        let document = Document::read(&bytes, &files).expect("a readable document");
        let other = gltf::Gltf::from_slice(&bytes).expect("the gltf crate reads it");
        assert_eq!(document.nodes().len(), other.nodes().len());
        for (node, other) in document.nodes().iter().zip(other.nodes()) {
            assert_eq!(
                node.children,
                other
                    .children()
                    .map(|child| child.index())
                    .collect::<Vec<_>>()
            );
            assert_eq!(node.mesh, other.mesh().map(|mesh| mesh.index()));
            assert_eq!(node.skin, other.skin().map(|skin| skin.index()));
            match (node.transform, other.transform()) {
                (Transform::Matrix(matrix), gltf::scene::Transform::Matrix { matrix: other }) => {
                    assert_eq!(matrix.map(|entry| entry as f32), *other.as_flattened());
                }
                (
                    Transform::Decomposed {
                        translation,
                        rotation,
                        scale,
                    },
                    gltf::scene::Transform::Decomposed {
                        translation: t,
                        rotation: r,
                        scale: s,
                    },
                ) => {
                    assert_eq!(translation.map(|entry| entry as f32), t);
                    assert_eq!(rotation.map(|entry| entry as f32), r);
                    assert_eq!(scale.map(|entry| entry as f32), s);
                }
                (own, other) => panic!("{own:?} is not {other:?}"),
            }
        }
        for (mesh, other) in document.meshes().iter().zip(other.meshes()) {
            for (primitive, other) in mesh.primitives.iter().zip(other.primitives()) {
                assert_eq!(
                    primitive.position,
                    other
                        .get(&gltf::Semantic::Positions)
                        .map(|accessor| accessor.index())
                );
                assert_eq!(
                    primitive.indices,
                    other.indices().map(|accessor| accessor.index())
                );
                assert_eq!(primitive.mode, other.mode());
                assert_eq!(primitive.has_morph_targets, other.morph_targets().len() > 0);
                let positions = document
                    .positions(primitive.position.expect("positions"))
                    .expect("positions");
                let bounds = other.bounding_box();
                for axis in 0..3 {
                    let components = || positions.iter().map(|position| position[axis] as f32);
                    assert_eq!(
                        components().reduce(f32::min),
                        Some(bounds.min[axis]),
                        "{}",
                        path.display()
                    );
                    assert_eq!(
                        components().reduce(f32::max),
                        Some(bounds.max[axis]),
                        "{}",
                        path.display()
                    );
                }
            }
        }
    }
}
