//! `meshmark extract`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::owner::Owner;
use crate::report::Report;
use crate::statement::StatementArgument;
use crate::suspect::{LocalArgument, Suspect, Telling};
use clap::Args;
use meshmark::Finding;
use std::path::PathBuf;

/// Read the mark of a key from a model, or from measured evidence
#[derive(Args)]
pub struct Extract {
    #[command(flatten)]
    suspect: Suspect,
    /// The model as it was before it was marked: with it a copy is found that has lost what INPUT alone is read by. It has to be older than
    /// the key's use on it, or the answer proves nothing to others
    #[arg(long, value_name = "FILE", conflicts_with_all = ["evidence", "local", "report"])]
    original: Option<PathBuf>,
    /// What `embed --record` wrote, in the stead of the original
    #[arg(long, value_name = "FILE", conflicts_with_all = ["evidence", "local", "original", "report"])]
    record: Option<PathBuf>,
    #[command(flatten)]
    local: LocalArgument,
    #[command(flatten)]
    owner: Owner,
    #[command(flatten)]
    telling: Telling,
    #[command(flatten)]
    statement: StatementArgument,
}

impl Extract {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let key = self.owner.key()?;
        if let Some(original) = &self.original {
            let comparison = self.suspect.compare(original, &key, &mut clock)?;
            return self.telling.of_comparison(comparison, clock);
        }
        if let Some(record) = &self.record {
            let comparison = self.suspect.compare_with_record(record, &key, &mut clock)?;
            return self.telling.of_comparison(comparison, clock);
        }
        let extraction = self.suspect.examine(&key, None, self.local, &mut clock)?;
        let repeated = format!(
            "meshmark extract {}{}",
            self.suspect.arguments(),
            self.local.argument()
        );
        let finding = Finding::Reading(&extraction);
        self.statement
            .write(finding, self.suspect.path(), &key, &self.owner, &repeated)?;
        self.telling.of(extraction, clock)
    }
}
