//! `meshmark inspect`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::open;
use crate::report::Report;
use clap::Args;
use meshmark::inspect;
use std::path::PathBuf;

/// Describe a model
#[derive(Args)]
pub struct Inspect {
    /// .glb or .gltf
    input: PathBuf,
}

impl Inspect {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let inspection = inspect(open(&self.input)?.model(&mut clock))?;
        Report::done(&inspection, clock)
    }
}
