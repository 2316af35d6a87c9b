//! `meshmark study`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::open;
use crate::report::Report;
use clap::Args;
use meshmark::internals::paper::{Preparation, study};
use std::path::PathBuf;

/// Repeat the seed paper's study on a model of at most 11732 faces: what is found again after smoothing
#[derive(Args)]
pub struct Study {
    /// .glb or .gltf
    input: PathBuf,
    /// How it is brought to so many faces: optimize (the paper's way) or simplify
    #[arg(long, default_value = "optimize", value_parser = preparation)]
    preparation: Preparation,
    /// How many keys errors are averaged over, each with a text and random hosts of its own
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    keys: u32,
    /// What keys, texts and random hosts are drawn with
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Study {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let mesh = self.preparation.apply(&open(&self.input)?.mesh()?);
        let study = study(&mesh, self.seed, self.keys, &mut clock).map_err(Failure::of)?;
        Report::done(&study, clock)
    }
}

fn preparation(name: &str) -> Result<Preparation, String> {
    let known = || Preparation::ALL.map(Preparation::name).join(", ");
    Preparation::from_name(name).ok_or_else(|| format!("the preparations are: {}", known()))
}
