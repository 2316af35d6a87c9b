//! DIRECTION, the carrier of notes: the direction of a vertex from the centroid of the enclosed volume tells
//! which bit it holds, so a vertex that is lost, or that comes in between, costs energy and nothing else.
//!
//! The sphere of directions is cut into five cells for each bit of a codeword, which the key distributes. Every vertex is moved
//! along its ray to the nearest point of its bit's quantizer, shifted by its cell's own keyed dither. A detector sums sines of the
//! phases of a bit's vertices. It tries what the frame leaves open: the signs of its axes, and the scale by 2 %.
//!
//! Where distances hardly differ, a scale that is wrong by half a step turns all bits over, and the complement of a
//! codeword is a codeword. No dither tells the two apart, for it moves both: what reads a message must try both against check
//! bits.

mod cells;
mod reading;
mod sphere;

pub use cells::Cells;
pub use reading::{CellReading, NUM_TESTS};
