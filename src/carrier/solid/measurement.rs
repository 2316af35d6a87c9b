//! What SOLID measures of a suspect without a key, and what a key reads in it: at once, or as it is measured.

use super::lattice::Lattice;
use super::reading::{SurfacesOf, read};
use super::surface::{Origin, Surface};
use super::surfaces::Surfaces;
use crate::carrier::{Reading, StoredError, possible};
use crate::geometry::{Piece, Pieces};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress};
use std::borrow::Cow;

/// Pieces that are read alone, at most: objects first, then patches, then rests, those of most triangles.
const MOST_PIECES: usize = 16;

/// Objects of which what smoothing may have done is undone too, at most: the first. Each takes as long as a whole model. Where a scene was smoothed, the whole and these
/// tell.
const MOST_UNDONE: usize = 4;

/// Pieces that are searched widely, the whole being the first: stretches and scans take as long for a small one as for a large one.
const WIDE: usize = 2;

/// Key-free measurement of a mesh: all its surfaces, then those of each of its pieces. Each begins with what it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    surfaces: Vec<Surface>,
}

impl Measurement {
    /// Measures a mesh.
    pub fn new(mesh: &Mesh) -> Measurement {
        let mut all = Vec::new();
        for surfaces in Suspect::new(mesh).pieces {
            if surfaces.is_empty() {
                all.push(Surface::unread());
            }
            all.extend(surfaces);
        }
        Measurement { surfaces: all }
    }

    /// The soft symbols of a key.
    pub fn read(&self, key: &Key, progress: &mut dyn Progress) -> Result<Reading, Cancelled> {
        self.read_until(key, &|_| false, progress)
    }

    /// The same, ending where what the suspect says as it is settles all.
    pub fn read_until(
        &self,
        key: &Key,
        is_settled: &dyn Fn(&Reading) -> bool,
        progress: &mut dyn Progress,
    ) -> Result<Reading, Cancelled> {
        let mut pieces: Vec<SurfacesOf> = Vec::new();
        for piece in self.pieces() {
            pieces.push(Box::new(piece.iter().map(Cow::Borrowed)));
        }
        read(pieces, &|| Lattice::of(key), is_settled, WIDE, progress)
    }

    /// The surfaces of the whole, and of each piece.
    fn pieces(&self) -> impl Iterator<Item = &[Surface]> {
        let is_of_piece = |_: &Surface, next: &Surface| next.origin != Origin::Suspect;
        self.surfaces.chunk_by(is_of_piece)
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
        let measurement = Measurement { surfaces };
        possible(
            measurement
                .pieces()
                .all(|piece| piece.windows(2).all(in_order)),
            "surfaces out of order or twice",
        )?;
        possible(
            measurement.pieces().count() <= 1 + MOST_PIECES,
            "more pieces than are looked for",
        )?;
        Ok(measurement)
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

/// A suspect that is measured as it is read: as a whole, and each of its pieces alone.
pub struct Suspect {
    pieces: Vec<Surfaces>,
    num_wide: usize,
}

impl Suspect {
    /// Prepares a mesh.
    pub fn new(mesh: &Mesh) -> Suspect {
        let whole = std::iter::once(Surfaces::new(mesh));
        Suspect::of(whole.chain(pieces_of(mesh)))
    }

    /// The same, as a whole, in its own frame and with nothing undone.
    pub fn as_it_is(mesh: &Mesh) -> Suspect {
        let whole = Surfaces::new(mesh).facing_itself().plain();
        Suspect::of(std::iter::once(whole))
    }

    /// The same, for a mesh that nobody has turned since it was marked (see [`Surfaces::facing`]), as a whole or in pieces. What the
    /// axes of pieces were is not known, but only pieces that have their own are marked: there is no need to scan.
    pub fn copied(mesh: &Mesh, unmarked: &Surfaces, in_pieces: bool) -> Suspect {
        let whole = std::iter::once(Surfaces::new(mesh).facing(unmarked));
        match in_pieces {
            true => Suspect::of(whole.chain(pieces_of(mesh).map(Surfaces::facing_itself))),
            false => Suspect::of(whole),
        }
    }

    /// The whole comes first, whether or not it can be read.
    fn of(all: impl Iterator<Item = Surfaces>) -> Suspect {
        let mut number = 0..;
        let is_kept = |surfaces: &Surfaces| number.next() == Some(0) || !surfaces.is_empty();
        let mut kept: Vec<Surfaces> = all.filter(is_kept).collect();
        if kept.iter().all(Surfaces::is_empty) {
            kept.clear();
        }
        Suspect {
            pieces: kept,
            num_wide: WIDE,
        }
    }

    /// The same, with surfaces of each piece that `change` makes of them.
    pub fn with(self, change: impl Fn(Surfaces) -> Surfaces) -> Suspect {
        Suspect {
            pieces: self.pieces.into_iter().map(change).collect(),
            ..self
        }
    }

    /// The same where it is known how it was turned and stretched: neither is searched for.
    pub fn known_to_lie(self) -> Suspect {
        Suspect {
            num_wide: 0,
            ..self
        }
    }

    /// The soft symbols of a key: no more surfaces are measured than it takes to find its mark, and none where what the suspect says as
    /// it is settles all.
    pub fn read_until(
        self,
        key: &Key,
        is_settled: &dyn Fn(&Reading) -> bool,
        progress: &mut dyn Progress,
    ) -> Result<Reading, Cancelled> {
        let mut pieces: Vec<SurfacesOf> = Vec::new();
        for surfaces in self.pieces {
            pieces.push(Box::new(surfaces.map(Cow::Owned)));
        }
        read(
            pieces,
            &|| Lattice::of(key),
            is_settled,
            self.num_wide,
            progress,
        )
    }
}

/// The triangles of a piece of a mesh, by its number in readings: 1 is the first.
pub fn piece(mesh: &Mesh, number: usize) -> Option<Piece> {
    let pieces = Pieces::of(mesh).in_order().take(MOST_PIECES);
    let is_read = |piece: &Piece| !Surfaces::new(&mesh.part(piece.clone())).is_empty();
    pieces.filter(is_read).nth(number.checked_sub(1)?)
}

/// What is read alone of a mesh.
fn pieces_of(mesh: &Mesh) -> impl Iterator<Item = Surfaces> {
    let Pieces {
        objects,
        patches,
        rests,
    } = Pieces::of(mesh);
    let of = |piece: Piece| Surfaces::new(&mesh.part(piece));
    // A patch or a rest is read alone for the sake of what was put beside it, and that smooths nothing.
    let mut objects = objects.into_iter();
    let undone: Vec<Piece> = objects.by_ref().take(MOST_UNDONE).collect();
    let plain = objects.chain(patches).chain(rests);
    let plain = plain.map(move |piece| of(piece).plain());
    let undone = undone.into_iter().map(of);
    undone.chain(plain).take(MOST_PIECES)
}
