//! Invisible, keyed, robust watermarks in the geometry of glTF models.
//!
//! [`embed`] puts a 48-bit payload into a model under a key. [`detect`] reads one suspect with one key. [`measure`] takes from a
//! suspect all that needs no key; [`extract`] reads a payload from that with the key alone, and [`verify`] tests an expected one.
//! Each answer comes with a bound of the probability that it would be given of a model made without the key. [`embed_note`] and
//! [`read_note`] do the same with a short text.
//!
//! ```
//! use meshmark::{EmbedOptions, Key, Payload, Verdict, demo_model, detect, embed};
//!
//! # fn main() -> Result<(), meshmark::Error> {
//! let key = Key::from_passphrase("Ada", "correct horse battery staple")?;
//! let payload = Payload::from_tag("ADA-1")?;
//! let marked = embed(&demo_model(), payload, &key, &EmbedOptions::default())?;
//! let found = detect(&marked.model, &key, None)?;
//! assert_eq!(found.verdict, Verdict::Found);
//! assert_eq!(found.tag.as_deref(), Some("ADA-1"));
//! # Ok(())
//! # }
//! ```
//!
//! With the original at hand, [`compare`] finds what the key alone does not, and says whether the suspect has the original's shape.
//!
//! A suspect may be a [`Surface`] too: positions and triangles, from whatever format.
//!
//! A model is the bytes of a `.glb` or a `.gltf`. Where there is more to say of it, a [`Model`] takes the files that it names, and
//! hears how far the work is. The folder `examples` has programs that mark, check, test many keys and read a `.gltf` with buffers.
//!
//! The same bytes, key and options give the same marked bytes on every machine.
#![cfg_attr(not(feature = "unstable-internals"), allow(dead_code, unused_imports))] // most rooms offer more than the pipelines use

mod attack;
mod bits;
mod carrier;
mod code;
mod detection;
mod digest;
mod document;
mod evidence;
mod geometry;
mod key;
mod mesh;
mod order;
mod paper;
mod picture;
mod progress;
mod random;
mod scene;
mod watermark;

#[cfg(feature = "unstable-internals")]
pub mod internals;

#[cfg(all(target_arch = "wasm32", feature = "wasm"))]
mod wasm;

pub use bits::{Payload, PayloadError};
pub use carrier::{Carrier, CarrierError};
pub use code::{Block, TextError};
pub use document::{DocumentError, Files};
pub use evidence::{Evidence, EvidenceError};
pub use key::{Key, KeyError};
pub use progress::{Cancelled, Progress, Stage};
pub use scene::SceneError;
#[cfg(feature = "local")]
pub use watermark::detect_with_local;
pub use watermark::{
    Advice, Buyer, Capacity, CarrierReading, Comparison, Details, EmbedOptions, EmbedReport,
    Embedding, Error, Extraction, Finding, Forecast, FoundIn, Holds, Illustration, Input,
    Inspection, Ledger, Level, Model, NoteEmbedding, NoteReading, NoteReport, NoteSize, Overlay,
    Plan, PlanError, RecordError, RecordOptions, Shape, Sheet, StampReport, Stamped, StatedFile,
    Statement, Strength, Surface, Suspect, Traced, Tracing, Unshown, Verdict, Witness, capacity,
    compare, compare_overlaid, compare_overlaid_with_record, compare_with_record, decompress,
    detect, embed, embed_note, extract, extract_many, file_names, inspect, measure, note_capacity,
    prepare, read_note, record, trace, trace_evidence, trace_overlaid, trace_overlaid_with_record,
    verify, verify_with_original, verify_with_record,
};

/// A generated model to try things on: a .glb of 12 000 vertices with normals and one material.
pub fn demo_model() -> Vec<u8> {
    scene::to_glb(&mesh::shapes::asteroid(100, 120))
}
