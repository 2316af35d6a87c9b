//! `meshmark extract`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::owner::Owner;
use crate::report::Report;
use crate::statement::StatementArgument;
use crate::suspect::{Suspect, Telling};
use clap::Args;
use meshmark::Finding;

/// Read the mark of a key from a model, or from measured evidence
#[derive(Args)]
pub struct Extract {
    #[command(flatten)]
    suspect: Suspect,
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
        let extraction = self.suspect.examine(&key, None, &mut clock)?;
        let repeated = format!("meshmark extract {}", self.suspect.arguments());
        let finding = Finding::Reading(&extraction);
        self.statement
            .write(finding, self.suspect.path(), &key, &self.owner, &repeated)?;
        self.telling.of(extraction, clock)
    }
}
