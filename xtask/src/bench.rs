//! Size and speed, measured: docs/PERFORMANCE.md.

use std::fs;

use crate::manifest::{self, Manifest};
use crate::process::{Failure, Log, Result, command, output, path};
use crate::steps::Steps;
use crate::{browser, page, toolchain, wasm};

/// Where criterion writes what it measured of each stage.
const STAGES: &str = "target/criterion";

/// Builds the command line and the npm package, times both `runs` times, and writes the document.
pub fn bench(runs: u32) -> Result<()> {
    let manifest: Manifest = manifest::read(manifest::FILE)?;
    let mut steps = Steps::default();
    steps.add("command line", &[], |log| {
        let build = "cargo build --release --package meshmark-cli --target-dir target";
        log.run(&mut command(build), "correct what the compiler names above")
    });
    wasm::add_set_up(&mut steps, &[]);
    page::add(&mut steps, &manifest);
    steps.add("Chromium", &[], browser::set_up);
    steps.add("stages", &["page"], time_stages);
    steps.add("measurements", &["Chromium", "stages"], |log| {
        measure(log, &manifest, runs)
    });
    steps.run()
}

/// Times the stages one by one.
fn time_stages(log: &mut Log) -> Result<()> {
    let folder = path(STAGES);
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|error| Failure::of_file(&folder, &error))?;
    }
    let mut stages = command("cargo bench --bench pipeline --target-dir target");
    stages.env("CRITERION_HOME", folder);
    log.run(&mut stages, "correct what the compiler names above")
}

fn measure(log: &mut Log, manifest: &Manifest, runs: u32) -> Result<()> {
    let rustc = output(&mut command("rustc --version"), "install Rust")?;
    let wasm_rustc = output(
        &mut toolchain::program("rustc", "--version")?,
        "install Rust",
    )?;
    let mut node = command("node www/bench/bench.mjs --cli target/release/meshmark");
    node.env("MESHMARK_CHROMIUM", browser::chromium().unwrap_or_default())
        .args(["--runs", &runs.to_string(), "--stages", STAGES])
        .args(["--native-rustc", &rustc, "--wasm-rustc", &wasm_rustc])
        .args(["--output", "docs/PERFORMANCE.md"]);
    for module in &manifest.modules {
        node.arg("--module").arg(module.path());
        node.args(["--gzip-budget", &module.gzip_budget_bytes.to_string()]);
    }
    log.run(&mut node, "see the error above")
}
