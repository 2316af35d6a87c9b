//! `meshmark attack`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::{open, store};
use crate::report::Report;
use clap::Args;
use meshmark::internals::attack::{Step, chain, step};
use meshmark::internals::geometry::Quality;
use meshmark::internals::scene::to_glb;
use serde::Serialize;
use std::path::PathBuf;

/// Attack a model as the robustness tables do, and measure what that cost it
#[derive(Args)]
pub struct Attack {
    /// .glb or .gltf
    input: PathBuf,
    /// Where the attacked copy goes: a .glb with the geometry alone
    output: PathBuf,
    /// An attack at one of its levels, as `meshmark attacks` names it; more than one are made one after another
    #[arg(long = "step", value_name = "ATTACK", required = true, value_parser = attack_step)]
    steps: Vec<Step>,
    /// What is random is drawn with
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Attack {
    pub fn run(self) -> Result<Report, Failure> {
        let clock = Clock::new();
        let mesh = open(&self.input)?.mesh()?;
        let attacked = chain(&mesh, &self.steps, self.seed);
        store(&self.output, &to_glb(&attacked))?;
        let cost = Cost {
            steps: self.steps.iter().map(Step::to_string).collect(),
            seed: self.seed,
            vertices: attacked.positions.len(),
            triangles: attacked.triangles.len(),
            quality: Quality::between(&mesh, &attacked),
        };
        Report::done(&cost, clock)
    }
}

#[derive(Serialize)]
struct Cost {
    steps: Vec<String>,
    seed: u64,
    vertices: usize,
    triangles: usize,
    #[serde(flatten)]
    quality: Quality,
}

fn attack_step(name: &str) -> Result<Step, String> {
    step(name).ok_or_else(|| "there is no such attack; `meshmark attacks` lists them".to_owned())
}
