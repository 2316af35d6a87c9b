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
//! | `embed` | embedding: the displacement |
//! | `objects` | embedding: each object of a scene in its own frame |
//! | `store` | a surface's clusters in few bytes |
//! | `strength` | smoothings that may have happened, and what lies between those that are undone |
//! | `surface`, `surfaces` | detecting: what a suspect is, and may have been |
//! | `search` | detecting: the ways of reading that the pilots choose |
//! | `field`, `scan` | detecting: turns, where the frame does not determine its axes |
//! | `refine` | detecting: where exactly the lattice lies |
//! | `reading` | detecting: what the chosen ways say, and what they are charged |
//! | `measurement` | all surfaces of a suspect, as they are kept and read |
//!
//! The method and its constants are this project's own (docs/REFERENCES.md, "SOLID"). QIM with dither: Chen and Wornell 2001.

pub(super) mod cluster;
mod embed;
mod field;
mod frame;
pub(super) mod freedom;
mod grid;
pub(super) mod lattice;
mod lists;
mod measurement;
mod moments;
mod objects;
mod pitch;
mod problem;
pub(super) mod quantizer;
mod reading;
pub(super) mod refine;
mod scan;
mod search;
mod store;
mod strength;
mod surface;
mod surfaces;
pub(super) mod window;

pub use frame::has_axes;
pub use measurement::{Measurement, Suspect, piece};
pub use objects::embed;
pub use surface::Surface;
pub use surfaces::Surfaces;
