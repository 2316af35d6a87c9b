//! Size and speed, measured: docs/PERFORMANCE.md.

use anyhow::Result;

use crate::manifest::Manifest;
use crate::process::{Log, command, output, path};
use crate::{browser, page, toolchain};

/// Where criterion writes what it measured of each stage.
const STAGES: &str = "target/criterion";

/// Builds the command line and the npm package, times both and the stages `runs` times, and writes the document.
pub fn bench(log: &mut Log, runs: u32) -> Result<()> {
    const REMEDY: &str = "correct what the compiler names above";
    let manifest = Manifest::read()?;
    page::build()?;
    browser::set_up(log)?;
    let build = "cargo build --release --package meshmark-cli --target-dir target";
    log.run(&mut command(build), REMEDY)?;
    if path(STAGES).exists() {
        fs_err::remove_dir_all(path(STAGES))?;
    }
    let mut stages = command("cargo bench --bench * --target-dir target");
    log.run(stages.env("CRITERION_HOME", path(STAGES)), REMEDY)?;

    let rustc = "rustc --version";
    let mut node = command("node www/bench/bench.mjs --cli target/release/meshmark");
    node.env("MESHMARK_CHROMIUM", browser::chromium().unwrap_or_default())
        .args(["--runs", &runs.to_string(), "--stages", STAGES])
        .args(["--native-rustc", &output(&mut command(rustc))?])
        .args(["--wasm-rustc", &output(&mut toolchain::command(rustc)?)?])
        .args(["--output", "docs/PERFORMANCE.md"]);
    for module in &manifest.modules {
        node.arg("--module").arg(module.path());
        node.args(["--gzip-budget", &module.gzip_budget_bytes.to_string()]);
    }
    log.run(&mut node, "see the error above")
}
