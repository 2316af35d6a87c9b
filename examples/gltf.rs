//! Marks a .gltf whose buffers lie beside it: `cargo run --example gltf -- scene.gltf folder-for-the-marked-one`.

use meshmark::{EmbedOptions, Files, Key, Model, Payload, embed, file_names};
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [input, folder] = arguments()?;
    let beside = |name: &str| input.parent().unwrap_or(Path::new("")).join(name);
    let text = std::fs::read(&input)?;
    let mut files = Files::new();
    // The names are the model's: a program that opens what strangers send must see that they do not lead out of its folder.
    for name in file_names(&text)? {
        let bytes = std::fs::read(beside(&name))?;
        files.insert(name, bytes);
    }
    let key = Key::from_passphrase("Ada", "correct horse battery staple")?;
    let payload = Payload::from_tag("ADA-1")?;
    let model = Model::new(&text).with_files(&files);
    let marked = embed(model, payload, &key, &EmbedOptions::default())?;
    std::fs::create_dir_all(&folder)?;
    let name = input.file_name().ok_or("the model has no name")?;
    std::fs::write(folder.join(name), &marked.model)?;
    for (name, bytes) in &marked.files {
        std::fs::write(folder.join(name), bytes)?;
        println!("{name} changed");
    }
    Ok(())
}

fn arguments() -> Result<[PathBuf; 2], &'static str> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    arguments
        .try_into()
        .map_err(|_| "say which model to mark, and a folder for the marked one")
}
