//! What SOLID measures of a suspect without a key, and what a key reads in it: at once, or as it is measured.

use super::reading::read;
use super::surface::{Origin, Surface};
use super::surfaces::Surfaces;
use crate::carrier::{Reading, StoredError, possible};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress};
use std::borrow::Cow;

/// Key-free measurement of a mesh: all its surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    surfaces: Vec<Surface>,
}

impl Measurement {
    /// Measures a mesh.
    pub fn new(mesh: &Mesh) -> Measurement {
        Surfaces::new(mesh).collect()
    }

    /// The soft symbols of a key.
    pub fn read(&self, key: &Key, progress: &mut dyn Progress) -> Result<Reading, Cancelled> {
        read(&mut self.surfaces.iter().map(Cow::Borrowed), key, progress)
    }

    /// The measurement as bytes: its surfaces one after the other.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.surfaces
            .iter()
            .for_each(|surface| surface.write(&mut bytes));
        bytes
    }

    /// A measurement from its bytes.
    ///
    /// # Errors
    /// Where they are none, or hold numbers that no surface gives.
    pub fn from_bytes(mut bytes: &[u8]) -> Result<Measurement, StoredError> {
        let mut surfaces = Vec::new();
        while !bytes.is_empty() {
            surfaces.push(Surface::read(&mut bytes)?);
        }
        // Each surface is charged once.
        let is_first = |surface: &Surface| surface.origin == Origin::Suspect;
        let in_order = |pair: &[Surface]| pair[0].origin < pair[1].origin;
        possible(
            surfaces.first().is_none_or(is_first),
            "surfaces without the suspect's own",
        )?;
        possible(
            surfaces.windows(2).all(in_order),
            "surfaces out of order or twice",
        )?;
        Ok(Measurement { surfaces })
    }
}

/// Some of the surfaces of a suspect make a measurement too: one that knows of fewer attacks.
impl FromIterator<Surface> for Measurement {
    fn from_iter<I: IntoIterator<Item = Surface>>(surfaces: I) -> Measurement {
        Measurement {
            surfaces: surfaces.into_iter().collect(),
        }
    }
}

impl Surfaces {
    /// The soft symbols of a key: no more surfaces are measured than it takes to find its mark.
    pub fn read(self, key: &Key, progress: &mut dyn Progress) -> Result<Reading, Cancelled> {
        read(&mut self.map(Cow::Owned), key, progress)
    }
}
