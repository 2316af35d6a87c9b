//! Why a carrier cannot embed, and why bytes are no measurement.

use super::Carrier;
use crate::progress::Cancelled;

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
         for symbols, and a mark needs {needed}",
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
        "the {} carrier reaches an exponent of {reached:.0} in this model, and a mark needs {needed:.0}",
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
    /// The model can hold a mark without a payload, and none with one.
    #[error(
        "the {} carrier reaches an exponent of {reached:.0} in this model, and a mark of 48 bits needs {needed:.0}",
        carrier.name()
    )]
    NoPayload {
        /// The carrier that comes nearest.
        carrier: Carrier,
        /// The exponent that was reached, in nats.
        reached: f64,
        /// The exponent that a payload needs, in nats.
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
    /// How much of what is needed was reached.
    pub(crate) fn share(&self) -> f64 {
        match *self {
            CarrierError::TooFewAddresses {
                needed, available, ..
            } => available as f64 / needed as f64,
            CarrierError::TooWeak {
                reached, needed, ..
            }
            | CarrierError::NoPayload {
                reached, needed, ..
            } => reached / needed,
            CarrierError::TooFewHosts { .. } | CarrierError::Cancelled(_) => 0.0,
        }
    }

    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            CarrierError::TooFewAddresses { .. } => "carrier.too-few-addresses",
            CarrierError::TooWeak { .. } => "carrier.too-weak",
            CarrierError::NoPayload { .. } => "carrier.no-payload",
            CarrierError::TooFewHosts { .. } => "carrier.too-few-hosts",
            CarrierError::Cancelled(_) => "aborted",
        }
    }
}
