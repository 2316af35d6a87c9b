//! wasm-pack.toml: how the wasm modules are packaged. What each key means is said there.

use std::fs;
use std::path::PathBuf;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::process::{Failure, Result, path};

pub const FILE: &str = "wasm-pack.toml";

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Manifest {
    pub target: String,
    pub rust_flags: String,
    pub wasm_opt_flags: String,
    #[serde(rename = "module")]
    pub modules: Vec<Module>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Module {
    pub name: String,
    pub feature: String,
    pub out_dir: String,
    pub gzip_budget_bytes: u64,
}

impl Module {
    /// The module itself, of the files in its folder.
    pub fn path(&self) -> PathBuf {
        path(&self.out_dir).join(format!("{}_bg.wasm", self.name))
    }
}

/// Reads a TOML file in the workspace's root.
pub fn read<T: DeserializeOwned>(file: &str) -> Result<T> {
    let text =
        fs::read_to_string(path(file)).map_err(|error| Failure::of_file(&path(file), &error))?;
    toml::from_str(&text)
        .map_err(|error| Failure::new(format!("{file}: {error}"), format!("correct {file}")))
}
