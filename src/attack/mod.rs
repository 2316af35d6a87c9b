//! What can happen to a model after it was marked: pure functions of a mesh and a seed. An attacker has no key.

mod crop;
mod noise;
mod quantize;
mod reorder;
mod similarity;
mod smooth;

pub use crop::crop;
pub use noise::noise;
pub use quantize::quantize;
pub use reorder::reorder;
pub use similarity::similarity;
pub use smooth::smooth;
