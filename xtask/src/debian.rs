//! Debian's Rust compiler made fit for wasm.
//!
//! It knows the target but has no standard library for it, so that is built here, once, from Debian's source. It goes
//! with links to the rest of the compiler into a folder of its own, which wasm commands alone have first on PATH.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::process::{Failure, Result, file_failure, output, run};
use crate::stamp::Stamp;
use crate::toolchain::{BY_HAND, TARGET};
use crate::{apt, project};

const PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "rust-web-clippy"];

/// Returns the folder with `rustc`, `cargo` and the rest.
pub fn set_up() -> Result<PathBuf> {
    if !apt::has(&PACKAGES) {
        apt::install(&PACKAGES, BY_HAND)?;
    }
    let folder = project::root().join("target/wasm-toolchain");
    let rustc = output(
        without_rustup(Command::new("/usr/bin/rustc").arg("-vV")),
        BY_HAND,
    )?;
    let host = rustc.lines().find_map(|line| line.strip_prefix("host: "));
    let host = host.ok_or_else(|| Failure::new("rustc does not say its host", BY_HAND))?;
    let linker = linker(host)?;
    let inputs = [folder.as_os_str(), linker.as_os_str(), rustc.as_ref()];
    let stamp = Stamp::new(folder.join("stamp"), &inputs.map(OsStr::as_encoded_bytes));
    if stamp.is_fresh() {
        println!("{} has {TARGET}", folder.display());
    } else {
        let scratch = folder.join("std");
        let failure = |error| file_failure(&folder, &error);
        remove_old(&folder).map_err(failure)?;
        build_std(&scratch)?;
        lay_out(&folder, &scratch, host, &linker).map_err(failure)?;
        stamp.write()?;
    }
    Ok(folder.join("bin"))
}

/// The `cargo` of that folder.
pub fn cargo(bin: &Path) -> Command {
    let mut path = bin.as_os_str().to_owned();
    if let Some(rest) = std::env::var_os("PATH") {
        path.push(":");
        path.push(rest);
    }
    let mut command = Command::new(bin.join("cargo"));
    without_rustup(&mut command).env("PATH", path);
    command
}

/// Also what was compiled with the old standard library: Cargo takes that for fresh, as the compiler's version is the same.
fn remove_old(folder: &Path) -> io::Result<()> {
    for old in [folder, &project::wasm_target()] {
        if old.exists() {
            fs::remove_dir_all(old)?;
        }
    }
    Ok(())
}

/// Builds the standard library as a dependency of an empty crate in `scratch`.
fn build_std(scratch: &Path) -> Result<()> {
    const MANIFEST: &str = "[package]\nname = \"scratch\"\nedition = \"2024\"\n\n[workspace]\n\n\
        [profile.release]\ncodegen-units = 1\npanic = \"abort\"\n";
    let source = scratch.join("src");
    fs::create_dir_all(&source)
        .and_then(|()| fs::write(scratch.join("Cargo.toml"), MANIFEST))
        .and_then(|()| fs::write(source.join("lib.rs"), "#![no_std]\n"))
        .map_err(|error| file_failure(scratch, &error))?;

    let mut command = Command::new("/usr/bin/cargo");
    without_rustup(&mut command).current_dir(scratch);
    command.args(["build", "--quiet", "--release", "--target", TARGET]);
    command.arg("-Zbuild-std=std,panic_abort,panic_unwind,proc_macro,test");
    command
        .env("RUSTC", "/usr/bin/rustc")
        .env("RUSTC_BOOTSTRAP", "1"); // -Z on a stable compiler
    command.env("CARGO_ENCODED_RUSTFLAGS", "-Cembed-bitcode=yes"); // so that lto = "fat" reaches into it
    command.env("CARGO_TARGET_DIR", scratch.join("target"));
    run(&mut command, BY_HAND)
}

/// Lays `folder` out as a sysroot and the tools that use it; `scratch` is used up.
fn lay_out(folder: &Path, scratch: &Path, host: &str, linker: &Path) -> io::Result<()> {
    let rustlib = folder.join("lib/rustlib");
    let libraries = rustlib.join(TARGET).join("lib");
    fs::create_dir_all(&libraries)?;
    for entry in fs::read_dir(scratch.join("target").join(TARGET).join("release/deps"))? {
        let entry = entry?;
        let name = entry.file_name();
        if name.to_string_lossy().ends_with(".rlib")
            && !name.to_string_lossy().starts_with("libscratch")
        {
            fs::rename(entry.path(), libraries.join(name))?;
        }
    }
    fs::remove_dir_all(scratch)?;

    let host_tools = rustlib.join(host).join("bin");
    fs::create_dir_all(&host_tools)?;
    symlink(linker, host_tools.join("rust-lld"))?;
    symlink(
        format!("/usr/lib/rustlib/{host}/lib"),
        rustlib.join(host).join("lib"),
    )?;
    symlink("/usr/lib/rustlib/src", rustlib.join("src"))?;

    let bin = folder.join("bin");
    fs::create_dir_all(&bin)?;
    symlink("/usr/bin/cargo", bin.join("cargo"))?;
    fs::copy("/usr/bin/cargo-clippy", bin.join("cargo-clippy"))?; // a copy: it looks for clippy-driver beside itself
    for tool in ["rustc", "rustdoc", "clippy-driver"] {
        let script = format!(
            "#!/bin/sh\nexec /usr/bin/{tool} \"$@\" --sysroot '{}'\n",
            folder.display()
        );
        fs::write(bin.join(tool), script)?;
        fs::set_permissions(bin.join(tool), fs::Permissions::from_mode(0o755))?;
    }
    Ok(())
}

/// The linker that every rustup toolchain brings.
fn linker(host: &str) -> Result<PathBuf> {
    let sysroot = output(Command::new("rustc").args(["--print", "sysroot"]), BY_HAND)?;
    let linker = Path::new(&sysroot)
        .join("lib/rustlib")
        .join(host)
        .join("bin/rust-lld");
    if linker.is_file() {
        Ok(linker)
    } else {
        let what = format!("there is no linker at {}", linker.display());
        Err(Failure::new(
            what,
            "install Rust by rustup, then run this again",
        ))
    }
}

/// Takes away what rustup's cargo sets for its own compiler.
fn without_rustup(command: &mut Command) -> &mut Command {
    [
        "CARGO",
        "LD_LIBRARY_PATH",
        "RUSTUP_TOOLCHAIN",
        "RUSTC",
        "RUSTFLAGS",
        "CARGO_ENCODED_RUSTFLAGS",
    ]
    .into_iter()
    .fold(command, |command, variable| command.env_remove(variable))
}
