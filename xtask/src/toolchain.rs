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
fn debian() -> Result<PathBuf> {
    Ok(cache()?.join("wasm-toolchain"))
}

/// What takes minutes to compile and no checkout changes: every checkout of this user has it together.
fn cache() -> Result<PathBuf> {
    let base = std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from);
    let base = base.or_else(|| Some(std::env::home_dir()?.join(".cache")));
    let base = base.context("neither XDG_CACHE_HOME nor HOME is set")?;
    Ok(base.join("meshmark"))
}

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
        script.args([debian()?, path(TARGET_DIR)]);
        script
    };
    log.run(&mut install, BY_HAND)
}

/// A command by its words, with that compiler's programs first on PATH.
pub fn command(words: &str) -> Result<Command> {
    let mut command = process::command(words);
    command
        .env("CARGO_BUILD_TARGET", TARGET)
        .env("CARGO_TARGET_DIR", path(TARGET_DIR))
        .env(
            "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER",
            tool("wasm-bindgen-test-runner")?,
        );
    if !rustc_has_target()? {
        let mut folders = OsString::from(debian()?.join("bin:"));
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
pub fn tool(name: &str) -> Result<PathBuf> {
    Ok(tools(&bindgen_version()?)?.join("bin").join(name))
}

fn tools(version: &str) -> Result<PathBuf> {
    Ok(cache()?.join(format!("wasm-bindgen-{version}")))
}

/// The version that Cargo.lock has: the tools must be of the very same.
fn bindgen_version() -> Result<String> {
    let package = output(&mut process::command("cargo pkgid wasm-bindgen"))?;
    let (_, version) = package
        .rsplit_once('@')
        .context("cargo pkgid names no version")?;
    Ok(version.to_owned())
}

/// Installs wasm-bindgen's tools; cargo does nothing where they are there.
pub fn set_up_tools(log: &mut Log) -> Result<()> {
    const REMEDY: &str = "see what cargo says above: a version that cannot be found, a registry that does not answer, or a compiler \
        that is too old";
    let version = bindgen_version()?;
    let root = tools(&version)?;
    let install = |lock: &str| {
        // Without default features there is no TLS: the test runner talks to a driver on this machine only.
        let mut install = process::command(&format!(
            "cargo install --quiet wasm-bindgen-cli --version {version} --no-default-features \
             --bin wasm-bindgen --bin wasm-bindgen-test-runner {lock} --root"
        ));
        // They are built longer than they ever run.
        install
            .arg(&root)
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
