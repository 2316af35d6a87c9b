//! Evidence: what a suspect says before any key is known. Measured once, kept, tested against as many keys as there are.
//!
//! Stored form (docs/FORMAT.md): `MMEV`, a version of 2 bytes, then one section a carrier: a tag of 4 bytes, the length of
//! its content in 4 bytes, the content. All integers little-endian.

use crate::carrier::{StoredError, ring, solid};
use crate::mesh::Mesh;

const MAGIC: &[u8; 4] = b"MMEV";
const VERSION: u16 = 1;
const RING: &[u8; 4] = b"RING";
const SOLID: &[u8; 4] = b"SOLI";

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
    /// What RING measured.
    pub ring: ring::Measurement,
    /// What SOLID measured.
    pub solid: solid::Measurement,
}

impl Evidence {
    /// Measures a mesh.
    pub fn measure(mesh: &Mesh) -> Evidence {
        Evidence {
            ring: ring::Measurement::new(mesh),
            solid: solid::Measurement::new(mesh),
        }
    }

    /// The evidence as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = [MAGIC.as_slice(), &VERSION.to_le_bytes()].concat();
        for (tag, content) in [(RING, self.ring.to_bytes()), (SOLID, self.solid.to_bytes())] {
            let length =
                u32::try_from(content.len()).expect("some tens of bytes for each of 2^24 vertices");
            bytes.extend([tag.as_slice(), &length.to_le_bytes(), &content].concat());
        }
        bytes
    }

    /// Evidence from its bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Evidence, EvidenceError> {
        let bytes = bytes
            .strip_prefix(MAGIC)
            .ok_or(EvidenceError::NotEvidence)?;
        let (version, bytes) = bytes.split_first_chunk().ok_or(EvidenceError::Damaged)?;
        match u16::from_le_bytes(*version) {
            VERSION => {}
            other => return Err(EvidenceError::Version(other)),
        }
        let (ring, bytes) = section(bytes, RING).ok_or(EvidenceError::Damaged)?;
        let (solid, rest) = section(bytes, SOLID).ok_or(EvidenceError::Damaged)?;
        let ring = ring::Measurement::from_bytes(ring)?;
        let solid = solid::Measurement::from_bytes(solid)?;
        if rest.is_empty() {
            Ok(Evidence { ring, solid })
        } else {
            Err(EvidenceError::Damaged)
        }
    }
}

/// The content of the section that bytes begin with, and what follows it.
fn section<'a>(bytes: &'a [u8], tag: &[u8; 4]) -> Option<(&'a [u8], &'a [u8])> {
    let (length, bytes) = bytes.strip_prefix(tag)?.split_first_chunk()?;
    bytes.split_at_checked(u32::from_le_bytes(*length) as usize)
}
