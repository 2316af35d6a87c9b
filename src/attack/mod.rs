//! What can happen to a model after it was marked: pure functions of a mesh and a seed. An attacker has no key.

mod average;
mod bend;
mod catalogue;
mod collapse;
mod crop;
mod editing;
mod export;
mod flip;
mod flow;
mod layers;
mod lindstrom_turk;
mod mean_filter;
mod noise;
mod optimize;
mod parts;
mod quantize;
mod queue;
mod remesh;
mod reorder;
mod resample;
mod scene;
mod similarity;
mod simplify;
mod smooth;
mod soup;
mod subdivide;
mod warp;
mod weld;

pub use average::average;
pub use bend::bend;
pub use catalogue::{
    Attack, CATALOGUE, CROP, Entry, Family, NOISE, QUANTIZE_EVENLY, SIMPLIFY, SMOOTH, Step, chain,
    entries, step,
};
pub use crop::crop;
pub use export::{bake, convert_units, mirror, swap_axes};
pub use flip::delaunay;
pub use flow::mean_curvature_flow;
pub use layers::{ball_within, both_sides, bridged_hull, copies, hull, needles, stray};
pub use lindstrom_turk::simplify_volume;
pub use mean_filter::mean_filter;
pub use noise::noise;
pub use optimize::optimize;
pub use parts::{split, take_out};
pub use quantize::{quantize, quantize_evenly};
pub use remesh::remesh;
pub use reorder::reorder;
pub use resample::resample;
pub use scene::into_scene;
pub use similarity::similarity;
pub use simplify::{simplify, simplify_to};
pub use smooth::{bilaplacian, smooth, smooth_inside, taubin};
pub use soup::soup;
pub use subdivide::{catmull_clark, loop_scheme, midpoint, sqrt3};
pub use warp::warp;
pub use weld::weld;
