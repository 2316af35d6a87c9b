//! The seed paper's study on every model: docs/STUDY.md and its plots.

mod layers;
mod measure;
mod note;
mod report;
mod verdict;

use crate::models::Model;
use crate::seed::Seed;
use std::path::Path;

/// Studies model after model, and writes the document anew after each, with its plots in a folder `study` beside it.
pub fn write(models: &[Model], seed: &Seed, num_keys: u32, path: &Path) -> Result<(), String> {
    let folder = path.with_file_name("study");
    let said = |error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::create_dir_all(&folder).map_err(said)?;
    let mut results = Vec::new();
    for (model, number) in models.iter().zip(1..) {
        eprintln!("{number} of {}: {}", models.len(), model.name);
        let outcome = measure::outcome(model, seed, num_keys);
        results.push((model.name.clone(), outcome));
        let (text, plots) = report::document(&results, seed, num_keys);
        std::fs::write(path, text).map_err(said)?;
        for (name, svg) in plots {
            std::fs::write(folder.join(name), svg).map_err(said)?;
        }
    }
    Ok(())
}
