//! RING: quantization index modulation of each vertex's offset from its one-ring.
//!
//! The *feature* of a vertex is its offset from the mean of its neighbours along the ring's own normal, divided by the
//! ring's size: similarities do not change it. The *address* of a vertex is a hash of its neighbourhood, so there is no
//! pose to find and no order to keep: what is left of a model after cropping still says where each symbol belongs. The key
//! owns a quarter of the addresses; two owners who mark one model collide on a sixteenth of them, and neither loses theirs.
//!
//! Only rings whose address no other ring has carry symbols: rings that share one share its dither, and would agree with each other
//! for everybody to see.
//!
//! Regular and small meshes, whose neighbourhoods look alike, are addressed by the place of a vertex in the model's own frame
//! instead: that survives re-export and quantization, but no crop.
//!
//! Survives what keeps connectivity: crops, parts taken, reordering, similarities, quantization to 14 to 11 bits, and, for
//! flat rings, affine maps. Dies with connectivity: remeshing, simplification beyond a tenth, subdivision, smoothing.
//!
//! The method and its constants are this project's own (docs/REFERENCES.md, "RING"). QIM with dither: Chen and Wornell
//! 2001. Addresses: one-dimensional Weisfeiler-Leman refinement.

mod address;
mod embed;
mod feature;
mod known;
mod measurement;
mod trace;

pub use embed::{Prepared, embed};
pub use known::Known;
pub use measurement::Measurement;
pub use trace::{Ring, rings, trace};

use crate::code::Symbol;
use crate::key::{Key, Prf, unit};

/// Step of the quantizer, in units of the feature: a displacement of about 1.3 % of an edge.
pub const STEP: f64 = 0.04;

/// One address in so many is a key's own. With all of them, whoever marks a marked model with a key of their own erases
/// the first mark: ln p of the bunny's goes from -8751 to -4; with a quarter, from -2926 to -1469.
pub const SHARE: u64 = 4;

/// What a key makes of an address that it owns.
struct Owned {
    /// In steps of the quantizer, 0 to 1.
    dither: f64,
    symbol: Symbol,
}

/// The addresses of one key.
struct Ownership(Prf);

impl Ownership {
    fn of(key: &Key) -> Ownership {
        Ownership(key.prf("ring"))
    }

    fn get(&self, address: u64) -> Option<Owned> {
        let (dither, choice) = self.0.at(address);
        (choice % SHARE == 0).then(|| Owned {
            dither: unit(dither),
            symbol: Symbol::select(choice / SHARE),
        })
    }
}
