//! Generated meshes, for demonstrations, tests and benchmarks. Deterministic: a shape is a function of its arguments.
//!
//! Their quads are split along one of their diagonals at random, so that connectivity is as irregular as in a modelled or
//! scanned mesh.

mod assembly;
mod machine;
mod natural;
mod parts;
mod revolution;

pub use assembly::{game_asset, seven_shapes};
pub use machine::cad_part;
pub use natural::{asteroid, leaf, low_poly, terrain, torus_knot};
pub use parts::cuboid;
pub use revolution::{capsule, icosphere, relief_sphere, torus, vase};
