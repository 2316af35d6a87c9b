//! Where a mark's symbols live in geometry. Knows meshes and keys; knows nothing of files, attacks or verdicts.
//!
//! Every carrier offers the same three functions: `embed` finds the displacement that gives symbols the signs of a
//! codeword, `measure` takes from a mesh all that needs no key, and `read` turns a measurement and a key into soft symbols,
//! one list for each hypothesis that it declares in advance.

pub mod direction;
pub mod qim;
pub mod ring;
pub mod solid;

use crate::code::{Codeword, SoftSymbol};
use crate::detection::Statistic;
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
    /// Flux through windows of a keyed lattice: see [`solid`].
    Solid,
    /// Offsets of vertices from their one-rings, addressed by connectivity: see [`ring`].
    Ring,
}

impl Carrier {
    /// Every carrier, in the order of embedding.
    pub const ALL: [Carrier; 2] = [Carrier::Solid, Carrier::Ring];

    /// The name that scripts and pages use.
    pub fn name(self) -> &'static str {
        match self {
            Carrier::Solid => "solid",
            Carrier::Ring => "ring",
        }
    }

    /// The carrier of a name.
    pub fn from_name(name: &str) -> Option<Carrier> {
        Self::ALL.into_iter().find(|carrier| carrier.name() == name)
    }

    /// The share of the RMS limit that RING may take on top of another carrier: its step is a fraction of an edge, so dense
    /// meshes need no more, and on coarse ones more would drown what SOLID wrote.
    pub const SHARE_ON_TOP: f64 = 0.25;

    /// The displacement of all V vertices that gives the host the mark.
    pub fn embed(
        self,
        host: &Host,
        mark: &Mark,
        progress: &mut dyn Progress,
    ) -> Result<Vec<DVec3>, CarrierError> {
        match self {
            Carrier::Solid => solid::embed(host, mark, progress),
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
    /// Whether to stay below that limit where the surface is too smooth to hide it.
    pub hidden: bool,
    /// Whether another carrier's mark is in the mesh already.
    pub on_top: bool,
}

/// What is to be embedded.
pub struct Mark<'a> {
    /// Whose mark it is.
    pub key: &'a Key,
    /// The encoded message.
    pub codeword: &'a Codeword,
}

/// How a key reads a measurement.
#[derive(Default)]
pub struct Reading {
    /// The ways of reading that were followed, for the others had nothing to say.
    pub hypotheses: Vec<Hypothesis>,
    /// Distinct addresses that were there to be read, whoever's they are.
    pub num_addresses: usize,
}

impl Reading {
    /// The exponent of the bound for a codeword that is known, in the hypothesis that it fits best, before charges.
    pub fn exponent(&self, codeword: &Codeword) -> f64 {
        let fit = |hypothesis: &Hypothesis| {
            let symbols = hypothesis.symbols.iter();
            let signed = symbols.map(|soft| (soft.value * codeword.sign(soft.symbol), soft.weight));
            -Statistic::new(signed).ln_p()
        };
        self.hypotheses.iter().map(fit).fold(0.0, f64::max)
    }
}

/// One way of reading a measurement: its soft symbols.
pub struct Hypothesis {
    /// One for each address that is the key's.
    pub symbols: Vec<SoftSymbol>,
    /// What this way of reading is charged: the logarithm of the inverse of its share in the probability of a false alarm.
    /// The shares of all ways that were declared before any key was known add up to 1 at most.
    pub ln_num_tests: f64,
}

/// Why bytes are no measurement. Whoever sends evidence may have written it by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoredError {
    /// Cut short, or not such bytes at all.
    Damaged,
    /// Numbers that no surface gives, in words that follow "the evidence has".
    Impossible(&'static str),
}

/// The first bytes of some, which are taken off.
pub(crate) fn take<const N: usize>(bytes: &mut &[u8]) -> Result<[u8; N], StoredError> {
    let (first, rest) = bytes.split_first_chunk().ok_or(StoredError::Damaged)?;
    *bytes = rest;
    Ok(*first)
}

/// Goes on only with what a surface can give.
pub(crate) fn possible(is_possible: bool, otherwise: &'static str) -> Result<(), StoredError> {
    if is_possible {
        Ok(())
    } else {
        Err(StoredError::Impossible(otherwise))
    }
}

/// Why a mark could not be embedded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CarrierError {
    /// The model is too small or too regular.
    #[error(
        "the model is too small or too regular for the {} carrier: its {vertices} vertices give {available} distinct places \
         for symbols, and a mark of 48 bits needs {needed}",
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
    },
    /// The model's shape is too poor: hardly any displacement within the limit moves what the carrier measures.
    #[error(
        "the {} carrier reaches an exponent of {reached:.0} in this model, and a mark of 48 bits needs {needed:.0}",
        carrier.name()
    )]
    TooWeak {
        /// The carrier that cannot be used.
        carrier: Carrier,
        /// The exponent that was reached, in nats.
        reached: f64,
        /// The exponent that a mark needs, in nats.
        needed: f64,
    },
    /// Too few vertices for a code of fixed length.
    #[error("the model has {available} vertices that can hold a text, and its code needs {needed}")]
    TooFewHosts {
        /// Vertices that the code needs.
        needed: usize,
        /// Vertices that there are.
        available: usize,
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
            CarrierError::TooWeak { .. } => "carrier.too-weak",
            CarrierError::TooFewHosts { .. } => "carrier.too-few-hosts",
            CarrierError::Cancelled(_) => "aborted",
        }
    }
}
