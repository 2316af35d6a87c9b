//! What a suspect is read with beside the key: the original, or the record of marking it.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::{load_text, open};
use crate::suspect::Suspect;
use clap::Args;
use meshmark::{Comparison, Key, Overlay, compare_overlaid, compare_overlaid_with_record};
use std::path::{Path, PathBuf};

/// The one or the other, or neither.
#[derive(Args)]
pub struct Informed {
    /// The model as it was before it was marked: with it a copy is found that has lost what INPUT alone is read by. It has to be older than
    /// the key's use on it, or the answer proves nothing to others
    #[arg(long, value_name = "FILE", conflicts_with = "evidence")]
    original: Option<PathBuf>,
    /// What `embed --record` wrote, in the stead of the original
    #[arg(long, value_name = "FILE", conflicts_with_all = ["evidence", "original"])]
    record: Option<PathBuf>,
}

impl Informed {
    /// What there is: its part in the reading, its option, and the file.
    pub fn given(&self) -> Option<(&'static str, &'static str, &Path)> {
        match (&self.original, &self.record) {
            (Some(path), _) => Some(("Original", "--original", path)),
            (_, Some(path)) => Some(("Record", "--record", path)),
            _ => None,
        }
    }

    /// Reads a suspect with what there is; `None` where there is neither.
    pub fn compare(
        &self,
        suspect: &Suspect,
        key: &Key,
        clock: &mut Clock,
    ) -> Result<Option<(Comparison, Option<Overlay>)>, Failure> {
        Ok(match (&self.original, &self.record) {
            (Some(path), _) => {
                let original = open(path)?;
                let found = suspect.found()?;
                let original = original.unwatched();
                Some(compare_overlaid(found.suspect(clock), original, key)?)
            }
            (_, Some(path)) => {
                let record = load_text(path)?;
                let found = suspect.found()?;
                let suspect = found.suspect(clock);
                Some(compare_overlaid_with_record(suspect, &record, key)?)
            }
            _ => None,
        })
    }
}
