//! `meshmark note`.

use crate::clock::Clock;
use crate::failure::Failure;
use crate::file::open;
use crate::output::Output;
use crate::owner::Owner;
use crate::report::Report;
use clap::Subcommand;
use meshmark::{embed_note, read_note};
use std::path::PathBuf;

#[derive(Subcommand)]
pub enum Note {
    /// Write a text and read it back
    Embed {
        /// The model: .glb, .vrm, .b3dm, or .gltf with its buffers beside it; or one of them as .gz
        input: PathBuf,
        /// 1 to 29 bytes of UTF-8; fewer in models of less than 8192 vertices
        #[arg(long)]
        text: String,
        /// Where the model with the note goes: a file, or a folder. What a .gltf names goes beside it
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
        #[command(flatten)]
        owner: Owner,
    },
    /// Read the note of a key
    Read {
        /// .glb or .gltf
        input: PathBuf,
        #[command(flatten)]
        owner: Owner,
    },
}

impl Note {
    pub fn run(self) -> Result<Report, Failure> {
        let mut clock = Clock::new();
        match self {
            Note::Embed {
                input,
                text,
                output,
                owner,
            } => {
                let key = owner.key()?;
                let host = open(&input)?;
                let mut noted = embed_note(host.model(&mut clock), &text, &key)?;
                let stored = Output::to(output).store(&input, &host, &noted.model, &noted.files)?;
                noted.report.host_sha256 = host.sha256;
                noted.report.marked_sha256.clone_from(&stored.sha256);
                Report::stored(&noted.report, &stored, clock)
            }
            Note::Read { input, owner } => {
                let key = owner.key()?;
                let reading = read_note(open(&input)?.model(&mut clock), &key)?;
                Report::judged(&reading, reading.verdict, clock)
            }
        }
    }
}
