//! LOCAL: SOLID's windows in balls about salient places, each in the place's own frame. It says whose a model is, and holds no payload.
//!
//! A place and its frame depend on what lies near them alone, so a piece that was cut out and remeshed still has those of its inside, where
//! SOLID's frame is lost with the whole, and RING's rings with the triangles.
//!
//! | file | idea |
//! |---|---|
//! | `ball` | the lattice of a key about a place |
//! | `choice` | embedding: which places will come back |
//! | `problem` | embedding: the linear problem of one round |
//! | `embed` | embedding: the displacement |
//! | `measurement` | detecting: the places of a suspect |
//! | `reading` | detecting: which balls the pilots choose, and what the other symbols say |
//!
//! The method and its constants are this project's own (docs/REFERENCES.md, "LOCAL").

mod ball;
mod choice;
mod embed;
mod measurement;
mod problem;
mod reading;

#[cfg(feature = "local")]
pub use embed::embed_above;
pub use embed::{Embedded, embed, suits};
pub use measurement::Measurement;
