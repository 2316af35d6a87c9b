//! Robustness, measured: docs/ROBUSTNESS.md.

use crate::process::{Result, command};
use crate::steps::Steps;

/// Starts the lab, which does all of it but installing other people's programs: with `--real` it is told where they are.
pub fn lab(arguments: &[&str]) -> Result<()> {
    let mut steps = Steps::default();
    let mut lab = command("cargo run --release --package meshmark-lab --");
    for argument in arguments {
        lab.arg(argument);
        if *argument == "--real" {
            lab.arg("target/real");
        }
    }
    let mut after = vec![];
    if arguments.contains(&"--real") {
        let mut set_up = command("sh lab/real/set-up.sh target/real");
        set_up.args(
            arguments
                .iter()
                .filter(|argument| **argument == "--blender"),
        );
        steps.add("other people's programs", &[], move |log| {
            log.run(
                &mut set_up,
                "see what is missing above: the Containerfile has all of it",
            )
        });
        after.push("other people's programs");
    }
    steps.add("lab", &after, move |log| {
        log.run(&mut lab, "see the error above")
    });
    steps.run()
}
