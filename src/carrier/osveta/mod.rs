//! OSVETA, ordered statistics vertex extraction and tracing: which vertices of a mesh will still be what they are after it was
//! smoothed, subdivided or simplified, most stable first (Vasic, "Mesh smoothing and watermark stability", section III.A).

mod stability;

pub use stability::{Ranking, Stability, rank};
