//! Coverage-guided fuzzing, by cargo-fuzz.

use anyhow::Result;

use crate::process::{Log, command, path};

/// How long each target runs, unless the caller says otherwise.
pub const SECONDS: u32 = 60;

/// Runs every target for so many seconds, from its seeds and from what earlier runs kept in target/fuzz.
///
/// Without a sanitizer, which needs a compiler that is not stable: safe Rust panics where another language would overrun.
pub fn fuzz(log: &mut Log, seconds: u32) -> Result<()> {
    // Which does nothing where it is there.
    let install = "cargo install --quiet --locked cargo-fuzz --version 0.13.2 --root target/tools";
    let remedy = "install cargo-fuzz yourself, into target/tools";
    log.run(&mut command(install), remedy)?;
    for target in ["document", "evidence", "plan", "record", "round_trip"] {
        let kept = format!("target/fuzz/corpus/{target}");
        fs_err::create_dir_all(path(&kept))?;
        // In seconds: the slowest evidence known takes some.
        let mut run = command(&format!(
            "target/tools/bin/cargo-fuzz fuzz run --sanitizer none {target} {kept} fuzz/seeds/{target} \
             -- -timeout=60 -max_total_time={seconds}"
        ));
        run.env("CARGO_TARGET_DIR", path("target/fuzz"));
        log.run(&mut run, "see the input that cargo-fuzz names above")?;
    }
    Ok(())
}
