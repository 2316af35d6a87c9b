//! What is read, and what is told of it.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::{Found, load, open_suspect};
use crate::report::Report;
use clap::Args;
use meshmark::{
    Comparison, Evidence, Extraction, Input, Key, Payload, Tracing, detect, detect_with_local,
    extract, measure, trace, trace_evidence, verify,
};
use std::path::{Path, PathBuf};

/// What is read.
#[derive(Args)]
pub struct Suspect {
    /// glTF (.glb, .gltf, .vrm, .b3dm), .obj, .stl or .ply, or one of them as .gz
    input: PathBuf,
    /// INPUT is no model but a file that `measure` wrote: only where you trust who wrote it
    #[arg(long)]
    evidence: bool,
}

impl Suspect {
    /// Reads a model, or what was measured of one, with a key.
    pub fn examine(
        &self,
        key: &Key,
        expected: Option<Payload>,
        local: LocalArgument,
        clock: &mut Clock,
    ) -> Result<Extraction, Failure> {
        if !self.evidence {
            let opened = open_suspect(&self.input)?;
            let suspect = opened.suspect(clock);
            return Ok(match local.local {
                true => detect_with_local(suspect, key, expected)?,
                false => detect(suspect, key, expected)?,
            });
        }
        let evidence = self.stored()?;
        clock.start("test");
        Ok(match expected {
            Some(payload) => verify(&evidence, key, payload),
            None => extract(&evidence, key),
        })
    }

    /// The model, as it was found on disk.
    pub fn found(&self) -> Result<Found, Failure> {
        open_suspect(&self.input)
    }

    /// Says whose copies a model, or what was measured of one, was made of.
    pub fn trace(&self, key: &Key, numbers: &[u64], clock: &mut Clock) -> Result<Tracing, Failure> {
        if !self.evidence {
            let found = open_suspect(&self.input)?;
            return Ok(trace(found.suspect(clock), key, numbers)?);
        }
        let evidence = self.stored()?;
        clock.start("test");
        Ok(trace_evidence(&evidence, key, numbers)?)
    }

    /// What somebody has to say on the command line to read the same.
    pub fn arguments(&self) -> String {
        let evidence = if self.evidence { " --evidence" } else { "" };
        format!("{}{evidence}", self.input.display())
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.input
    }

    /// The evidence, measured here where the suspect is a model.
    pub fn measured(&self, clock: &mut Clock) -> Result<(Evidence, Input), Failure> {
        if self.evidence {
            return Ok((self.stored()?, Input::Evidence));
        }
        let evidence = measure(open_suspect(&self.input)?.suspect(clock))?;
        Ok((evidence, Input::Model))
    }

    fn stored(&self) -> Result<Evidence, Failure> {
        Evidence::from_bytes(&load(&self.input)?).map_err(Failure::of)
    }
}

/// Whether LOCAL is looked for.
#[derive(Args, Clone, Copy)]
pub struct LocalArgument {
    /// Look for what LOCAL marked too, which a piece still holds that was cut out, and then simplified or remeshed. It takes seconds
    #[arg(long, conflicts_with_all = ["evidence", "original", "record"])]
    local: bool,
}

impl LocalArgument {
    /// What somebody has to say on the command line to read the same.
    pub fn argument(self) -> &'static str {
        if self.local { " --local" } else { "" }
    }
}

/// What is told where nothing is found.
#[derive(Args)]
pub struct Telling {
    /// Say how far each carrier agrees, whatever the verdict is. For the key's owner: dithers can be read off it
    #[arg(long)]
    details: bool,
}

impl Telling {
    pub fn of(&self, extraction: Extraction, clock: Clock) -> Result<Report, Failure> {
        let verdict = extraction.verdict;
        let told = match self.details {
            true => extraction.with_details(),
            false => extraction,
        };
        Report::judged(&told, verdict, clock)
    }

    /// The same of a reading with the original.
    pub fn of_comparison(&self, comparison: Comparison, clock: Clock) -> Result<Report, Failure> {
        let verdict = comparison.verdict;
        let told = match self.details {
            true => comparison.with_details(),
            false => comparison,
        };
        Report::judged(&told, verdict, clock)
    }
}
