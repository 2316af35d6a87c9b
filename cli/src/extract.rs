//! `meshmark extract`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::owner::Owner;
use crate::report::Report;
use crate::suspect::{Suspect, Telling};
use clap::Args;

/// Read the mark of a key from a model, or from measured evidence
#[derive(Args)]
pub struct Extract {
    #[command(flatten)]
    suspect: Suspect,
    #[command(flatten)]
    owner: Owner,
    #[command(flatten)]
    telling: Telling,
}

impl Extract {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let key = self.owner.key()?;
        let extraction = self.suspect.examine(&key, None, &mut clock)?;
        self.telling.of(extraction, clock)
    }
}
