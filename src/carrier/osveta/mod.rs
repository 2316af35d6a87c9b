//! OSVETA, ordered statistics vertex extraction and tracing: which vertices of a mesh will still be what they are after it was
//! smoothed, subdivided or simplified, most stable first (Vasic, "Mesh smoothing and watermark stability", section III.A), and
//! coded bits in their distances from the barycentre (sections III.B and III.C; Vasic and Vasic 2012).

pub mod cells;
mod chain;
mod hosts;
mod sparse_qim;
mod spherical;
mod stability;

pub use cells::{CellReading, Cells};
pub use chain::{Chain, Embedded, Received};
pub use sparse_qim::{SparseQim, quantize};
pub use spherical::{Barycentre, Spherical};
pub use stability::{Ranking, Stability, rank};
