//! `meshmark attacks`.

use crate::failure::Failure;
use crate::report::Report;
use clap::Args;
use meshmark::internals::attack::entries;

/// List every attack and its levels
#[derive(Args)]
pub struct Attacks {}

impl Attacks {
    pub fn run(self) -> Result<Report, Failure> {
        Ok(Report::list(serde_json::to_value(entries())?))
    }
}
