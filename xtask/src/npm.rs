//! Node and npm, and the workspace in www/.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::process::{Failure, Result, output, run};
use crate::project;
use crate::stamp::{Stamp, read};

const LOCK: &str = "package-lock.json";
const OLDEST_NODE: (u32, u32) = (20, 19); // what Vite asks for

/// Installs what www/package-lock.json says, unless that is what is there.
pub fn set_up() -> Result<()> {
    install(&project::www())
}

/// Installs what a folder's package-lock.json says, unless that is what is there.
pub fn install(folder: &Path) -> Result<()> {
    let remedy = format!(
        "install Node {}.{} or newer, with npm, then run this again",
        OLDEST_NODE.0, OLDEST_NODE.1
    );
    let node = output(Command::new("node").arg("--version"), &remedy)?;
    let mut numbers = node
        .trim_start_matches('v')
        .split('.')
        .map_while(|number| number.parse().ok());
    let version: (Option<u32>, Option<u32>) = (numbers.next(), numbers.next());
    if version < (Some(OLDEST_NODE.0), Some(OLDEST_NODE.1)) {
        return Err(Failure::new(format!("Node {node} is too old"), remedy));
    }
    let lock = folder.join(LOCK);
    let stamp = Stamp::new(
        folder.join("node_modules/.stamp"),
        &[&read(&lock)?[..], node.as_bytes()],
    );
    if stamp.is_fresh() {
        println!("npm packages are as in {}", lock.display());
        return Ok(());
    }
    run(
        npm()
            .current_dir(folder)
            .args(["ci", "--no-audit", "--no-fund"]),
        "see that the npm registry can be reached, then run this again",
    )?;
    stamp.write()
}

/// The versions of every npm package.
pub fn lock_path() -> PathBuf {
    project::www().join(LOCK)
}

/// `npm` in the workspace.
pub fn npm() -> Command {
    let mut command = Command::new("npm");
    command.current_dir(project::www());
    command
}

/// A program that an npm package brought.
pub fn program(name: &str) -> Command {
    Command::new(project::www().join("node_modules/.bin").join(name))
}
