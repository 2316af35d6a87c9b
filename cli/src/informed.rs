//! What a suspect is read with beside the key: the original, or the record of marking it.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::{load_text, open};
use crate::suspect::Suspect;
use clap::Args;
use meshmark::{
    Comparison, Error, Key, Model, Overlay, Payload, Suspect as Shown, Tracing, compare_overlaid,
    compare_overlaid_with_record, trace_overlaid, trace_overlaid_with_record, verify_with_original,
    verify_with_record,
};
use std::path::{Path, PathBuf};

/// The one or the other, or neither.
#[derive(Args)]
pub struct InformedArguments {
    /// The model as it was before it was marked: with it a copy is found that has lost what INPUT alone is read by. It has to be older than
    /// the key's use on it, or the answer proves nothing to others
    #[arg(long, value_name = "FILE", conflicts_with = "evidence")]
    original: Option<PathBuf>,
    /// What `embed --record` wrote, in the stead of the original
    #[arg(long, value_name = "FILE", conflicts_with_all = ["evidence", "original"])]
    record: Option<PathBuf>,
}

/// What was read, and what with.
pub struct Informed<'a, T> {
    pub answer: T,
    pub overlay: Option<Overlay>,
    /// What the file is to a reader.
    pub role: &'static str,
    pub path: &'a Path,
    /// What somebody has to say on the command line for the same.
    pub argument: String,
}

impl InformedArguments {
    /// Tests a suspect for an expected payload with what there is; `None` where there is nothing.
    pub fn verify(
        &self,
        suspect: &Suspect,
        key: &Key,
        expected: Payload,
        clock: &mut Clock,
    ) -> Result<Option<Comparison>, Failure> {
        let verified = self.read(
            suspect,
            clock,
            |suspect, original| {
                Ok((
                    verify_with_original(suspect, original, key, expected)?,
                    None,
                ))
            },
            |suspect, record| Ok((verify_with_record(suspect, record, key, expected)?, None)),
        )?;
        Ok(verified.map(|verified| verified.answer))
    }

    /// Reads a suspect with what there is; `None` where there is nothing.
    pub fn compare(
        &self,
        suspect: &Suspect,
        key: &Key,
        clock: &mut Clock,
    ) -> Result<Option<Informed<'_, Comparison>>, Failure> {
        self.read(
            suspect,
            clock,
            |suspect, original| compare_overlaid(suspect, original, key, None),
            |suspect, record| compare_overlaid_with_record(suspect, record, key, None),
        )
    }

    /// Says whose copies a suspect was made of, with what there is; `None` where there is nothing.
    pub fn trace(
        &self,
        suspect: &Suspect,
        key: &Key,
        numbers: &[u64],
        clock: &mut Clock,
    ) -> Result<Option<Informed<'_, Tracing>>, Failure> {
        self.read(
            suspect,
            clock,
            |suspect, original| trace_overlaid(suspect, original, key, numbers),
            |suspect, record| trace_overlaid_with_record(suspect, record, key, numbers),
        )
    }

    fn read<T>(
        &self,
        suspect: &Suspect,
        clock: &mut Clock,
        with_original: impl FnOnce(Shown, Model) -> Result<(T, Option<Overlay>), Error>,
        with_record: impl FnOnce(Shown, &str) -> Result<(T, Option<Overlay>), Error>,
    ) -> Result<Option<Informed<'_, T>>, Failure> {
        let (option, path) = match (&self.original, &self.record) {
            (Some(path), _) => ("original", path),
            (None, Some(path)) => ("record", path),
            (None, None) => return Ok(None),
        };
        let found = suspect.found()?;
        let (role, (answer, overlay)) = match option {
            "original" => {
                let original = open(path)?;
                let read = with_original(found.suspect(clock), original.unwatched());
                ("Original", read?)
            }
            _ => {
                let record = load_text(path)?;
                ("Record", with_record(found.suspect(clock), &record)?)
            }
        };
        Ok(Some(Informed {
            answer,
            overlay,
            role,
            path,
            argument: format!("--{option} {}", path.display()),
        }))
    }
}
