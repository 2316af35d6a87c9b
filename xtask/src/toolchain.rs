//! A Rust compiler for wasm32-unknown-unknown: the one at hand, or what rustup adds to it, or Debian's.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::process::{Result, find, output, run};
use crate::{debian, project};

pub const TARGET: &str = "wasm32-unknown-unknown";
pub const BY_HAND: &str =
    "run `rustup target add wasm32-unknown-unknown` yourself, then this again";

/// A compiler that has the target's standard library.
pub struct Toolchain {
    /// What to put first on PATH; `None` for the compiler that is there anyway.
    bin: Option<PathBuf>,
}

impl Toolchain {
    /// Finds or makes one.
    pub fn set_up() -> Result<Self> {
        if default_has_target()? {
            println!("rustc has {TARGET}");
            return Ok(Self { bin: None });
        }
        if find("rustup").is_some() && std::env::var("RUSTUP_AUTO_INSTALL").as_deref() != Ok("0") {
            run(
                Command::new("rustup").args(["target", "add", TARGET]),
                BY_HAND,
            )?;
            return Ok(Self { bin: None });
        }
        Ok(Self {
            bin: Some(debian::set_up()?),
        })
    }

    /// `cargo ARGUMENTS`, the first of which is the subcommand, for the target.
    pub fn cargo(&self, arguments: &str) -> Command {
        let mut command = match &self.bin {
            None => Command::new("cargo"),
            Some(bin) => debian::cargo(bin),
        };
        command
            .args(arguments.split(' '))
            .current_dir(project::root());
        command
            .env("CARGO_BUILD_TARGET", TARGET)
            .env("CARGO_TARGET_DIR", project::wasm_target());
        command
    }
}

fn default_has_target() -> Result<bool> {
    let mut rustc = Command::new("rustc");
    rustc
        .args(["--print", "target-libdir", "--target", TARGET])
        .current_dir(project::root());
    let libraries = output(&mut rustc, "install Rust by rustup, then run this again")?;
    let Ok(mut entries) = fs::read_dir(libraries) else {
        return Ok(false);
    };
    Ok(entries.any(|entry| {
        entry.is_ok_and(|entry| entry.file_name().to_string_lossy().starts_with("libcore-"))
    }))
}
