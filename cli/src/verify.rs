//! `meshmark verify`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::informed::InformedArguments;
use crate::owner::Owner;
use crate::payload::PayloadArgument;
use crate::report::Report;
use crate::suspect::{LocalArgument, Suspect, Telling};
use clap::Args;

/// Test a model, or measured evidence, for an expected payload
#[derive(Args)]
pub struct Verify {
    #[command(flatten)]
    suspect: Suspect,
    #[command(flatten)]
    informed: InformedArguments,
    #[command(flatten)]
    local: LocalArgument,
    #[command(flatten)]
    owner: Owner,
    #[command(flatten)]
    payload: PayloadArgument,
    #[command(flatten)]
    telling: Telling,
}

impl Verify {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let (payload, key) = (self.payload.read()?, self.owner.key()?);
        let informed = self
            .informed
            .verify(&self.suspect, &key, payload, &mut clock)?;
        if let Some(comparison) = informed {
            return self.telling.of_comparison(comparison, clock);
        }
        let extraction = self
            .suspect
            .examine(&key, Some(payload), self.local, &mut clock)?;
        self.telling.of(extraction, clock)
    }
}
