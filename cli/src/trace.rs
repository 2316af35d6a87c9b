//! `meshmark trace`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::ledger;
use crate::owner::Owner;
use crate::report::Report;
use crate::statement::StatementArgument;
use crate::suspect::Suspect;
use clap::Args;
use meshmark::{Finding, Traced, Verdict};
use serde_json::{Value, json};
use std::collections::BTreeMap;
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
        let tracing = self.suspect.trace(&key, &numbers, &mut clock)?;
        let names: BTreeMap<u64, String> = buyers
            .into_iter()
            .map(|buyer| (buyer.number, buyer.name))
            .collect();
        let named: Vec<(u64, String)> = tracing
            .buyers
            .iter()
            .map(|buyer| {
                (
                    buyer.number,
                    names.get(&buyer.number).cloned().unwrap_or_default(),
                )
            })
            .collect();
        let repeated = format!(
            "meshmark trace {} --ledger {}",
            self.suspect.arguments(),
            self.ledger.display()
        );
        self.statement.write(
            Finding::Tracing(&tracing, &named),
            &[("Suspect", self.suspect.path()), ("Ledger", &self.ledger)],
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
            for (buyer, (_, name)) in told.iter_mut().zip(named) {
                buyer["name"] = json!(name);
            }
        }
        Report::judged(&told, verdict, clock)
    }
}
