//! Coverage-guided fuzzing, by cargo-fuzz.

use std::fs;

use crate::process::{Failure, Log, Result, command, path, program_with};
use crate::steps::Steps;

/// How long each target runs, unless the caller says otherwise.
pub const SECONDS: u32 = 60;

const TARGETS: [&str; 3] = ["document", "evidence", "round_trip"];

/// The targets as a command of their own.
pub fn fuzz(seconds: u32) -> Result<()> {
    let mut steps = Steps::default();
    steps.add("fuzzing", &[], move |log| run(log, seconds));
    steps.run()
}

/// Runs every target for so many seconds, from its seeds and from what earlier runs kept in target/fuzz.
///
/// Without a sanitizer, which needs a compiler that is not stable: safe Rust panics where another language would overrun.
pub fn run(log: &mut Log, seconds: u32) -> Result<()> {
    let tools = path("target/tools");
    let cargo_fuzz = tools.join("bin/cargo-fuzz");
    if !cargo_fuzz.is_file() {
        log.run(
            command("cargo install --quiet --locked cargo-fuzz --version 0.13.2 --root")
                .arg(&tools),
            "install cargo-fuzz yourself, into target/tools",
        )?;
    }
    for target in TARGETS {
        let kept = path("target/fuzz/corpus").join(target);
        fs::create_dir_all(&kept).map_err(|error| Failure::of_file(&kept, &error))?;
        let mut run = program_with(&cargo_fuzz, "fuzz run --sanitizer none");
        run.env("CARGO_TARGET_DIR", path("target/fuzz"));
        run.arg(target)
            .arg(&kept)
            .arg(path("fuzz/seeds").join(target));
        // In seconds: the slowest evidence known takes some.
        run.args(["--", "-timeout=60", &format!("-max_total_time={seconds}")]);
        log.run(&mut run, "see the input that cargo-fuzz names above")?;
    }
    Ok(())
}
