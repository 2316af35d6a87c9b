//! The pipelines: bytes in, bytes and a report out. Nothing here computes; every step is a call to another room.

mod embed;
mod error;
mod extract;
mod forecast;
mod inspect;
pub mod note;
mod options;
mod report;

pub use embed::{Embedding, embed};
pub use error::Error;
pub use extract::{detect, extract, extract_many, measure, verify};
pub use inspect::{CarrierCapacity, Inspection, inspect};
pub use options::{EmbedOptions, Strength};
pub use report::{
    CarrierReading, Details, EmbedReport, Extraction, Forecast, Input, Level, Verdict,
};
