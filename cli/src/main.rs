//! The command line: what scripts and servers use. JSON on stdout; progress and errors on stderr.
//!
//! Exit codes: 0 done, or the mark was found; 1 the mark was not found; 2 the model cannot be checked, or bad input; 3 done, but the
//! mark is fragile.

mod attack;
mod attacks;
mod capacity;
mod clock;
mod copies;
mod embed;
mod exit;
mod extract;
mod failure;
mod file;
mod format;
mod informed;
mod inspect;
mod ledger;
mod measure;
mod note;
mod output;
mod owner;
mod payload;
mod report;
mod statement;
mod study;
mod surface;
mod suspect;
mod test;
mod trace;
mod verify;

use clap::{Parser, Subcommand};
use failure::Failure;
use report::Report;
use std::process::ExitCode;

/// Invisible, keyed, robust watermarks in the geometry of glTF models
#[derive(Parser)]
#[command(
    version,
    after_help = "Exit codes: 0 done or found, 1 not found, 2 cannot check or bad input, 3 done but the mark is fragile."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Embed(embed::Embed),
    Extract(extract::Extract),
    Verify(verify::Verify),
    Measure(measure::Measure),
    Test(test::Test),
    Copies(copies::Copies),
    Trace(trace::Trace),
    /// Write a text into a model, or read it: up to 29 characters. A mark goes on top, so after the note
    #[command(subcommand)]
    Note(note::Note),
    Attack(attack::Attack),
    Attacks(attacks::Attacks),
    Inspect(inspect::Inspect),
    Capacity(capacity::Capacity),
    Study(study::Study),
}

impl Command {
    fn run(self) -> Result<Report, Failure> {
        match self {
            Command::Embed(command) => command.run(),
            Command::Extract(command) => command.run(),
            Command::Verify(command) => command.run(),
            Command::Measure(command) => command.run(),
            Command::Test(command) => command.run(),
            Command::Copies(command) => command.run(),
            Command::Trace(command) => command.run(),
            Command::Note(command) => command.run(),
            Command::Attack(command) => command.run(),
            Command::Attacks(command) => command.run(),
            Command::Inspect(command) => command.run(),
            Command::Capacity(command) => command.run(),
            Command::Study(command) => command.run(),
        }
    }
}

fn main() -> ExitCode {
    match Arguments::parse().command.run() {
        Ok(report) => report.tell(),
        Err(failure) => failure.tell(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use std::collections::BTreeSet;

    /// Every command that the documents show is one that there is, and COMMANDS.md shows every one.
    #[test]
    fn documented_commands_are_understood() {
        let readme = include_str!("../../README.md");
        let commands = include_str!("../../docs/COMMANDS.md");
        let lines = [readme, commands]
            .map(|text| text.lines().filter(|line| line.starts_with("meshmark ")));
        let mut shown = BTreeSet::new();
        for line in lines.into_iter().flatten() {
            let words = shlex::split(line).expect("quotes that are closed");
            if let Err(error) = Arguments::try_parse_from(&words) {
                panic!("{line}\n{error}");
            }
            shown.insert(words[1].clone());
        }
        let names = Arguments::command();
        let names = names
            .get_subcommands()
            .map(|command| command.get_name().to_owned());
        assert_eq!(shown, names.filter(|name| name != "help").collect());
    }
}
