//! A surface of a suspect, as it is kept: in small pieces, in its own frame, with how it came from the suspect.

use super::frame::Axes;
use super::pitch::{MOST_PITCHES, PITCHES};
use super::store::Store;
use super::strength::FAMILIES;
use super::stretch::Stretchable;
use crate::carrier::{StoredError, possible, take};

/// How a surface came from the suspect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// It is the suspect.
    Suspect,
    /// Chords were replaced by arcs.
    Refined,
    /// A smoothing was undone: a node of [`FAMILIES`].
    Filtered { family: u8, node: u8 },
}

impl Origin {
    fn read(bytes: [u8; 2]) -> Option<Origin> {
        match bytes {
            [0, 0] => Some(Origin::Suspect),
            [1, 0] => Some(Origin::Refined),
            [family, node] => {
                let family = family.checked_sub(2)?;
                let nodes = FAMILIES.get(usize::from(family))?.len();
                (usize::from(node) < nodes).then_some(Origin::Filtered { family, node })
            }
        }
    }
}

/// A surface of a suspect, in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    pub(super) origin: Origin,
    /// The first and the second axis; the second and the third.
    pub(super) axes: [Axes; 2],
    /// Of the suspect itself, where somebody may have stretched it.
    pub(super) stretchable: Option<Stretchable>,
    /// The pitches that it is read at.
    pub(super) pitches: Vec<f64>,
    /// Fine enough for all of them.
    pub(super) store: Store,
}

impl Surface {
    /// A whole suspect that no pitch is read for, where its pieces are read.
    pub fn unread() -> Surface {
        Surface {
            origin: Origin::Suspect,
            axes: [Axes::Distinct; 2],
            stretchable: None,
            pitches: Vec::new(),
            store: Store::new(&[], PITCHES[0]),
        }
    }

    /// Takes a surface from the beginning of bytes: its origin in 2, what its axes are in 2, a bit for each pitch; where there is any pitch,
    /// of the suspect itself what undoing a stretch needs, and its store.
    pub fn read(bytes: &mut &[u8]) -> Result<Surface, StoredError> {
        let origin = Origin::read(take(bytes)?).ok_or(StoredError::Damaged)?;
        let [first, second] = take(bytes)?;
        let axes = |byte: u8| {
            let known = [Axes::Distinct, Axes::Exchangeable, Axes::Undetermined];
            let axes = known.get(usize::from(byte)).copied();
            axes.ok_or(StoredError::Damaged)
        };
        let axes = [axes(first)?, axes(second)?];
        let [bits] = take(bytes)?;
        let is_read = |(number, pitch): (u8, f64)| (bits >> number & 1 != 0).then_some(pitch);
        let pitches: Vec<f64> = (0..).zip(PITCHES).filter_map(is_read).collect();
        // No more are charged.
        let is_possible = pitches.len() <= MOST_PITCHES && bits >> PITCHES.len() == 0;
        possible(is_possible, "a surface at more pitches than are read")?;
        let Some(&finest) = pitches.first() else {
            let unread = Surface::unread();
            let is_unread = (origin, axes) == (unread.origin, unread.axes);
            return is_unread.then_some(unread).ok_or(StoredError::Damaged);
        };
        let stretchable = match origin {
            Origin::Suspect => Some(Stretchable::read(bytes)?),
            _ => None,
        };
        Ok(Surface {
            origin,
            axes,
            stretchable,
            store: Store::read(bytes, finest)?,
            pitches,
        })
    }

    /// Appends the bytes.
    pub fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend(match self.origin {
            Origin::Suspect => [0, 0],
            Origin::Refined => [1, 0],
            Origin::Filtered { family, node } => [family + 2, node],
        });
        bytes.extend(self.axes.map(|axes| axes as u8));
        let bit = |own: &f64| 1u8 << PITCHES.partition_point(|pitch| pitch < own);
        bytes.push(self.pitches.iter().map(bit).sum());
        if !self.pitches.is_empty() {
            if let Some(stretchable) = &self.stretchable {
                stretchable.write(bytes);
            }
            self.store.write(bytes);
        }
    }
}
