//! `meshmark extract`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::informed::InformedArguments;
use crate::owner::Owner;
use crate::report::Report;
use crate::statement::StatementArgument;
use crate::suspect::{LocalArgument, Suspect, Telling};
use clap::Args;
use meshmark::{Finding, Illustration};

/// Read the mark of a key from a model, or from measured evidence
#[derive(Args)]
pub struct Extract {
    #[command(flatten)]
    suspect: Suspect,
    #[command(flatten)]
    informed: InformedArguments,
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
        let repeated = format!(
            "meshmark extract {}{}",
            self.suspect.arguments(),
            self.local.argument()
        );
        let suspect = ("Suspect", self.suspect.path());
        if let Some(compared) = self.informed.compare(&self.suspect, &key, &mut clock)? {
            let picture = compared.overlay.as_ref();
            let picture = picture.filter(|_| self.statement.is_wanted());
            let picture = picture.map(Illustration::of);
            let finding = Finding::Comparison(&compared.answer, picture.as_ref());
            let looked_at = [suspect, (compared.role, compared.path)];
            let repeated = format!("{repeated} {}", compared.argument);
            self.statement
                .write(finding, &looked_at, &key, &self.owner, &repeated)?;
            return self.telling.of_comparison(compared.answer, clock);
        }
        let extraction = self.suspect.examine(&key, None, self.local, &mut clock)?;
        let finding = Finding::Reading(&extraction);
        self.statement
            .write(finding, &[suspect], &key, &self.owner, &repeated)?;
        self.telling.of(extraction, clock)
    }
}
