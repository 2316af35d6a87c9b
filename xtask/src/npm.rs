//! Node and npm, and the workspace in www/.

use std::process::Command;

use crate::process::{Log, Result, check, command, output, path, program_with};
use crate::stamp::{Stamp, read};

/// The versions of every npm package.
pub const LOCK: &str = "www/package-lock.json";

/// Installs what the lock file says, unless that is what is there.
pub fn set_up(log: &mut Log) -> Result<()> {
    const REMEDY: &str = "install Node 20.19 or newer, with npm, then run this again"; // what Vite asks for
    let node = output(&mut command("node --version"), REMEDY)?;
    let numbers = node.trim_start_matches('v').split('.');
    let version: Vec<u32> = numbers.map_while(|number| number.parse().ok()).collect();
    let too_old = || format!("Node {node} is too old");
    check(version >= vec![20, 19], too_old, REMEDY)?;
    let stamp = Stamp::new(
        path("www/node_modules/.stamp"),
        &[&read(&path(LOCK))?[..], node.as_bytes()],
    );
    if stamp.is_fresh() {
        log.say(format_args!("npm packages are as in {LOCK}"));
        return Ok(());
    }
    log.run(
        &mut npm("ci --no-audit --no-fund"),
        "see what npm names above, then run this again",
    )?;
    stamp.write()
}

/// `npm ARGUMENTS` in the workspace.
pub fn npm(arguments: &str) -> Command {
    let mut npm = command(&format!("npm {arguments}"));
    npm.current_dir(path("www"));
    npm
}

/// A program that an npm package brought.
pub fn program(name: &str, arguments: &str) -> Command {
    program_with(path("www/node_modules/.bin").join(name), arguments)
}
