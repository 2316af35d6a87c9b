//! The numbers in `min` and `max` of accessors, kept true to the data.

use std::ops::Range;

use serde_json::value::RawValue;

use super::accessor::{Accessor, Format};
use super::buffer::Storage;
use super::json;
use super::region::Slot;
use super::splice::Splice;

/// Makes `min` and `max` of an accessor true, if any of its elements changed. They state numbers as
/// these are stored, before normalization (glTF 2.0 specification section 3.6.2.5). Numbers that are
/// right already keep their spelling, and so do the bounds of data that is not finite.
pub(super) fn correct(
    accessor: &Accessor,
    slots: &[Option<Slot>],
    storages: &[Storage],
    splice: &mut Splice,
) {
    let size = accessor.format.position_size();
    let has_changed = |slot: &Slot| {
        storages
            .get(slot.storage)
            .is_some_and(|storage| storage.has_changed(slot.offset, size))
    };
    if slots.iter().flatten().any(has_changed) {
        make_true(accessor, &accessor.bounds, slots, storages, splice);
    }
}

/// Makes bounds true that stand in these places of a text.
pub(super) fn make_true(
    accessor: &Accessor,
    spans: &[Option<Range<usize>>; 2],
    slots: &[Option<Slot>],
    storages: &[Storage],
    splice: &mut Splice,
) {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let [lows, highs] = &mut bounds;
    for slot in slots {
        let stored = slot
            .and_then(|slot| accessor.format.raw_position(storages, slot))
            .unwrap_or_default();
        for (component, (low, high)) in stored
            .into_iter()
            .zip(lows.iter_mut().zip(highs.iter_mut()))
        {
            *low = low.min(component);
            *high = high.max(component);
        }
    }
    for (span, values) in spans.iter().zip(bounds) {
        if let Some(span) = span
            && values.iter().all(|value| value.is_finite())
        {
            state(values, span.clone(), accessor.format, splice);
        }
    }
}

/// Makes the bound at `span` state `values`.
fn state(values: [f64; 3], span: Range<usize>, format: Format, splice: &mut Splice) {
    let stated: Vec<&RawValue> = serde_json::from_str(splice.get(span.clone())).unwrap_or_default();
    if stated.len() != values.len() {
        let values = values.map(|value| spelling(value, format));
        splice.replace(span, format!("[{}]", values.join(",")));
        return;
    }
    for (stated, value) in stated.into_iter().zip(values) {
        let is_true = serde_json::from_str(stated.get()).is_ok_and(|stated: f64| {
            stated == value || format.is_float() && stated as f32 == value as f32
        });
        if let Some(span) = json::span(splice.text, stated.get())
            && !is_true
        {
            splice.replace(span, spelling(value, format));
        }
    }
}

/// A stored number as JSON: an integer, or the shortest decimal number that is this f32.
fn spelling(value: f64, format: Format) -> String {
    if format.is_float() {
        format!("{:?}", value as f32)
    } else {
        (value as i64).to_string()
    }
}
