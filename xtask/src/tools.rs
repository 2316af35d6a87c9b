//! wasm-bindgen's tools, of the very version that the lock file has.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::process::{Failure, Result, file_failure, run};
use crate::project;

/// Installs `wasm-bindgen` and `wasm-bindgen-test-runner` unless they are there, and returns their folder.
pub fn set_up() -> Result<PathBuf> {
    let version = locked_version("wasm-bindgen")?;
    let bin = project::tools().join("bin");
    let installed = Command::new(bin.join("wasm-bindgen"))
        .arg("--version")
        .output();
    if installed
        .is_ok_and(|said| said.stdout.trim_ascii() == format!("wasm-bindgen {version}").as_bytes())
    {
        println!("wasm-bindgen {version} is installed");
        return Ok(bin);
    }
    // Its own lock file can name a release that a mirror of the registry does not have yet.
    install(&version, &["--locked"]).or_else(|failure| {
        println!("{failure}\nnow without the tool's own lock file");
        install(&version, &[])
    })?;
    Ok(bin)
}

fn install(version: &str, options: &[&str]) -> Result<()> {
    let build = project::tools().join("build");
    let mut command = Command::new("cargo");
    command
        .args([
            "install",
            "--quiet",
            "wasm-bindgen-cli",
            "--version",
            version,
        ])
        .args(options);
    command.arg("--no-default-features"); // TLS: the test runner talks to a driver on this machine only
    command
        .arg("--root")
        .arg(project::tools())
        .env("CARGO_TARGET_DIR", &build);
    run(
        &mut command,
        "see that the crates.io registry can be reached, then run this again",
    )?;
    fs::remove_dir_all(&build).map_err(|error| file_failure(&build, &error))
}

/// The version of a package in Cargo.lock.
fn locked_version(package: &str) -> Result<String> {
    let path = project::root().join("Cargo.lock");
    let lock = fs::read_to_string(&path).map_err(|error| file_failure(&path, &error))?;
    let mut lines = lock.lines();
    lines.find(|line| *line == format!("name = \"{package}\""));
    let version = lines
        .next()
        .and_then(|line| line.strip_prefix("version = \"")?.strip_suffix('"'));
    let version = version.ok_or_else(|| {
        Failure::new(
            format!("Cargo.lock has no {package}"),
            "run `cargo generate-lockfile`",
        )
    })?;
    Ok(version.to_owned())
}
