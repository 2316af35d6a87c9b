//! Evidence: what a suspect says before any key is known. Measured once, kept, tested against as many keys as there are.
//!
//! Stored form (docs/FORMAT.md): `MMEV`, a version of 2 bytes, then one section a carrier: a tag of 4 bytes, the length of
//! its content in 4 bytes, the content. All integers little-endian.

use crate::carrier::{Carrier, Measurement, Stored, StoredError};
use crate::mesh::Mesh;

const MAGIC: &[u8; 4] = b"MMEV";
const VERSION: u16 = 1;

/// Why bytes are not evidence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EvidenceError {
    /// Something else.
    #[error("this is not an evidence file")]
    NotEvidence,
    /// Evidence of a later version.
    #[error(
        "this evidence was measured by a later version (format {0}); this one reads format {VERSION}"
    )]
    Version(u16),
    /// Cut short or damaged.
    #[error("the evidence is damaged: measure the suspect again")]
    Damaged,
    /// Numbers that no surface gives: it was not measured, but made up.
    #[error("the evidence has {0}, which no model gives: measure the suspect yourself")]
    Impossible(&'static str),
}

impl From<StoredError> for EvidenceError {
    fn from(error: StoredError) -> EvidenceError {
        match error {
            StoredError::Damaged => EvidenceError::Damaged,
            StoredError::Impossible(what) => EvidenceError::Impossible(what),
        }
    }
}

impl EvidenceError {
    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            EvidenceError::NotEvidence => "evidence.not-evidence",
            EvidenceError::Version(_) => "evidence.version",
            EvidenceError::Damaged => "evidence.damaged",
            EvidenceError::Impossible(_) => "evidence.impossible",
        }
    }
}

/// A key-free measurement of a suspect.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// One of each carrier that it keeps, in the order of [`Stored::ALL`].
    measurements: [Measurement; 2],
}

impl Evidence {
    /// Measures a mesh.
    #[doc(hidden)]
    pub fn of_mesh(mesh: &Mesh) -> Evidence {
        Evidence {
            measurements: Stored::ALL.map(|stored| stored.measure(mesh)),
        }
    }

    /// What a carrier measured, of [`Carrier::STANDARD`].
    #[doc(hidden)]
    pub fn measurement(&self, carrier: Carrier) -> &Measurement {
        let is_its = |measurement: &&Measurement| measurement.carrier() == carrier;
        let measurement = self.measurements.iter().find(is_its);
        measurement.expect("there is one of each carrier")
    }

    /// The evidence as bytes: docs/FORMAT.md.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = [MAGIC.as_slice(), &VERSION.to_le_bytes()].concat();
        for (measurement, stored) in self.measurements.iter().zip(Stored::ALL) {
            let content = measurement.to_bytes();
            let length =
                u32::try_from(content.len()).expect("some tens of bytes for each of 2^24 vertices");
            let tag = stored.section().as_slice();
            bytes.extend([tag, &length.to_le_bytes(), &content].concat());
        }
        bytes
    }

    /// Evidence from its bytes.
    ///
    /// # Errors
    /// Any [`EvidenceError`]: where they are something else, of a later version, damaged, or hold numbers that no model gives.
    pub fn from_bytes(bytes: &[u8]) -> Result<Evidence, EvidenceError> {
        let bytes = bytes
            .strip_prefix(MAGIC)
            .ok_or(EvidenceError::NotEvidence)?;
        let (version, bytes) = bytes.split_first_chunk().ok_or(EvidenceError::Damaged)?;
        match u16::from_le_bytes(*version) {
            VERSION => {}
            other => return Err(EvidenceError::Version(other)),
        }
        let mut rest = bytes;
        let mut measurements = Vec::new();
        for stored in Stored::ALL {
            let content;
            (content, rest) = section(rest, stored.section()).ok_or(EvidenceError::Damaged)?;
            measurements.push(stored.measurement_from(content)?);
        }
        match measurements.try_into() {
            Ok(measurements) if rest.is_empty() => Ok(Evidence { measurements }),
            _ => Err(EvidenceError::Damaged),
        }
    }
}

/// Some carriers' measurements make evidence too: that of the others shows nothing.
#[doc(hidden)]
impl FromIterator<Measurement> for Evidence {
    fn from_iter<I: IntoIterator<Item = Measurement>>(measurements: I) -> Evidence {
        let mut given: Vec<Measurement> = measurements.into_iter().collect();
        let take = |stored: Stored| {
            let is_its = |measurement: &Measurement| measurement.carrier() == stored.carrier();
            let place = given.iter().position(is_its);
            let given = place.map(|place| given.swap_remove(place));
            given.unwrap_or_else(|| {
                let nothing = stored.measurement_from(&[]);
                nothing.expect("no bytes are a measurement that shows nothing")
            })
        };
        Evidence {
            measurements: Stored::ALL.map(take),
        }
    }
}

/// The content of the section that bytes begin with, and what follows it.
fn section<'a>(bytes: &'a [u8], tag: &[u8; 4]) -> Option<(&'a [u8], &'a [u8])> {
    let (length, bytes) = bytes.strip_prefix(tag)?.split_first_chunk()?;
    bytes.split_at_checked(u32::from_le_bytes(*length) as usize)
}
