//! What a command prints, and how it exits.

use crate::clock::Clock;
use crate::exit::{self, CANNOT_CHECK, FOUND, FRAGILE, NOT_FOUND};
use crate::failure::Failure;
use crate::output::Stored;
use meshmark::Verdict;
use serde::Serialize;
use serde_json::Value;
use std::process::ExitCode;

/// A report and an exit code.
pub struct Report {
    json: Value,
    code: u8,
}

impl Report {
    /// What was done, with the milliseconds of each stage.
    pub fn done(report: &impl Serialize, clock: Clock) -> Result<Report, Failure> {
        let mut json = serde_json::to_value(report)?;
        if let Value::Object(fields) = &mut json {
            fields.insert("ms".to_owned(), clock.milliseconds());
        }
        Ok(Report { json, code: FOUND })
    }

    /// The same, of a mark that is fragile or is not.
    pub fn with_fragile(self, is_fragile: bool) -> Report {
        let code = if is_fragile { FRAGILE } else { self.code };
        Report { code, ..self }
    }

    /// What was done to a model, and which files it became.
    pub fn stored(
        report: &impl Serialize,
        stored: &Stored,
        clock: Clock,
    ) -> Result<Report, Failure> {
        let mut done = Report::done(report, clock)?;
        if let Value::Object(fields) = &mut done.json {
            fields.insert("stored".to_owned(), serde_json::to_value(stored)?);
        }
        Ok(done)
    }

    /// What was read, with an exit code that says whether anything was found.
    pub fn judged(
        report: &impl Serialize,
        verdict: Verdict,
        clock: Clock,
    ) -> Result<Report, Failure> {
        let code = match verdict {
            Verdict::Found | Verdict::Present => FOUND,
            Verdict::CannotCheck => CANNOT_CHECK,
            _ => NOT_FOUND,
        };
        Ok(Report {
            code,
            ..Report::done(report, clock)?
        })
    }

    /// What took no time.
    pub fn list(json: Value) -> Report {
        Report { json, code: FOUND }
    }

    pub fn tell(&self) -> ExitCode {
        exit::with(&self.json, self.code)
    }
}
