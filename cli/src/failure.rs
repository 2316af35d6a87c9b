//! Whatever keeps a command from its report.

use crate::exit::{self, CANNOT_CHECK};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The library's reason.
    #[error(transparent)]
    Library(#[from] meshmark::Error),
    /// A file that `measure` wrote, where nobody asked for evidence.
    #[error(
        "{} is no model but evidence, a file that `measure` wrote; extract, verify and test read it with --evidence",
        .0.display()
    )]
    NotAsked(PathBuf),
    /// A file that cannot be read or written.
    #[error("{}: {error}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// A file of a kind that is not read here.
    #[error("{}: this is {kind}; {advice}", path.display())]
    OtherFormat {
        /// Which.
        path: PathBuf,
        /// What it is.
        kind: &'static str,
        /// What helps.
        advice: &'static str,
    },
    /// A file of a known kind that is not as it should be.
    #[error("{}: the file is damaged: {words}", path.display())]
    Damaged {
        /// Which.
        path: PathBuf,
        /// Why.
        words: String,
    },
    /// A report that is no JSON.
    #[error(transparent)]
    Report(#[from] serde_json::Error),
    /// Anything else, in words.
    #[error("{0}")]
    Words(String),
}

impl Failure {
    pub fn file(path: &Path, error: std::io::Error) -> Failure {
        Failure::File {
            path: path.to_owned(),
            error,
        }
    }

    /// An error of one of the library's rooms.
    pub fn of(error: impl Into<meshmark::Error>) -> Failure {
        Failure::Library(error.into())
    }

    fn code(&self) -> &'static str {
        match self {
            Failure::Library(error) => error.code(),
            Failure::NotAsked(_) => "evidence.not-asked-for",
            Failure::OtherFormat { .. } => "file.other-format",
            Failure::Damaged { .. } => "file.damaged",
            _ => "io",
        }
    }

    fn pointer(&self) -> Option<&str> {
        match self {
            Failure::Library(error) => error.pointer(),
            _ => None,
        }
    }

    /// Says what is wrong: for programs on stdout, for people on stderr.
    pub fn tell(&self) -> ExitCode {
        eprintln!("meshmark: {self}");
        let report = json!({
            "verdict": "cannot-check",
            "error": {
                "code": self.code(),
                "message": self.to_string(),
                "path": self.pointer(),
            },
        });
        exit::with(&report, CANNOT_CHECK)
    }
}
