//! wasm-bindgen's tools, of the very version that Cargo.lock has.

use std::fs;
use std::path::PathBuf;

use serde::Deserialize;

use crate::manifest;
use crate::process::{Failure, Log, Result, command, output, path, program_with};

#[derive(Deserialize)]
struct Lock {
    package: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    version: String,
}

/// Where they are, `wasm-bindgen` and `wasm-bindgen-test-runner`.
pub fn folder() -> PathBuf {
    path("target/tools/bin")
}

/// Installs them unless they are there.
pub fn set_up(log: &mut Log) -> Result<()> {
    let lock: Lock = manifest::read("Cargo.lock")?;
    let mut packages = lock.package.into_iter();
    let package = packages.find(|package| package.name == "wasm-bindgen");
    let version = package
        .ok_or_else(|| {
            Failure::new(
                "Cargo.lock has no wasm-bindgen",
                "run `cargo update --workspace`",
            )
        })?
        .version;
    let is_there = |tool: &str| {
        let said = output(&mut program_with(folder().join(tool), "--version"), "");
        said.is_ok_and(|said| said == format!("{tool} {version}"))
    };
    if is_there("wasm-bindgen") && is_there("wasm-bindgen-test-runner") {
        log.say(format_args!("wasm-bindgen {version} is installed"));
        return Ok(());
    }
    install(log, &version, "--locked").or_else(|_| {
        log.say(
            "not by the lock file that the tools bring: now by the newest versions that they take",
        );
        install(log, &version, "")
    })?;
    let build = path(BUILD);
    fs::remove_dir_all(&build).map_err(|error| Failure::of_file(&build, &error))
}

const BUILD: &str = "target/tools/build";

fn install(log: &mut Log, version: &str, lock: &str) -> Result<()> {
    let mut install = command(&format!(
        "cargo install --quiet wasm-bindgen-cli --version {version} {lock} --root target/tools \
         --bin wasm-bindgen --bin wasm-bindgen-test-runner \
         --no-default-features" // no TLS: the test runner talks to a driver on this machine only
    ));
    // They are built longer than they ever run.
    install
        .env("CARGO_TARGET_DIR", path(BUILD))
        .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1")
        .env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16");
    log.run(
        &mut install,
        "see what cargo says above: a version that cannot be found, a registry that does not answer, or a compiler that is too old",
    )
}
