//! wasm-pack.toml: how the wasm modules are packaged. What each key means is said there.

use std::path::PathBuf;

use anyhow::{Context, Result};
use serde::Deserialize;

use crate::process::path;

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

impl Manifest {
    pub fn read() -> Result<Self> {
        let text = fs_err::read_to_string(path(FILE))?;
        toml::from_str(&text).with_context(|| format!("{FILE} cannot be used"))
    }
}

impl Module {
    /// The module itself, of the files in its folder.
    pub fn path(&self) -> PathBuf {
        path(&self.out_dir).join(format!("{}_bg.wasm", self.name))
    }
}
