//! `meshmark attacks`.

use crate::failure::Failure;
use crate::report::Report;
use clap::Args;
use meshmark::internals::attack::{Attack, CATALOGUE};
use serde_json::json;

/// List every attack and its levels
#[derive(Args)]
pub struct Attacks {}

impl Attacks {
    pub fn run(self) -> Result<Report, Failure> {
        let list = |attack: &'static Attack| {
            json!({
                "name": attack.name,
                "family": attack.family,
                "steps": attack.steps().map(|step| step.to_string()).collect::<Vec<_>>(),
            })
        };
        Ok(Report::list(CATALOGUE.iter().map(list).collect()))
    }
}
