//! Running other programs.

use std::fmt::Display;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use fs_err::File;

/// Where a step's output goes: to the terminal, or to a file that keeps it together.
pub struct Log(pub Option<File>);

impl Log {
    pub fn say(&mut self, line: impl Display) {
        match &mut self.0 {
            None => println!("{line}"),
            // A full disk shows in what the step is there for.
            Some(file) => drop(writeln!(file, "{line}")),
        }
    }

    /// Runs a command to its end. `remedy`: what to do where it fails.
    pub fn run(&mut self, command: &mut Command, remedy: &str) -> Result<()> {
        self.say(format_args!("$ {}", line(command)));
        if let Some(file) = &self.0 {
            let (stdout, stderr) = (file.file().try_clone()?, file.file().try_clone()?);
            command.stdin(Stdio::null()).stdout(stdout).stderr(stderr);
        }
        let status = command.status().with_context(|| start_failed(command))?;
        let is_good = status.success();
        ensure!(is_good, "{}: {status}\n{TO_DO}{remedy}", line(command));
        Ok(())
    }
}

/// Begins the line of an error that says what to do.
pub const TO_DO: &str = "what to do: ";

/// Runs to the end and returns what was printed, trimmed; complaints go to the terminal.
pub fn output(command: &mut Command) -> Result<String> {
    let output = command.stderr(Stdio::inherit()).output();
    let output = output.with_context(|| start_failed(command))?;
    let status = output.status;
    ensure!(status.success(), "{}: {status}", line(command));
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// A command by its words, in the workspace's root.
pub fn command(words: &str) -> Command {
    let (program, arguments) = words.split_once(' ').unwrap_or((words, ""));
    let mut command = Command::new(program);
    command
        .args(arguments.split_whitespace())
        .current_dir(path(""));
    command
}

/// A path from the workspace's root.
pub fn path(relative: &str) -> PathBuf {
    let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
    xtask.parent().unwrap_or(xtask).join(relative)
}

/// Where on PATH a program is.
pub fn find(program: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let mut files = std::env::split_paths(&folders).map(|folder| folder.join(program));
    files.find(|file| file.is_file())
}

fn line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<_> = words.map(|word| word.to_string_lossy()).collect();
    words.join(" ")
}

fn start_failed(command: &Command) -> String {
    let program = command.get_program().to_string_lossy();
    format!("{program} cannot be started\n{TO_DO}see that {program} is installed and on PATH")
}
