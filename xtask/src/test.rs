//! Every check there is, up to the first that fails.

use std::process::Command;

use crate::process::{Result, run};
use crate::steps::Steps;
use crate::wasm::Builder;
use crate::{browser, npm, page, project};

const LINT: &str = "correct what clippy names above";
const TESTS: &str = "see the failed tests above";

pub fn test(steps: &mut Steps) -> Result<()> {
    steps.run("format", || {
        run(&mut native("fmt --all --check"), "run `cargo fmt --all`")
    })?;
    steps.run("native lint", || {
        run(
            &mut native("clippy --workspace --all-targets --all-features -- -Dwarnings"),
            LINT,
        )
    })?;
    steps.run("documentation tests", || {
        run(&mut native("test --doc"), TESTS)
    })?;
    steps.run("native tests", || {
        run(
            &mut native("test --workspace --features cli --lib --bins --tests"),
            TESTS,
        )
    })?;

    let builder = Builder::set_up(steps)?;
    steps.run("wasm lint", || {
        run(
            &mut builder.cargo("clippy --lib --test suite --features study,attacks -- -Dwarnings"),
            LINT,
        )
    })?;
    steps.run("wasm tests in Node", || {
        run(&mut builder.cargo("test --test suite"), TESTS)
    })?;
    let browser = steps.run("Chromium", browser::set_up)?;
    steps.run("wasm tests in Chromium", || {
        let mut command = builder.cargo("test --test suite --features browser");
        command.env("CHROMEDRIVER", &browser.driver);
        // In seconds. The runner's own limits, 20 and 5, are for small suites on idle machines.
        command.env("WASM_BINDGEN_TEST_TIMEOUT", "600");
        command.env("WASM_BINDGEN_TEST_DRIVER_TIMEOUT", "60");
        run(&mut command, TESTS)
    })?;

    steps.run("npm packages", npm::set_up)?;
    steps.run("wasm modules", || builder.package())?;
    steps.run("page", page::build)?;
    steps.run("package and page tests", || {
        run(
            npm::npm()
                .arg("test")
                .env("MESHMARK_CHROMIUM", &browser.chromium),
            TESTS,
        )
    })
}

/// `cargo ARGUMENTS` for this machine.
fn native(arguments: &str) -> Command {
    let mut command = Command::new("cargo");
    command
        .args(arguments.split(' '))
        .current_dir(project::root());
    command
}
