//! Robustness, measured: docs/ROBUSTNESS.md.

use std::process::Command;

use crate::process::{Result, run};
use crate::project;
use crate::steps::Steps;

/// Starts the lab, which does all of it.
pub fn lab(steps: &mut Steps, arguments: &[&str]) -> Result<()> {
    steps.run("lab", || {
        let mut command = Command::new("cargo");
        command
            .args(["run", "--release", "--package", "meshmark-lab", "--"])
            .args(arguments)
            .current_dir(project::root());
        run(&mut command, "see the error above")
    })
}
