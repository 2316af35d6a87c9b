//! Invisible, keyed, robust watermarks in the geometry of glTF models.
//!
//! [`embed`] puts a 48-bit payload into a model under a key. [`measure`] takes from any suspect copy all that needs no
//! key; [`extract`] reads a payload from that with the key alone, and [`verify`] tests an expected one, each with a bound
//! of the probability that it would say so of a model made without the key. [`note`] does the same with a short text.
//!
//! ```
//! use meshmark::{EmbedOptions, Files, Key, Payload, Verdict, demo_model, embed, extract, ignore, measure};
//!
//! # fn main() -> Result<(), meshmark::Error> {
//! let key = Key::from_passphrase("Ada", "correct horse battery staple")?;
//! let payload = Payload::from_tag("ADA-1")?;
//! let files = Files::new();
//! let marked = embed(&demo_model(), &files, payload, &key, &EmbedOptions::default(), &mut ignore)?;
//! let evidence = measure(&marked.model, &files, &mut ignore)?;
//! let found = extract(&evidence, &key);
//! assert_eq!(found.verdict, Verdict::Found);
//! assert_eq!(found.tag.as_deref(), Some("ADA-1"));
//! # Ok(())
//! # }
//! ```
//!
//! The rooms of the house, and who may know whom, are in docs/ARCHITECTURE.md; what may never change is in docs/FORMAT.md.

pub mod attack;
mod bits;
pub mod carrier;
pub mod code;
pub mod detection;
mod digest;
pub mod document;
pub mod evidence;
pub mod geometry;
pub mod key;
pub mod mesh;
mod order;
pub mod paper;
mod progress;
mod random;
pub mod scene;
mod watermark;

#[cfg(target_arch = "wasm32")]
mod wasm;

pub use bits::{Payload, PayloadError};
pub use carrier::Carrier;
pub use document::Files;
pub use evidence::Evidence;
pub use key::Key;
pub use progress::{Cancelled, Progress, Stage, ignore};
pub use watermark::{
    CarrierCapacity, CarrierReading, Details, EmbedOptions, EmbedReport, Embedding, Error,
    Extraction, Forecast, Input, Inspection, Level, Strength, Verdict, detect, embed, extract,
    extract_many, inspect, measure, note, verify,
};

/// A generated model to try things on: a .glb of 12 000 vertices with normals and one material.
pub fn demo_model() -> Vec<u8> {
    scene::to_glb(&mesh::shapes::asteroid(100, 120))
}
