//! What compiles for wasm32-unknown-unknown: the compiler at hand, or what rustup adds to it, or Debian's; and wasm-bindgen's tools.

use std::ffi::OsString;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use crate::process::{self, Log, find, output, path};

pub const TARGET: &str = "wasm32-unknown-unknown";

/// The target directory of every wasm command: apart from the native one, for it can have another compiler.
pub const TARGET_DIR: &str = "target/wasm";

/// Debian's compiler with the target's standard library.
const DEBIAN: &str = "target/wasm-toolchain";

/// Finds or makes a compiler that has the target's standard library.
pub fn set_up_compiler(log: &mut Log) -> Result<()> {
    const BY_HAND: &str = "run `rustup target add wasm32-unknown-unknown`, then this again";
    let may_install = || std::env::var("RUSTUP_AUTO_INSTALL").as_deref() != Ok("0");
    let mut install = if rustc_has_target()? {
        return Ok(());
    } else if find("rustup").is_some() && may_install() {
        process::command("rustup target add wasm32-unknown-unknown")
    } else {
        let mut script = process::command("sh xtask/debian-wasm.sh");
        script.args([path(DEBIAN), path(TARGET_DIR)]);
        script
    };
    log.run(&mut install, BY_HAND)
}

/// A command by its words, with that compiler's programs first on PATH.
pub fn command(words: &str) -> Result<Command> {
    let mut command = process::command(words);
    command
        .env("CARGO_BUILD_TARGET", TARGET)
        .env("CARGO_TARGET_DIR", path(TARGET_DIR));
    if !rustc_has_target()? {
        let mut folders = OsString::from(path(DEBIAN).join("bin:"));
        folders.push(std::env::var_os("PATH").unwrap_or_default());
        command.env("PATH", folders);
        // What rustup's cargo sets for its own compiler.
        for variable in [
            "CARGO",
            "LD_LIBRARY_PATH",
            "RUSTUP_TOOLCHAIN",
            "RUSTC",
            "RUSTFLAGS",
        ] {
            command.env_remove(variable);
        }
    }
    Ok(command)
}

fn rustc_has_target() -> Result<bool> {
    let libraries = format!("rustc --print target-libdir --target {TARGET}");
    let libraries = output(&mut process::command(&libraries))?;
    Ok(fs::read_dir(libraries).is_ok_and(|entries| {
        let mut names = entries.flatten().map(|entry| entry.file_name());
        names.any(|name| name.to_string_lossy().starts_with("libcore-"))
    }))
}

/// A program among wasm-bindgen's tools.
pub fn tool(name: &str) -> PathBuf {
    path("target/tools/bin").join(name)
}

/// Installs wasm-bindgen's tools, of the very version that Cargo.lock has; cargo does nothing where they are there.
pub fn set_up_tools(log: &mut Log) -> Result<()> {
    const REMEDY: &str = "see what cargo says above: a version that cannot be found, a registry that does not answer, or a compiler \
        that is too old";
    let package = output(&mut process::command("cargo pkgid wasm-bindgen"))?;
    let (_, version) = package
        .rsplit_once('@')
        .context("cargo pkgid names no version")?;
    // Without default features there is no TLS: the test runner talks to a driver on this machine only.
    let install = format!(
        "cargo install --quiet wasm-bindgen-cli --version {version} --no-default-features --root target/tools \
         --bin wasm-bindgen --bin wasm-bindgen-test-runner"
    );
    let install = |lock: &str| {
        let mut install = process::command(&format!("{install} {lock}"));
        // They are built longer than they ever run.
        install
            .env_remove("CARGO_TARGET_DIR")
            .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1")
            .env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16");
        install
    };
    log.run(&mut install("--locked"), REMEDY).or_else(|_| {
        log.say(
            "not by the lock file that the tools bring: now by the newest versions that they take",
        );
        log.run(&mut install(""), REMEDY)
    })
}
