//! `meshmark test`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::load_text;
use crate::owner::Owner;
use crate::report::Report;
use crate::suspect::Suspect;
use clap::Args;
use meshmark::{Extraction, Key, Verdict, extract_many};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Test a model, or measured evidence, with a list of keys, or with an owner's key for each of a list of works
#[derive(Args)]
pub struct Test {
    #[command(flatten)]
    suspect: Suspect,
    /// File with a key in each line: 64 hexadecimal digits, and a name if you like
    #[arg(
        long,
        value_name = "FILE",
        required_unless_present = "works",
        conflicts_with = "works"
    )]
    keys: Option<PathBuf>,
    /// File with the title of a work in each line; the key is that of the owner
    #[arg(long, value_name = "FILE", requires = "Owner")]
    works: Option<PathBuf>,
    #[command(flatten)]
    owner: Option<Owner>,
}

impl Test {
    /// That there are many keys is charged: a name is not found by asking often enough.
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let (names, keys) = self.keys()?;
        let (evidence, input) = self.suspect.measured(&mut clock)?;
        clock.start("test");
        let extractions = extract_many(&evidence, &keys);
        let is_found = |extraction: &Extraction| {
            matches!(extraction.verdict, Verdict::Found | Verdict::Present)
        };
        let row = |(name, extraction): (String, &Extraction)| match is_found(extraction) {
            true => json!({
                "key": name,
                "found": true,
                "tag": extraction.tag,
                "number": extraction.number,
                "lnP": extraction.details().ln_p,
            }),
            false => json!({ "key": name, "found": false }),
        };
        let rows: Vec<Value> = names.into_iter().zip(&extractions).map(row).collect();
        let readings = json!({
            "input": input,
            "numKeys": keys.len(),
            "lnCharge": libm::log(keys.len() as f64),
            "keys": rows,
        });
        let verdict = match extractions.iter().any(is_found) {
            true => Verdict::Found,
            false => Verdict::None,
        };
        Report::judged(&readings, verdict, clock)
    }

    /// Keys, and what each is called.
    fn keys(&self) -> Result<(Vec<String>, Vec<Key>), Failure> {
        let (names, keys) = match (&self.keys, &self.works, &self.owner) {
            (Some(file), ..) => read_keys(&load_text(file)?)?,
            (None, Some(file), Some(owner)) => keys_of_works(&load_text(file)?, &owner.key()?)?,
            _ => Default::default(),
        };
        match keys.is_empty() {
            true => Err(Failure::Words("there is no key in the list".to_owned())),
            false => Ok((names, keys)),
        }
    }
}

/// The keys of an owner's works, from lines with their titles. Lines that are empty say nothing.
fn keys_of_works(text: &str, owner: &Key) -> Result<(Vec<String>, Vec<Key>), Failure> {
    let titles = text
        .lines()
        .map(str::trim)
        .filter(|title| !title.is_empty());
    let titles: Vec<String> = titles.map(str::to_owned).collect();
    let keys: Result<Vec<Key>, _> = titles.iter().map(|title| owner.for_work(title)).collect();
    Ok((titles, keys.map_err(Failure::of)?))
}

/// Keys from lines of 64 hexadecimal digits, each with a name after them if it has one. Lines that are empty or begin with `#`
/// say nothing.
fn read_keys(text: &str) -> Result<(Vec<String>, Vec<Key>), Failure> {
    let (mut names, mut keys) = (Vec::new(), Vec::new());
    for (line, number) in text.lines().zip(1..) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let (digits, name) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let digit = |c: char| c.to_digit(16).map(|digit| digit as u8);
        let digits: Option<Vec<u8>> = digits.chars().map(digit).collect();
        let bytes = digits.and_then(|digits| {
            let (pairs, rest) = digits.as_chunks();
            let bytes = pairs.iter().map(|[high, low]| high << 4 | low);
            rest.is_empty().then(|| bytes.collect::<Vec<u8>>())
        });
        let key = bytes.and_then(|bytes| Key::from_bytes(&bytes).ok());
        let key = key.ok_or_else(|| {
            Failure::Words(format!(
                "line {number} of the keys is not 64 hexadecimal digits"
            ))
        })?;
        let name = if name.is_empty() {
            format!("line {number}")
        } else {
            name.trim().to_owned()
        };
        names.push(name);
        keys.push(key);
    }
    Ok((names, keys))
}
