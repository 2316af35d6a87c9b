//! A Rust compiler for wasm32-unknown-unknown: the one at hand, or what rustup adds to it, or Debian's.

use std::ffi::OsString;
use std::fs;
use std::process::Command;

use crate::process::{Log, Result, command, find, output, path, program_with};

pub const TARGET: &str = "wasm32-unknown-unknown";

/// The target directory of every wasm command: apart from the native one, for it can have another compiler.
pub const TARGET_DIR: &str = "target/wasm";

/// Debian's compiler with the target's standard library.
const DEBIAN: &str = "target/wasm-toolchain";

/// Finds or makes a compiler that has the target's standard library.
pub fn set_up(log: &mut Log) -> Result<()> {
    const BY_HAND: &str = "run `rustup target add wasm32-unknown-unknown`, then this again";
    if rustc_has_target()? {
        log.say(format_args!("rustc has {TARGET}"));
        Ok(())
    } else if find("rustup").is_some() && std::env::var("RUSTUP_AUTO_INSTALL").as_deref() != Ok("0")
    {
        log.run(command("rustup target add").arg(TARGET), BY_HAND)
    } else {
        let mut script = command("sh xtask/debian-wasm.sh");
        log.run(script.arg(path(DEBIAN)).arg(path(TARGET_DIR)), BY_HAND)
    }
}

/// `cargo ARGUMENTS` for the target, by the compiler that was set up.
pub fn cargo(arguments: &str) -> Result<Command> {
    let mut cargo = program("cargo", arguments)?;
    cargo
        .env("CARGO_BUILD_TARGET", TARGET)
        .env("CARGO_TARGET_DIR", path(TARGET_DIR));
    Ok(cargo)
}

/// A program of that compiler.
pub fn program(name: &str, arguments: &str) -> Result<Command> {
    if rustc_has_target()? {
        return Ok(program_with(name, arguments));
    }
    let bin = path(DEBIAN).join("bin");
    let mut program = program_with(bin.join(name), arguments);
    let mut folders = OsString::from(bin);
    folders.push(":");
    folders.push(std::env::var_os("PATH").unwrap_or_default());
    program.env("PATH", folders);
    // What rustup's cargo sets for its own compiler.
    for variable in [
        "CARGO",
        "LD_LIBRARY_PATH",
        "RUSTUP_TOOLCHAIN",
        "RUSTC",
        "RUSTFLAGS",
    ] {
        program.env_remove(variable);
    }
    Ok(program)
}

fn rustc_has_target() -> Result<bool> {
    let mut rustc = command("rustc --print target-libdir --target");
    let libraries = output(
        rustc.arg(TARGET),
        "install Rust by rustup, then run this again",
    )?;
    Ok(fs::read_dir(libraries).is_ok_and(|entries| {
        let mut names = entries.flatten().map(|entry| entry.file_name());
        names.any(|name| name.to_string_lossy().starts_with("libcore-"))
    }))
}
