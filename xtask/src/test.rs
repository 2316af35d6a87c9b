//! The checks: what must pass with every commit, and what takes longer.

use std::process::Command;

use anyhow::Result;

use crate::manifest::Manifest;
use crate::process::{Log, command, path};
use crate::steps::Steps;
use crate::toolchain::{TARGET, TARGET_DIR};
use crate::{browser, fuzz, npm, page, wasm};

const LINT: &str = "correct what clippy names above";
const COMPILE: &str = "correct what the compiler names above";
const TESTS: &str = "see the failed tests above";

/// What every native test step compiles alike, so that it is compiled once.
const NATIVE: &str = "cargo test --workspace";

/// Runs the checks of a commit, or `all`. What is long stands before what is short, for it decides when the whole ends.
pub fn test(all: bool) -> Result<()> {
    let manifest = Manifest::read()?;
    let mut steps = Steps::default();
    let format = "cargo fmt --all --check";
    add(&mut steps, "format", &[], format, "run `cargo fmt --all`");
    let lint = "cargo clippy --workspace --all-targets --all-features -- -Dwarnings";
    add(&mut steps, "native lint", &["format"], lint, LINT);
    let compile = format!("{NATIVE} --no-run");
    let name = "native tests, compiled";
    add(&mut steps, name, &["native lint"], &compile, COMPILE);
    // By a first letter, so that none is in neither: the suite, and below all others.
    let suite = format!("{NATIVE} --test s*");
    add(&mut steps, "native suite", &[name], &suite, TESTS);
    wasm::add_set_up(&mut steps, &["format"]);
    page::add(&mut steps, &manifest);
    steps.add("Chromium", &["format"], browser::set_up);
    steps.add(
        "package and page tests",
        &["page", "Chromium"],
        move |log| {
            let mut test = npm_test("test");
            if all {
                test.env("MESHMARK_ALL", "1");
            }
            log.run(&mut test, TESTS)
        },
    );
    let others = format!("{NATIVE} --lib --bins --test [!s]*");
    add(&mut steps, "other native tests", &[name], &others, TESTS);
    steps.add("documentation", &["native suite"], |log| {
        log.run(&mut command(&format!("{NATIVE} --doc")), TESTS)?;
        let mut doc = command("cargo doc --no-deps --package meshmark");
        doc.env("RUSTDOCFLAGS", "-Dwarnings");
        log.run(&mut doc, "correct what rustdoc names above")
    });
    let after = ["page", "other native tests"];
    steps.add("command line and modules", &after, |log| {
        let mut test = npm_test("run test:command-line");
        test.env("MESHMARK_CLI", path("target/debug/meshmark"));
        log.run(&mut test, TESTS)
    });
    if path("../shared/models").is_dir() {
        let models = format!("{NATIVE} --test suite -- --ignored models::");
        let name = "tests with research models";
        add(&mut steps, name, &["native suite"], &models, TESTS);
    }
    if all {
        add_rest(&mut steps, &manifest);
    }
    steps.run()
}

/// Adds what is left out of a commit's checks.
fn add_rest<'a>(steps: &mut Steps<'a>, manifest: &'a Manifest) {
    let native = ["native suite"];
    let rest = format!("{NATIVE} --test suite --test limits -- --ignored --skip models::");
    add(steps, "what takes minutes", &native, &rest, TESTS);
    steps.add("wasm lint", &["wasm compiler"], |log| {
        let lint =
            "cargo clippy --lib --test suite --features wasm-full,wasm-research -- -Dwarnings";
        log.run(&mut wasm::command(manifest, lint)?, LINT)
    });
    // In a worker, as the package runs.
    let after = ["wasm compiler", "wasm-bindgen tools", "Chromium"];
    steps.add("wasm tests in Chromium", &after, |log| {
        let mut suite = wasm::command(manifest, "cargo test --test suite")?;
        suite
            .env("WASM_BINDGEN_USE_DEDICATED_WORKER", "1")
            // In seconds. The runner's own limits, 20 and 5, are for small suites on idle machines.
            .env("WASM_BINDGEN_TEST_TIMEOUT", "7200")
            .env("WASM_BINDGEN_TEST_DRIVER_TIMEOUT", "60");
        log.run(&mut suite, TESTS)
    });
    steps.add("wasm tests in Node", &["wasm tests in Chromium"], |log| {
        let mut suite = wasm::command(manifest, "cargo test --test suite")?;
        log.run(&mut suite, TESTS)
    });
    steps.add("dependent crate", &["wasm tests in Chromium"], |log| {
        check_dependent(log, manifest)
    });
    steps.add("fuzzing", &native, |log| fuzz::fuzz(log, fuzz::SECONDS));
    steps.add("bundlers", &["package and page tests"], |log| {
        log.run(&mut npm_test("run test:bundlers"), TESTS)
    });
    steps.add("example marketplace", &["package and page tests"], |log| {
        let mut npm = |arguments: &str| {
            let mut npm = npm_test(arguments);
            npm.current_dir(path("examples/marketplace"));
            log.run(&mut npm, TESTS)
        };
        npm("ci --no-audit --no-fund")?;
        npm("test")
    });
    let publish = "cargo publish --dry-run --allow-dirty --package meshmark";
    let remedy = "see what cargo says above";
    add(steps, "crate as published", &native, publish, remedy);
}

/// Compiles somebody else's crate for wasm, and sees that it exports its own function alone and has none of the bindings' crates.
fn check_dependent(log: &mut Log, manifest: &Manifest) -> Result<()> {
    let mut build = wasm::command(manifest, "cargo build --release --package dependent")?;
    log.run(&mut build, COMPILE)?;
    let module = format!("{TARGET_DIR}/{TARGET}/release/dependent.wasm");
    let mut check = command(&format!("node tests/dependent/check.mjs {module}"));
    log.run(&mut check, "see which feature of the library exports it")
}

fn add(steps: &mut Steps, name: &str, after: &[&str], words: &str, remedy: &'static str) {
    let mut command = command(words);
    steps.add(name, after, move |log| log.run(&mut command, remedy));
}

/// `npm ARGUMENTS`, told which Chromium to drive.
fn npm_test(arguments: &str) -> Command {
    let mut npm = npm::npm(arguments);
    npm.env("MESHMARK_CHROMIUM", browser::chromium().unwrap_or_default());
    npm
}
