//! `meshmark inspect`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::open;
use crate::report::Report;
use clap::Args;
use meshmark::{Capacity, Inspection, capacity, inspect};
use serde::Serialize;
use std::path::PathBuf;

/// Describe a model, and try what it can hold
#[derive(Args)]
pub struct Inspect {
    /// .glb or .gltf
    input: PathBuf,
}

/// What a model is made of, and what it can hold.
#[derive(Serialize)]
struct Told {
    #[serde(flatten)]
    inspection: Inspection,
    capacity: Capacity,
}

impl Inspect {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let input = open(&self.input)?;
        let inspection = inspect(input.model(&mut clock))?;
        let capacity = capacity(input.model(&mut clock))?;
        Report::done(
            &Told {
                inspection,
                capacity,
            },
            clock,
        )
    }
}
