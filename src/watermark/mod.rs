//! The pipelines: bytes in, bytes and a report out. Nothing here computes; every step is a call to another room.

mod capacity;
mod changes;
mod compare;
mod copies;
mod displace;
mod embed;
mod error;
mod extract;
mod forecast;
mod hearing;
mod illustration;
mod inspect;
mod judge;
mod loudest;
mod marking;
mod model;
mod note;
mod options;
mod overlay;
mod plan;
mod read_back;
mod record;
mod report;
mod statement;
mod strangers;
mod suspect;
mod testimony;
mod trace;
mod unshown;
mod weigh;

pub use capacity::{Capacity, Holds, capacity};
pub use compare::{compare, compare_overlaid, verify_with_original};
pub use copies::{Plan, StampReport, Stamped, prepare};
pub use embed::{Embedding, embed};
pub use error::{Advice, Error, PlanError, RecordError};
#[cfg(feature = "local")]
pub use extract::detect_with_local;
pub use extract::{detect, extract, extract_many, measure, verify};
pub use hearing::Buyer;
pub use illustration::Illustration;
pub use inspect::{Inspection, inspect};
pub use model::{Model, decompress, file_names};
pub use note::{
    NoteEmbedding, NoteReading, NoteReport, NoteSize, embed_note, note_capacity, read_note,
};
pub use options::{EmbedOptions, Strength};
pub use overlay::{Overlay, Sheet};
#[cfg(all(target_arch = "wasm32", feature = "wasm-full"))]
pub(crate) use record::record_of;
pub use record::{
    RecordOptions, compare_overlaid_with_record, compare_with_record, record, verify_with_record,
};
pub use report::{
    CarrierReading, Comparison, Details, EmbedReport, Extraction, Forecast, FoundIn, Input, Level,
    Shape, Unshown, Verdict, Witness,
};
pub use statement::{Finding, Ledger, StatedFile, Statement};
pub use strangers::strangers;
pub use suspect::{Surface, Suspect};
pub use trace::{
    Beside, Traced, Tracing, trace, trace_all, trace_evidence, trace_overlaid,
    trace_overlaid_with_record,
};
