//! `meshmark capacity`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::open;
use crate::report::Report;
use clap::Args;
use meshmark::capacity;
use std::path::PathBuf;

/// Try what a model can hold, with a key that is nobody's
#[derive(Args)]
pub struct Capacity {
    /// .glb or .gltf
    input: PathBuf,
}

impl Capacity {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let capacity = capacity(open(&self.input)?.model(&mut clock))?;
        Report::done(&capacity, clock)
    }
}
