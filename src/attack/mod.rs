//! What can happen to a model after it was marked: pure functions of a mesh and a seed. An attacker has no key.

mod crop;
mod quantize;
mod reorder;
mod similarity;

pub use crop::crop;
pub use quantize::quantize;
pub use reorder::reorder;
pub use similarity::similarity;
