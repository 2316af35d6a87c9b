//! Ledgers: which number was whose, as CSV or JSON.

use crate::failure::Failure;
use crate::file::load_text;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::Path;

/// A line of a ledger. A list of buyers that have no copies yet is one too, with fewer columns.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Entry {
    /// The number of the copy; where a list has none, lines are counted.
    #[serde(default)]
    pub number: Option<u64>,
    /// Whose it is.
    #[serde(default)]
    pub name: String,
    /// The file of the copy.
    #[serde(default)]
    pub file: String,
    /// Of that file.
    #[serde(default)]
    pub sha256: String,
    /// When it was made, as the caller put it.
    #[serde(default)]
    pub date: String,
    /// How many triangles the model has that it is a copy of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub triangles: Option<u64>,
}

/// A buyer of a list.
pub struct Buyer {
    pub number: u64,
    pub name: String,
    pub triangles: Option<u64>,
}

/// The buyers of a ledger: `.json` is a list of objects, everything else CSV with a line of headings, `number` or `name` among them.
/// Where no line has a number they are counted from `first` on.
pub fn read(path: &Path, first: u64) -> Result<Vec<Buyer>, Failure> {
    let text = load_text(path)?;
    let damaged = |words: String| Failure::Damaged {
        path: path.to_owned(),
        words,
    };
    let is_json = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    let entries: Vec<Entry> = match is_json {
        true => serde_json::from_str(&text).map_err(|error| damaged(error.to_string()))?,
        false => {
            let text = text.trim_start_matches('\u{feff}'); // spreadsheets write one
            let mut lines = csv::ReaderBuilder::new()
                .trim(csv::Trim::All)
                .from_reader(text.as_bytes());
            let headings = lines
                .headers()
                .map_err(|error| damaged(error.to_string()))?;
            if !headings
                .iter()
                .any(|heading| ["number", "name"].contains(&heading))
            {
                return Err(damaged(
                    "its first line has to name its columns, number or name among them".to_owned(),
                ));
            }
            let lines: Result<_, csv::Error> = lines.deserialize().collect();
            lines.map_err(|error| damaged(error.to_string()))?
        }
    };
    let is_numbered = entries.iter().any(|entry| entry.number.is_some());
    let mut seen = BTreeSet::new();
    let mut buyers = Vec::with_capacity(entries.len());
    for (place, entry) in entries.into_iter().enumerate() {
        let number = match (entry.number, is_numbered) {
            (Some(number), _) => number,
            (None, true) => {
                return Err(damaged(format!(
                    "{:?} has no number, others have",
                    entry.name
                )));
            }
            (None, false) => first.saturating_add(place as u64),
        };
        if !seen.insert(number) {
            return Err(damaged(format!("the number {number} is there twice")));
        }
        buyers.push(Buyer {
            number,
            name: entry.name,
            triangles: entry.triangles,
        });
    }
    if buyers.is_empty() {
        return Err(damaged("nobody is in it".to_owned()));
    }
    Ok(buyers)
}

/// A ledger as CSV.
pub fn to_csv(entries: &[Entry]) -> Result<Vec<u8>, Failure> {
    let failed = |error: String| Failure::Words(format!("the ledger: {error}"));
    let mut lines = csv::Writer::from_writer(Vec::new());
    for entry in entries {
        lines
            .serialize(entry)
            .map_err(|error| failed(error.to_string()))?;
    }
    lines
        .into_inner()
        .map_err(|error| failed(error.to_string()))
}
