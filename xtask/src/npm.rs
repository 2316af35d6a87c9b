//! Node and npm, and the workspace in www/.

use std::process::Command;

use anyhow::{Result, ensure};

use crate::freshness::is_fresh;
use crate::process::{Log, TO_DO, command, output, path};

/// The versions of every npm package.
pub const LOCK: &str = "www/package-lock.json";

/// Installs what the lock file says, unless that is what is there.
pub fn set_up(log: &mut Log) -> Result<()> {
    const REMEDY: &str = "install Node 20.19 or newer, with npm, then run this again"; // what Vite asks for
    let node = output(&mut command("node --version"))?;
    let numbers = node.trim_start_matches('v').split('.');
    let version: Vec<u32> = numbers.map_while(|number| number.parse().ok()).collect();
    ensure!(
        version >= vec![20, 19],
        "Node {node} is too old\n{TO_DO}{REMEDY}"
    );
    // npm's own note of what it installed, written last.
    if is_fresh(&path("www/node_modules/.package-lock.json"), &[path(LOCK)])? {
        return Ok(());
    }
    let remedy = "see what npm names above, then run this again";
    log.run(&mut npm("ci --no-audit --no-fund"), remedy)
}

/// `npm ARGUMENTS` in the workspace.
pub fn npm(arguments: &str) -> Command {
    let mut npm = command(&format!("npm {arguments}"));
    npm.current_dir(path("www"));
    npm
}

/// A program that an npm package brought.
pub fn program(name: &str, arguments: &str) -> Command {
    let mut program = Command::new(path("www/node_modules/.bin").join(name));
    program.args(arguments.split_whitespace());
    program
}
