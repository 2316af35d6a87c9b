//! What a suspect is read with beside the key: the original, or the record of marking it.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::{load_text, open};
use crate::suspect::Suspect;
use clap::Args;
use meshmark::{
    Comparison, Key, Overlay, Payload, compare_overlaid, compare_overlaid_with_record,
    verify_with_original, verify_with_record,
};
use std::path::{Path, PathBuf};

/// The one or the other, or neither.
#[derive(Args)]
pub struct Informed {
    /// The model as it was before it was marked: with it a copy is found that has lost what INPUT alone is read by. It has to be older than
    /// the key's use on it, or the answer proves nothing to others
    #[arg(long, value_name = "FILE", conflicts_with_all = ["evidence", "local"])]
    original: Option<PathBuf>,
    /// What `embed --record` wrote, in the stead of the original
    #[arg(long, value_name = "FILE", conflicts_with_all = ["evidence", "local", "original"])]
    record: Option<PathBuf>,
}

/// A comparison, and what it was made with.
pub struct Compared<'a> {
    pub comparison: Comparison,
    pub overlay: Option<Overlay>,
    /// What the file is to a reader.
    pub role: &'static str,
    pub path: &'a Path,
    /// What somebody has to say on the command line for the same.
    pub argument: String,
}

impl Informed {
    /// Tests a suspect for an expected payload with what there is; `None` where there is nothing.
    pub fn verify(
        &self,
        suspect: &Suspect,
        key: &Key,
        expected: Payload,
        clock: &mut Clock,
    ) -> Result<Option<Comparison>, Failure> {
        if let Some(path) = &self.original {
            let original = open(path)?;
            let found = suspect.found()?;
            let suspect = found.suspect(clock);
            return Ok(Some(verify_with_original(
                suspect,
                original.unwatched(),
                key,
                expected,
            )?));
        }
        let Some(path) = &self.record else {
            return Ok(None);
        };
        let record = load_text(path)?;
        let found = suspect.found()?;
        let suspect = found.suspect(clock);
        Ok(Some(verify_with_record(suspect, &record, key, expected)?))
    }

    /// Reads a suspect with what there is; `None` where there is nothing.
    pub fn compare(
        &self,
        suspect: &Suspect,
        key: &Key,
        clock: &mut Clock,
    ) -> Result<Option<Compared<'_>>, Failure> {
        if let Some(path) = &self.original {
            let original = open(path)?;
            let found = suspect.found()?;
            let (comparison, overlay) =
                compare_overlaid(found.suspect(clock), original.unwatched(), key)?;
            return Ok(Some(Compared {
                comparison,
                overlay,
                role: "Original",
                path,
                argument: format!("--original {}", path.display()),
            }));
        }
        let Some(path) = &self.record else {
            return Ok(None);
        };
        let record = load_text(path)?;
        let found = suspect.found()?;
        let (comparison, overlay) =
            compare_overlaid_with_record(found.suspect(clock), &record, key)?;
        Ok(Some(Compared {
            comparison,
            overlay,
            role: "Record",
            path,
            argument: format!("--record {}", path.display()),
        }))
    }
}
