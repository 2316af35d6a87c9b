//! The checks: what must pass with every commit, and what takes longer.

use crate::manifest::{self, Manifest};
use crate::process::{Log, Result, command, nice, path};
use crate::steps::Steps;
use crate::toolchain::{TARGET, TARGET_DIR};
use crate::{browser, fuzz, npm, page, wasm};

const LINT: &str = "correct what clippy names above";
const TESTS: &str = "see the failed tests above";

/// What every native test step compiles alike, so that it is compiled once: tests, examples and what documentation shows.
const NATIVE: &str = "cargo test --workspace";

/// Runs the checks of a commit, or `all`. What is long stands before what is short, for it decides when the whole ends.
pub fn test(all: bool) -> Result<()> {
    let manifest: Manifest = manifest::read(manifest::FILE)?;
    let mut steps = Steps::default();
    add(
        &mut steps,
        "format",
        &[],
        "cargo fmt --all --check",
        "run `cargo fmt --all`",
    );
    let lint = "cargo clippy --workspace --all-targets --all-features -- -Dwarnings";
    add(&mut steps, "native lint", &["format"], lint, LINT);
    // The page's tests wait for the modules, which are compiled on one core each: the other tests give way to them.
    steps.add("native tests", &["native lint"], |log| {
        log.run(&mut nice(&command(NATIVE)), TESTS)
    });
    wasm::add_set_up(&mut steps, &["format"]);
    page::add(&mut steps, &manifest);
    steps.add("Chromium", &["format"], browser::set_up);
    steps.add("package and page tests", &["page", "Chromium"], |log| {
        run_npm(log, "test")
    });
    let after = ["native tests"];
    steps.add("documentation", &after, |log| {
        let mut doc = command("cargo doc --no-deps --package meshmark");
        log.run(
            doc.env("RUSTDOCFLAGS", "-Dwarnings"),
            "correct what rustdoc names above",
        )
    });
    steps.add(
        "reports of the command line",
        &["page", "native tests"],
        |log| {
            let mut test = npm::npm("run test:command-line");
            log.run(
                test.env("MESHMARK_CLI", path("target/debug/meshmark")),
                TESTS,
            )
        },
    );
    if path("../shared/models").is_dir() {
        let models = format!("{NATIVE} --test suite -- --ignored models::");
        add(
            &mut steps,
            "tests with research models",
            &after,
            &models,
            TESTS,
        );
    }
    // In a worker, as the package runs; there Chromium's engine is Node's.
    let after = ["wasm compiler", "wasm-bindgen tools", "Chromium"];
    steps.add("wasm tests in Chromium", &after, |log| {
        let mut suite = wasm::cargo(&manifest, "test --test suite")?;
        suite
            .env("WASM_BINDGEN_USE_DEDICATED_WORKER", "1")
            // In seconds. The runner's own limits, 20 and 5, are for small suites on idle machines.
            .env("WASM_BINDGEN_TEST_TIMEOUT", "900")
            .env("WASM_BINDGEN_TEST_DRIVER_TIMEOUT", "60");
        log.run(&mut nice(&suite), TESTS)
    });
    if all {
        add_rest(&mut steps, &manifest);
    }
    steps.run_beside_each_other()
}

/// Adds what is left out of a commit's checks.
fn add_rest<'a>(steps: &mut Steps<'a>, manifest: &'a Manifest) {
    let rest = format!("{NATIVE} --test suite -- --ignored --skip models::");
    add(
        steps,
        "all floors and keys",
        &["native tests"],
        &rest,
        TESTS,
    );
    steps.add("wasm lint", &["wasm compiler"], |log| {
        let lint =
            "clippy --lib --test suite --features wasm-marks,wasm-study,wasm-attacks -- -Dwarnings";
        log.run(&mut wasm::cargo(manifest, lint)?, LINT)
    });
    steps.add("wasm tests in Node", &["wasm tests in Chromium"], |log| {
        log.run(&mut wasm::cargo(manifest, "test --test suite")?, TESTS)
    });
    steps.add("dependent crate", &["wasm tests in Chromium"], |log| {
        check_dependent(log, manifest)
    });
    steps.add("fuzzing", &["native tests"], |log| {
        fuzz::run(log, fuzz::SECONDS)
    });
    steps.add("bundlers", &["package and page tests"], |log| {
        run_npm(log, "run test:bundlers")
    });
    let publish = "cargo publish --dry-run --allow-dirty --package meshmark";
    add(
        steps,
        "crate as published",
        &["native tests"],
        publish,
        "see what cargo says above",
    );
}

/// Compiles somebody else's crate for wasm, and sees that it exports its own function alone and has none of the bindings' crates.
fn check_dependent(log: &mut Log, manifest: &Manifest) -> Result<()> {
    log.run(
        &mut wasm::cargo(manifest, "build --release --package dependent")?,
        "correct what the compiler names above",
    )?;
    let module = path(TARGET_DIR).join(format!("{TARGET}/release/dependent.wasm"));
    log.run(
        command("node tests/dependent/check.mjs").arg(module),
        "see which feature of the library exports it",
    )
}

fn add(steps: &mut Steps, name: &str, after: &[&str], words: &str, remedy: &'static str) {
    let mut command = command(words);
    steps.add(name, after, move |log| log.run(&mut command, remedy));
}

/// `npm ARGUMENTS`, told which Chromium to drive.
fn run_npm(log: &mut Log, arguments: &str) -> Result<()> {
    let chromium = browser::chromium().unwrap_or_default();
    log.run(
        npm::npm(arguments).env("MESHMARK_CHROMIUM", chromium),
        TESTS,
    )
}
