//! Which vertices are made of which bytes.

use super::Placement;
use crate::document::{Document, DocumentError, Slot};
use crate::order::order_by_words;

/// One element as one placement shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Use {
    /// The element's bytes: equal for elements, of whatever accessors, that are the same.
    pub slot: Slot,
    /// Index of the placement.
    pub placement: u32,
    /// Index of the element in the placement's accessor.
    pub element: u32,
    /// The vertex that it is part of.
    pub vertex: u32,
}

/// All uses of stored elements, those of one slot side by side, placements ascending.
pub fn uses(document: &Document, placements: &[Placement]) -> Result<Vec<Use>, DocumentError> {
    let mut uses: Vec<Use> = Vec::new();
    // A scene within its limits has fewer of each than a u32 can count.
    for (placement, shown) in (0..).zip(placements) {
        let slots = (0..).zip(document.slots(shown.accessor)?);
        uses.extend(
            slots
                .zip(&shown.vertices)
                .filter_map(|((element, slot), vertex)| {
                    Some(Use {
                        slot: slot?,
                        placement,
                        element,
                        vertex: (*vertex)?,
                    })
                }),
        );
    }
    // They are in order of placement and element already.
    let slots: Vec<[u64; 2]> = uses
        .iter()
        .map(|usage| [usage.slot.storage as u64, usage.slot.offset as u64])
        .collect();
    let order = order_by_words(&slots).into_iter();
    Ok(order
        .filter_map(|index| uses.get(index as usize).copied())
        .collect())
}
