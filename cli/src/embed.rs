//! `meshmark embed`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::{open, store};
use crate::output::Output;
use crate::owner::Owner;
use crate::payload::PayloadArgument;
use crate::report::Report;
use clap::Args;
use meshmark::{Carrier, EmbedOptions, RecordOptions, Strength, embed, record};
use std::path::PathBuf;

/// Mark a model and read the mark back
#[derive(Args)]
pub struct Embed {
    /// The model: .glb, .vrm, .b3dm, or .gltf with its buffers beside it; or one of them as .gz
    input: PathBuf,
    #[command(flatten)]
    output: Output,
    /// Write a model without compression, whatever the host has
    #[arg(long)]
    decompress: bool,
    #[command(flatten)]
    owner: Owner,
    #[command(flatten)]
    payload: PayloadArgument,
    /// subtle, balanced, strong, or a fraction of the diagonal
    #[arg(long, default_value = "balanced")]
    strength: Strength,
    /// How far a vertex may go at most, in scene units: 0.00005 is 0.05 mm, where these are metres
    #[arg(long, value_name = "UNITS")]
    max_movement: Option<f64>,
    /// Comma-separated. `local` beside `solid` is found in pieces that were cut out and simplified or remeshed: `extract --local`
    #[arg(long, value_delimiter = ',', default_value = "solid,ring", value_parser = carrier)]
    carriers: Vec<Carrier>,
    /// Write NAME.meshmark.json beside the marked model too: a record of some tens of kilobytes, with which `extract --record` finds most of
    /// what it finds with the original
    #[arg(long)]
    record: bool,
    /// A date that the record is to name, in clear
    #[arg(long, value_name = "DATE", requires = "record")]
    date: Option<String>,
}

impl Embed {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        let (payload, key) = (self.payload.read()?, self.owner.key()?);
        let mut options = EmbedOptions::default()
            .with_strength(self.strength)
            .with_carriers(self.carriers);
        options.max_movement = self.max_movement;
        let mut host = open(&self.input)?;
        if self.decompress {
            host.decompress()?;
        }
        let mut marked = embed(host.model(&mut clock), payload, &key, &options)?;
        let stored = self
            .output
            .store(&self.input, &host, &marked.model, &marked.files)?;
        marked.report.host_sha256.clone_from(&host.sha256);
        marked.report.marked_sha256.clone_from(&stored.sha256);
        if self.record {
            let options = RecordOptions::default()
                .with_owner(self.owner.name().unwrap_or_default())
                .with_date(self.date.unwrap_or_default());
            let text = record(host.unwatched(), &marked.report, &key, &options)?;
            store(&self.output.record(&self.input), text.as_bytes())?;
        }
        Ok(Report::stored(&marked.report, &stored, clock)?.with_fragile(marked.report.is_fragile))
    }
}

fn carrier(name: &str) -> Result<Carrier, String> {
    let known = || Carrier::ALL.map(Carrier::name).join(", ");
    Carrier::from_name(name).ok_or_else(|| format!("the carriers are: {}", known()))
}
