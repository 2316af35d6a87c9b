//! Where a mark's symbols live in geometry. Knows meshes and keys; knows nothing of files, attacks or verdicts.
//!
//! Every carrier offers the same three functions: `embed` finds the displacement that gives symbols the signs of a
//! codeword, `measure` takes from a mesh all that needs no key, and `read` turns a measurement and a key into soft symbols,
//! one list for each hypothesis that it declares in advance.

pub mod ring;

use crate::code::{Codeword, SoftSymbol};
use crate::key::Key;
use crate::mesh::{Admissible, Mesh};
use crate::progress::{Cancelled, Progress};
use glam::DVec3;

/// A carrier.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum Carrier {
    /// Offsets of vertices from their one-rings, addressed by connectivity: see [`ring`].
    Ring,
}

impl Carrier {
    /// Every carrier, in the order of embedding.
    pub const ALL: [Carrier; 1] = [Carrier::Ring];

    /// The name that scripts and pages use.
    pub fn name(self) -> &'static str {
        match self {
            Carrier::Ring => "ring",
        }
    }

    /// The carrier of a name.
    pub fn from_name(name: &str) -> Option<Carrier> {
        Self::ALL.into_iter().find(|carrier| carrier.name() == name)
    }

    /// The displacement of all V vertices that gives the host the mark.
    pub fn embed(
        self,
        host: &Host,
        mark: &Mark,
        progress: &mut dyn Progress,
    ) -> Result<Vec<DVec3>, CarrierError> {
        match self {
            Carrier::Ring => ring::embed(host, mark, progress),
        }
    }
}

/// What is to be marked.
pub struct Host<'a> {
    /// The mesh, in scene units.
    pub mesh: &'a Mesh,
    /// Which displacements can be written back.
    pub admissible: &'a Admissible,
    /// Limit of the RMS displacement over all vertices, as a fraction of the diagonal.
    pub rms_rel: f64,
}

/// What is to be embedded.
pub struct Mark<'a> {
    /// Whose mark it is.
    pub key: &'a Key,
    /// The encoded message.
    pub codeword: &'a Codeword,
}

/// One way of reading a measurement, declared before any key is known: its soft symbols.
pub struct Hypothesis {
    /// One for each address that is the key's.
    pub symbols: Vec<SoftSymbol>,
    /// Distinct addresses that were there to be read, whoever's they are.
    pub num_addresses: usize,
}

/// Why a mark could not be embedded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CarrierError {
    /// The model is too small or too regular.
    #[error(
        "the model is too small or too regular for the {} carrier: of {vertices} vertices, {rings} have closed rings, and \
         these have {available} distinct neighbourhoods where a mark of 48 bits needs {needed}",
        carrier.name()
    )]
    TooFewAddresses {
        /// The carrier that cannot be used.
        carrier: Carrier,
        /// Distinct addresses that a mark needs.
        needed: usize,
        /// Distinct addresses of the model.
        available: usize,
        /// Vertices of the model.
        vertices: usize,
        /// Vertices that could carry a symbol.
        rings: usize,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl CarrierError {
    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            CarrierError::TooFewAddresses { .. } => "carrier.too-few-addresses",
            CarrierError::Cancelled(_) => "aborted",
        }
    }
}
