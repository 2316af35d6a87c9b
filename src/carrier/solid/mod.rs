//! SOLID: quantization index modulation of a band-passed occupancy field, sampled on a lattice that the key owns.
//!
//! The statistic is an integral over the surface, so it stays when the tessellation goes: under noise, smoothing, quantization,
//! simplification, subdivision and remeshing. The lattice lies in a canonical frame of the surface, turned and shifted by the key: two
//! owners who mark one model do not meet at the same points. Cropping moves the frame and is RING's to survive.
//!
//! | file | idea |
//! |---|---|
//! | `frame` | what a surface's own frame leaves open |
//! | `pitch` | how far apart lattice points are, by the area of the surface |
//! | `lattice` | where a key's lattice lies, and what its points hold |
//! | `grid` | a box of lattice points with values, to gather sums in |
//! | `cluster` | the surface in small pieces |
//! | `window` | the flux of the surface about a lattice point |
//! | `quantizer` | how a flux holds a symbol |
//! | `freedom` | embedding: how far each vertex may move unseen |
//! | `lists`, `moments`, `problem` | embedding: the linear problem of one round |
//! | `rounds` | embedding: the displacement |
//! | `embed` | embedding: which pitch, step and limit hold the mark |
//! | `objects` | embedding: each object of a scene in its own frame |
//! | `again` | embedding: another message where one was embedded before |
//! | `held` | embedding: windows that another carrier leaves as they are |
//! | `store` | a surface's clusters in few bytes |
//! | `strength` | smoothings that may have happened, and what lies between those that are undone |
//! | `surface`, `surfaces` | detecting: what a suspect is, and may have been |
//! | `search` | detecting: the ways of reading that the pilots choose |
//! | `stretch` | detecting: a scale along one axis |
//! | `field`, `scan` | detecting: turns, where the frame does not determine its axes |
//! | `refine` | detecting: where exactly the lattice lies |
//! | `informed` | detecting with the original: what a suspect shows of what the embedder must have done |
//! | `recorded` | the same with what a record keeps of the original |
//! | `reading` | detecting: what the chosen ways say, and what they are charged |
//! | `measurement` | all surfaces of a suspect, as they are kept and read |
//!
//! The method and its constants are this project's own (docs/REFERENCES.md, "SOLID"). QIM with dither: Chen and Wornell 2001.

mod again;
pub(super) mod cluster;
mod embed;
mod field;
mod frame;
pub(super) mod freedom;
mod grid;
pub(super) mod held;
mod informed;
pub(super) mod lattice;
mod lists;
mod measurement;
mod moments;
mod objects;
mod pitch;
mod problem;
pub(super) mod quantizer;
mod reading;
mod recorded;
pub(super) mod refine;
mod rounds;
mod scan;
mod search;
mod store;
mod strength;
mod stretch;
mod surface;
mod surfaces;
pub(super) mod window;

pub use again::Prepared;
pub use frame::has_axes;
pub use informed::{Frames, Seen};
pub use measurement::{Measurement, Suspect, piece};
pub use objects::{Chosen, embed};
pub use recorded::Recorded;
pub use rounds::Choice;
pub use surface::Surface;
pub use surfaces::Surfaces;
