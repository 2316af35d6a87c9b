//! The numbers in `min` and `max` of accessors, kept true to the data.

use std::ops::Range;

use serde_json::value::RawValue;

use super::accessor::{Accessor, Format};
use super::buffer::Storage;
use super::region::Slot;
use super::schema;

/// A range of the JSON text and what replaces it.
pub(super) type Edit = (Range<usize>, String);

/// The edits that make `min` and `max` of an accessor true, if any of its elements changed. Bounds
/// are of numbers as they are stored, before normalization (glTF 2.0 specification section 3.6.2.5).
/// Numbers that are right already keep their spelling, and so do the bounds of data that is not finite.
pub(super) fn edits(
    accessor: &Accessor,
    slots: &[Option<Slot>],
    storages: &[Storage],
    text: &str,
) -> Vec<Edit> {
    let size = accessor.format.position_size();
    let has_changed = |slot: &Slot| {
        storages
            .get(slot.storage)
            .is_some_and(|storage| storage.has_changed(slot.offset, size))
    };
    if !slots.iter().flatten().any(has_changed) {
        return Vec::new();
    }
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
    let mut edits = Vec::new();
    for (span, values) in accessor.bounds.iter().zip(bounds) {
        if let Some(span) = span
            && values.iter().all(|value| value.is_finite())
        {
            edits.extend(bound_edits(text, span, values, accessor.format));
        }
    }
    edits
}

/// The edits that turn the bound at `span` into `values`.
fn bound_edits(text: &str, span: &Range<usize>, values: [f64; 3], format: Format) -> Vec<Edit> {
    let spelling = |value: f64| {
        if format.is_float() {
            // The shortest decimal number that is this f32; it is finite.
            serde_json::to_string(&(value as f32)).unwrap_or_default()
        } else {
            (value as i64).to_string()
        }
    };
    let stated = text.get(span.clone()).unwrap_or_default();
    let Ok(components) = serde_json::from_str::<[&RawValue; 3]>(stated) else {
        return vec![(
            span.clone(),
            format!("[{}]", values.map(spelling).join(",")),
        )];
    };
    let edit = |(component, value): (&RawValue, f64)| {
        let stated = component.get().parse::<f64>().ok();
        let is_true = stated.is_some_and(|stated| {
            if format.is_float() {
                stated as f32 == value as f32
            } else {
                stated == value
            }
        });
        (!is_true).then_some((schema::span(text, component.get())?, spelling(value)))
    };
    components
        .into_iter()
        .zip(values)
        .filter_map(edit)
        .collect()
}

/// The text with the edits made, which do not overlap.
pub(super) fn splice(text: &str, mut edits: Vec<Edit>) -> String {
    edits.sort_unstable_by_key(|(range, _)| range.start);
    let mut output = String::with_capacity(text.len());
    let mut position = 0;
    for (range, replacement) in edits {
        output.push_str(text.get(position..range.start).unwrap_or_default());
        output.push_str(&replacement);
        position = range.end;
    }
    output.push_str(text.get(position..).unwrap_or_default());
    output
}
