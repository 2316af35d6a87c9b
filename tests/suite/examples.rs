//! The programs in `examples/`, run as a newcomer would.
#![cfg(not(target_arch = "wasm32"))]

use crate::support::fixtures::gallery;
use crate::support::gltf_builder::Packing;
use meshmark::{Key, Model, Verdict, demo_model, detect};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder of its own for one test, gone with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let name = format!("meshmark-example-{name}-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    /// What an example prints; `cargo test` builds them beside this program's folder.
    fn run(&self, example: &str, arguments: &[&str]) -> String {
        let own = std::env::current_exe().unwrap();
        let programs = own.parent().and_then(Path::parent).unwrap();
        let program = programs.join("examples").join(example);
        let mut command = Command::new(program);
        let output = command.args(arguments).current_dir(&self.0).output();
        let output = output.unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{example}: {said}");
        String::from_utf8(output.stdout).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).unwrap();
    }
}

#[test]
fn examples_mark_and_find() {
    let folder = Folder::new("mark");
    std::fs::write(folder.0.join("model.glb"), demo_model()).unwrap();
    let said = folder.run("embed", &["model.glb", "marked.glb"]);
    assert!(said.contains("simplify-30  Green"), "{said}");
    let said = folder.run("detect", &["marked.glb"]);
    assert!(said.contains("It says ADA-1."), "{said}");
    assert!(!folder.run("detect", &["model.glb"]).contains("ADA-1"));
    let said = folder.run("many_keys", &["marked.glb"]);
    assert_eq!(said, "Ada: ADA-1\nGrace: -\nHedy: -\n");
}

#[test]
fn example_marks_a_gltf_with_buffers() {
    let folder = Folder::new("gltf");
    let built = gallery(Packing::External);
    std::fs::write(folder.0.join("scene.gltf"), &built.bytes).unwrap();
    for (name, bytes) in &built.files {
        std::fs::write(folder.0.join(name), bytes).unwrap();
    }
    folder.run("gltf", &["scene.gltf", "marked"]);
    let read = |name: &str| std::fs::read(folder.0.join("marked").join(name)).unwrap();
    let mut files = built.files.clone();
    for (name, bytes) in &mut files {
        if folder.0.join("marked").join(name).exists() {
            *bytes = read(name);
        }
    }
    let key = Key::from_passphrase("Ada", "correct horse battery staple").unwrap();
    let model = read("scene.gltf");
    let found = detect(Model::new(&model).with_files(&files), &key, None).unwrap();
    assert_eq!(found.verdict, Verdict::Found);
}
