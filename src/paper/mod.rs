//! The seed paper, whole: its watermarking system and its study of what smoothing does to the vertices that a mark would be in
//! (Vasic 2012, "Mesh smoothing and watermark stability"; docs/REFERENCES.md). Marks and notes of the product are not here: they are
//! carriers of their own. docs/STUDY.md has the results, and says what is the paper's and what is ours.
//!
//! | in the paper | file | functions |
//! |---|---|---|
//! | II.A, Eq. 1: embedding with E, retrieving with D, and k = c \|\| k' where the original is known | `chain`, `finding` | [`Chain::embed`], [`Chain::read`], [`Chain::read_with_original`] |
//! | II.C, the smoothings that are named | `smoothing` | [`Smoothing::apply`] |
//! | II.C, Eqs 2 to 4: averaged normals, the fit to them, its minimum | `attack::mean_filter` | [`mean_filter`](crate::attack::mean_filter) |
//! | II.C and Fig. 1, MeshSmooth | `attack::subdivide` | [`catmull_clark`](crate::attack::catmull_clark) |
//! | III and Fig. 2, the coded watermarking system | `chain` | [`Chain`] |
//! | III, error correction codes (reference 12) | `code::ldpc` | [`Block`](crate::code::Block) |
//! | III.A, host vertex selection: OSVETA, the two vectors | `stability` | [`rank`], [`Stability`] |
//! | III.A, curvature by fitted quadrics, and by differential geometry | `geometry::curvature` | [`fitted_curvature`](crate::geometry::fitted_curvature), [`curvature_integrals`](crate::geometry::curvature_integrals) |
//! | III.A, criteria of optimization and simplification | `geometry::quadric`, `geometry::dihedral`, `geometry::normal` | [`collapse_costs`](crate::geometry::collapse_costs), [`dihedrals`](crate::geometry::dihedrals), [`normal_deviations`](crate::geometry::normal_deviations) |
//! | III.B, run-length mapping, with its decoder | `run_length` | [`run_length::encode`], [`run_length::decode`] |
//! | III.C, Eq. 5: QIM | `carrier::qim` | [`quantize`](crate::carrier::qim::quantize) |
//! | III.C, Eq. 6: embedding by sparse QIM | `sparse_qim` | [`SparseQim::embed`] |
//! | III.C, Eq. 7: its detector, with soft output | `sparse_qim` | [`SparseQim::evidence`] |
//! | reference 5, barycentre and spherical coordinates | `spherical` | [`Spherical`], [`Barycentre`] |
//! | IV, the model brought to 11 732 faces | `preparation` | [`Preparation`], [`NUM_FACES`] |
//! | IV, the indices of hosts known after smoothing | `finding` | [`Chain::read_traced`] |
//! | Fig. 3 and Fig. 4, hosts before and after smoothing | `figure_3` | [`trace`], [`fields`] |
//! | Table I, hosts found again | `table_1` | [`hosts`] |
//! | Fig. 5, error probability | `figure_5` | [`figure_5::figure_5`] |
//! | Table I and Fig. 5 of one mesh | `study` | [`study()`] |
//!
//! `spread` is the mean and the deviation of several draws.

mod chain;
mod figure_3;
pub mod figure_5;
mod finding;
mod preparation;
pub mod run_length;
mod smoothing;
mod sparse_qim;
mod spherical;
mod spread;
mod stability;
mod study;
mod table_1;

pub use chain::{Chain, Embedded, Received};
pub use figure_3::{Fields, Tracing, fields, trace};
pub use preparation::{NUM_FACES, Preparation};
pub use smoothing::Smoothing;
pub use sparse_qim::SparseQim;
pub use spherical::{Barycentre, Spherical};
pub use spread::Spread;
pub use stability::{Ranking, Stability, rank};
pub use study::{Study, study};
pub use table_1::{Count, HostsOptions, HostsRow, Rule, RuleCounts, hosts};
