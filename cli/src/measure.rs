//! `meshmark measure`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::{open_suspect, store};
use crate::report::Report;
use clap::Args;
use meshmark::measure;
use serde_json::json;
use std::path::PathBuf;

/// Measure a model without a key; the evidence can be tested later, elsewhere
#[derive(Args)]
pub struct Measure {
    /// glTF (.glb, .gltf, .vrm, .b3dm), .obj, .stl or .ply, or one of them as .gz
    input: PathBuf,
    /// Where the evidence goes
    evidence: PathBuf,
}

impl Measure {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let bytes = measure(open_suspect(&self.input)?.suspect(&mut clock))?.to_bytes();
        store(&self.evidence, &bytes)?;
        Report::done(&json!({ "bytes": bytes.len() }), clock)
    }
}
