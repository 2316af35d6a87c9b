//! Running other programs, and the one kind of failure that all of xtask has.

use std::ffi::OsStr;
use std::fmt;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

pub type Result<T> = std::result::Result<T, Failure>;

/// What went wrong, and what the person in front of the terminal can do.
#[derive(Debug)]
pub struct Failure {
    what: String,
    remedy: String,
}

impl Failure {
    pub fn new(what: impl Into<String>, remedy: impl Into<String>) -> Self {
        let (what, remedy) = (what.into(), remedy.into());
        Self { what, remedy }
    }

    /// Of a file operation.
    pub fn of_file(path: &Path, error: &std::io::Error) -> Self {
        let what = format!("{}: {error}", path.display());
        Self::new(
            what,
            "see that the file and its folder exist and can be written",
        )
    }

    fn of_start(command: &Command, error: &std::io::Error) -> Self {
        let program = command.get_program().to_string_lossy();
        Self::new(
            format!("`{program}` cannot be started: {error}"),
            format!("see that {program} is installed and on PATH"),
        )
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "error: {}\nwhat to do: {}", self.what, self.remedy)
    }
}

/// Where a step's output goes: to the terminal, or to a file that keeps it together.
pub struct Log(pub Option<File>);

impl Log {
    pub fn say(&mut self, line: impl fmt::Display) {
        match &mut self.0 {
            None => println!("{line}"),
            // A full disk shows in what the step is there for.
            Some(file) => drop(writeln!(file, "{line}")),
        }
    }

    /// Runs to the end.
    pub fn run(&mut self, command: &mut Command, remedy: &str) -> Result<()> {
        let line = command_line(command);
        self.say(format_args!("$ {line}"));
        if let Some(file) = &self.0 {
            let handle = || {
                file.try_clone()
                    .map_err(|error| Failure::of_start(command, &error))
            };
            let (stdout, stderr) = (handle()?, handle()?);
            command.stdin(Stdio::null()).stdout(stdout).stderr(stderr);
        }
        let status = command.status();
        let status = status.map_err(|error| Failure::of_start(command, &error))?;
        check(status.success(), || format!("`{line}`: {status}"), remedy)
    }
}

/// Runs to the end and returns what was printed, trimmed; complaints go to the terminal.
pub fn output(command: &mut Command, remedy: &str) -> Result<String> {
    let output = command.stderr(Stdio::inherit()).output();
    let output = output.map_err(|error| Failure::of_start(command, &error))?;
    let what = || format!("`{}`: {}", command_line(command), output.status);
    check(output.status.success(), what, remedy)?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

pub fn check(is_good: bool, what: impl FnOnce() -> String, remedy: &str) -> Result<()> {
    if is_good {
        return Ok(());
    }
    Err(Failure::new(what(), remedy))
}

/// A command by its words, in the workspace's root.
pub fn command(words: &str) -> Command {
    let (program, arguments) = words.split_once(' ').unwrap_or((words, ""));
    program_with(program, arguments)
}

/// The same, of a program whose path can have spaces.
pub fn program_with(program: impl AsRef<OsStr>, arguments: &str) -> Command {
    let mut command = Command::new(program);
    command.args(arguments.split_whitespace());
    command.current_dir(path(""));
    command
}

/// A command that gives way to others where processors are few.
pub fn nice(command: &Command) -> Command {
    let mut nice = Command::new("nice");
    nice.arg(command.get_program()).args(command.get_args());
    nice.current_dir(command.get_current_dir().unwrap_or(Path::new(".")));
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => nice.env(name, value),
            None => nice.env_remove(name),
        };
    }
    nice
}

/// A path from the workspace's root.
pub fn path(relative: &str) -> PathBuf {
    let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
    xtask.parent().unwrap_or(xtask).join(relative)
}

/// Where on PATH a program is.
pub fn find(program: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders)
        .map(|folder| folder.join(program))
        .find(|file| file.is_file())
}

fn command_line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<_> = words.map(|word| word.to_string_lossy()).collect();
    words.join(" ")
}
