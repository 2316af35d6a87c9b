//! Robustness, measured: docs/ROBUSTNESS.md.

use std::process::Command;

use crate::process::{Result, run};
use crate::steps::Steps;
use crate::{project, real};

/// Starts the lab, which does all of it but installing other people's programs: with `--real` it is told where they are.
pub fn lab(steps: &mut Steps, arguments: &[&str]) -> Result<()> {
    let mut command = Command::new("cargo");
    command
        .args(["run", "--release", "--package", "meshmark-lab", "--"])
        .current_dir(project::root());
    for argument in arguments {
        command.arg(argument);
        if *argument == "--real" {
            let with_blender = arguments.contains(&"--blender");
            steps.run("other people's programs", || real::set_up(with_blender))?;
            command.arg(project::real_tools());
        }
    }
    steps.run("lab", || run(&mut command, "see the error above"))
}
