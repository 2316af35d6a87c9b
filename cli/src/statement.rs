//! `--report`: what was found, as one HTML file that a person prints or sends.

use crate::failure::Failure;
use crate::file::{load, store};
use crate::owner::Owner;
use clap::Args;
use meshmark::internals::digest::sha256;
use meshmark::{Finding, Key, StatedFile, Statement};
use std::path::{Path, PathBuf};

/// Whether and where a statement is written.
#[derive(Args)]
pub struct StatementArgument {
    /// Write what was found as an HTML file too, for a person: what it means, what it does not prove, and how to repeat it
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// What the report says as its date, in your words
    #[arg(long, requires = "report")]
    date: Option<String>,
}

impl StatementArgument {
    /// Whether one is asked for.
    pub fn is_wanted(&self) -> bool {
        self.report.is_some()
    }

    /// Writes the statement, where one is asked for. `looked_at` are files by what they are to the reader, the suspect first; `repeated` is the
    /// command that repeats it, without the owner.
    pub fn write(
        &self,
        finding: Finding,
        looked_at: &[(&str, &Path)],
        key: &Key,
        owner: &Owner,
        repeated: &str,
    ) -> Result<(), Failure> {
        let Some(path) = &self.report else {
            return Ok(());
        };
        let mut files = Vec::new();
        for (role, path) in looked_at {
            let bytes = load(path)?;
            let name = path.file_name().unwrap_or_default();
            files.push(StatedFile {
                role: (*role).to_owned(),
                name: name.to_string_lossy().into_owned(),
                bytes: bytes.len() as u64,
                sha256: sha256(&bytes),
            });
        }
        let commitment = key.commitment();
        let statement = Statement {
            finding,
            owner: owner.name(),
            commitment: &commitment,
            files: &files,
            date: self.date.as_deref(),
            commands: &[format!("{repeated} {}", owner.arguments())],
        };
        store(path, statement.html().as_bytes())
    }
}
