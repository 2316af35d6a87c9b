//! `meshmark trace`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::informed::InformedArguments;
use crate::ledger::{self, Buyer};
use crate::owner::Owner;
use crate::report::Report;
use crate::statement::StatementArgument;
use crate::suspect::Suspect;
use clap::Args;
use meshmark::{Finding, Illustration, Ledger, Traced, Tracing, Verdict};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Say whose copies a model was made of, if several mixed theirs too
#[derive(Args)]
pub struct Trace {
    #[command(flatten)]
    suspect: Suspect,
    /// The ledger: CSV with a column number, as `copies` writes it, or JSON. Every buyer in it is charged
    #[arg(long, value_name = "FILE")]
    ledger: PathBuf,
    #[command(flatten)]
    informed: InformedArguments,
    #[command(flatten)]
    owner: Owner,
    #[command(flatten)]
    statement: StatementArgument,
}

impl Trace {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let buyers = ledger::read(&self.ledger, 1)?;
        let key = self.owner.key()?;
        let numbers: Vec<u64> = buyers.iter().map(|buyer| buyer.number).collect();
        let mut looked_at = vec![("Suspect", self.suspect.path()), ("Ledger", &*self.ledger)];
        let mut repeated = format!(
            "meshmark trace {} --ledger {}",
            self.suspect.arguments(),
            self.ledger.display()
        );
        let informed = self
            .informed
            .trace(&self.suspect, &key, &numbers, &mut clock)?;
        let (tracing, picture) = match informed {
            Some(informed) => {
                looked_at.push((informed.role, informed.path));
                repeated = format!("{repeated} {}", informed.argument);
                let overlay = informed.overlay.as_ref();
                let overlay = overlay.filter(|_| self.statement.is_wanted());
                (informed.answer, overlay.map(Illustration::of))
            }
            None => (self.suspect.trace(&key, &numbers, &mut clock)?, None),
        };
        let says = said_of(&buyers, &tracing);
        self.statement.write(
            Finding::Tracing(&tracing, &says, picture.as_ref()),
            &looked_at,
            &key,
            &self.owner,
            &repeated,
        )?;
        let verdict = match tracing.traced {
            Traced::Named => Verdict::Found,
            Traced::CannotCheck => Verdict::CannotCheck,
            _ => Verdict::None,
        };
        let mut told = serde_json::to_value(&tracing)?;
        if let Some(Value::Array(told)) = told.get_mut("buyers") {
            for (buyer, (_, name)) in told.iter_mut().zip(says.names) {
                buyer["name"] = json!(name);
            }
        }
        Report::judged(&told, verdict, clock)
    }
}

/// What the ledger says of who is named. Of triangles it says something where all copies are of one model.
fn said_of(buyers: &[Buyer], tracing: &Tracing) -> Ledger {
    let known: BTreeMap<u64, &str> = buyers
        .iter()
        .map(|buyer| (buyer.number, &*buyer.name))
        .collect();
    let name = |number| known.get(&number).copied().unwrap_or_default().to_owned();
    let named = tracing.buyers.iter();
    let names = named.map(|buyer| (buyer.number, name(buyer.number)));
    let triangles: BTreeSet<Option<u64>> = buyers.iter().map(|buyer| buyer.triangles).collect();
    Ledger {
        names: names.collect(),
        triangles: match triangles.len() {
            1 => triangles.first().copied().flatten(),
            _ => None,
        },
    }
}
