//! Size and speed, measured: docs/PERFORMANCE.md.

use std::path::Path;
use std::process::Command;

use crate::manifest::Manifest;
use crate::process::{Failure, Result, output, run};
use crate::steps::Steps;
use crate::wasm::Builder;
use crate::{browser, npm, page, project};

pub const DEFAULT_RUNS: u32 = 9;

/// Builds the command line and the npm package, times both `runs` times, and writes the document.
pub fn bench(steps: &mut Steps, runs: u32) -> Result<()> {
    let builder = Builder::set_up(steps)?;
    steps.run("command line", || {
        run(
            Command::new("cargo")
                .args(["build", "--release", "--features", "cli"])
                .args(["--bin", "meshmark", "--target-dir", "target"])
                .current_dir(project::root()),
            "correct what the compiler names above",
        )
    })?;
    steps.run("npm packages", npm::set_up)?;
    steps.run("wasm modules", || builder.package())?;
    steps.run("page", page::build)?;
    let browser = steps.run("Chromium", browser::set_up)?;
    steps.run("stages", time_stages)?;
    steps.run("measurements", || {
        let native_rustc = rustc_version(&Command::new("cargo"))?;
        let wasm_rustc = rustc_version(&builder.cargo("build"))?;
        let mut node = Command::new("node");
        node.current_dir(project::root())
            .env("MESHMARK_CHROMIUM", browser.chromium)
            .arg("www/bench/bench.mjs")
            .args(["--runs", &runs.to_string()])
            .args(["--cli", "target/release/meshmark"])
            .args(["--stages", STAGES])
            .args(["--native-rustc", &native_rustc])
            .args(["--wasm-rustc", &wasm_rustc])
            .args(["--output", "docs/PERFORMANCE.md"]);
        for module in Manifest::read()?.modules {
            node.arg("--module").arg(module.path());
            node.args(["--gzip-budget", &module.gzip_budget_bytes.to_string()]);
        }
        run(&mut node, "see the error above")
    })
}

/// Where criterion writes what it measured of each stage.
const STAGES: &str = "target/criterion";

/// Times the stages one by one.
fn time_stages() -> Result<()> {
    let folder = project::root().join(STAGES);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(|error| {
            Failure::new(
                format!("{}: {error}", folder.display()),
                "remove that folder",
            )
        })?;
    }
    run(
        Command::new("cargo")
            .args(["bench", "--bench", "pipeline", "--target-dir", "target"])
            .env("CRITERION_HOME", folder)
            .current_dir(project::root()),
        "correct what the compiler names above",
    )
}

/// A number of runs as the command line gives it.
pub fn parse_runs(text: &str) -> Result<u32> {
    match text.parse() {
        Ok(0) | Err(_) => Err(Failure::new(
            format!("{text} is not a number of runs"),
            "give a whole number from 1",
        )),
        Ok(runs) => Ok(runs),
    }
}

/// The version of the compiler that a `cargo` command would use: the one beside that cargo, in its environment.
fn rustc_version(cargo: &Command) -> Result<String> {
    let program = Path::new(cargo.get_program()).with_file_name("rustc");
    let mut rustc = Command::new(program);
    rustc.current_dir(project::root());
    for (name, value) in cargo.get_envs() {
        match value {
            Some(value) => rustc.env(name, value),
            None => rustc.env_remove(name),
        };
    }
    output(rustc.arg("--version"), "see that Rust is installed")
}
