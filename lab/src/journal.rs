//! What a run has measured, line by line, so that an interrupted one goes on where it was.

use crate::cell::Cell;
use crate::removal::Removal;
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What must be equal for a run to go on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    pub seed: u64,
    /// The arguments that say what is run.
    pub arguments: Vec<String>,
    /// SHA-256 of the program, by which another build is told from this one.
    pub program: String,
}

/// A model, marked.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Mark {
    pub model: String,
    pub strength: String,
    pub copy: u32,
    pub outcome: Result<Marked, String>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Marked {
    pub vertices: usize,
    pub rms_rel: f64,
    pub max_rel: f64,
    pub msdm: Option<f64>,
    pub ln_p: f64,
}

/// A line.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Entry {
    Header(Header),
    Mark(Mark),
    Cell(Cell),
    Removal(Removal),
}

/// Everything that is measured.
#[derive(Clone, Debug, Default)]
pub struct Results {
    pub marks: Vec<Mark>,
    pub cells: Vec<Cell>,
    pub removals: Vec<Removal>,
}

impl Results {
    fn add(&mut self, entry: Entry) {
        match entry {
            Entry::Header(_) => {}
            Entry::Mark(mark) => self.marks.push(mark),
            Entry::Cell(cell) => self.cells.push(cell),
            Entry::Removal(removal) => self.removals.push(removal),
        }
    }
}

/// A file of entries, and what is in it.
pub struct Journal(Mutex<(File, Results)>);

impl Journal {
    /// A journal that begins, in place of any other.
    pub fn begin(path: &Path, header: Header) -> Result<Journal, String> {
        let file = File::create(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let journal = Journal(Mutex::new((file, Results::default())));
        journal.record(Entry::Header(header))?;
        Ok(journal)
    }

    /// A journal that goes on, and its seed. `header` says what a run of a seed is.
    pub fn resume(path: &Path, header: impl Fn(u64) -> Header) -> Result<(Journal, u64), String> {
        let said = |error: std::io::Error| format!("there is no run to go on with: {error}");
        let text = std::fs::read_to_string(path).map_err(said)?;
        // The last line may have been cut short.
        let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
        let mut results = Results::default();
        let mut seed = None;
        for line in whole.lines() {
            let entry = serde_json::from_str(line);
            let entry = entry.map_err(|error| format!("{}: {error}", path.display()))?;
            if let Entry::Header(old) = &entry {
                if *old != header(old.seed) {
                    return Err(
                        "the run that was interrupted had other arguments, or was of another build"
                            .to_owned(),
                    );
                }
                seed = Some(old.seed);
            }
            results.add(entry);
        }
        let seed = seed.ok_or("there is no run to go on with")?;
        std::fs::write(path, whole).map_err(said)?;
        let file = OpenOptions::new().append(true).open(path).map_err(said)?;
        Ok((Journal(Mutex::new((file, results))), seed))
    }

    /// Writes a line.
    pub fn record(&self, entry: Entry) -> Result<(), String> {
        let mut line = serde_json::to_string(&entry).map_err(|error| error.to_string())?;
        line.push('\n');
        let mut journal = self.lock();
        let written = journal.0.write_all(line.as_bytes());
        journal.1.add(entry);
        written.map_err(|error| format!("the journal cannot be written: {error}"))
    }

    /// All there is so far.
    pub fn results(&self) -> Results {
        self.lock().1.clone()
    }

    fn lock(&self) -> MutexGuard<'_, (File, Results)> {
        // Who panics while writing leaves whole entries behind.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
