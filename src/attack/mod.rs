//! What can happen to a model after it was marked: pure functions of a mesh and a seed. An attacker has no key.

mod average;
mod catalogue;
mod collapse;
mod crop;
mod editing;
mod flow;
mod lindstrom_turk;
mod mean_filter;
mod noise;
mod optimize;
mod quantize;
mod remesh;
mod reorder;
mod resample;
mod similarity;
mod simplify;
mod smooth;
mod subdivide;
mod warp;

pub use average::average;
pub use catalogue::{Attack, CATALOGUE, Family, Step, step};
pub use crop::crop;
pub use flow::mean_curvature_flow;
pub use lindstrom_turk::simplify_volume;
pub use mean_filter::mean_filter;
pub use noise::noise;
pub use optimize::optimize;
pub use quantize::quantize;
pub use remesh::remesh;
pub use reorder::reorder;
pub use resample::resample;
pub use similarity::similarity;
pub use simplify::{simplify, simplify_to};
pub use smooth::{bilaplacian, smooth, smooth_inside, taubin};
pub use subdivide::{catmull_clark, loop_scheme, midpoint, sqrt3};
pub use warp::warp;
