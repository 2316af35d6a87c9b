//! Pictures of surfaces, drawn without a graphics card: for files that a person prints. Sums, products and square roots alone: the same everywhere.
//!
//! | file | what |
//! |---|---|
//! | `draw` | triangles in perspective, lit, the nearer before the farther |
//! | `colour` | a scale of colours |

mod colour;
mod draw;

pub use colour::{Colour, viridis};
pub use draw::{Painted, Picture, View};
