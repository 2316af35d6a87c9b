//! Laws of reading and writing.

use std::collections::BTreeSet;

use crate::portable_test;
use meshmark::internals::document::{Document, Files, PositionGrid, Slot};

use super::cases::{self, Case, Noise};
use super::oracle::Oracle;
use crate::support::gltf_builder::{Built, Component};

#[portable_test]
fn an_unchanged_document_is_written_byte_for_byte() {
    cases::all().iter().for_each(identity);
}

#[portable_test]
fn positions_are_what_a_second_reader_finds() {
    cases::all().iter().for_each(agreement);
}

#[portable_test]
fn new_positions_change_nothing_but_themselves_and_their_bounds() {
    let cases = cases::all();
    let num_changed = cases.iter().filter(|case| displacement(case)).count();
    assert!(
        10 * num_changed > 9 * cases.len(),
        "only {num_changed} displacements show"
    );
}

#[portable_test]
fn positions_moved_and_moved_back_leave_no_trace() {
    cases::all().iter().for_each(return_trip);
}

#[cfg(not(target_arch = "wasm32"))]
mod random {
    use super::*;
    use proptest::prelude::*;

    fn any_case() -> impl Strategy<Value = Case> {
        use proptest::sample::select;
        let storage = (
            select(&cases::PACKINGS[..]),
            any::<bool>(),
            select(&cases::STORAGES[..]),
            any::<bool>(),
        );
        let format = (select(&cases::FORMATS[..]), any::<bool>());
        let shape = (
            select(&cases::INDICES[..]),
            0_u32..7,
            3_usize..60,
            any::<u64>(),
        );
        (storage, format, shape).prop_map(
            |(
                (packing, odd, storage, interleaved),
                ((component, normalized), bounds),
                (indices, mode, num_points, seed),
            )| Case {
                packing,
                odd,
                storage,
                component,
                normalized,
                bounds,
                interleaved,
                indices,
                mode,
                num_points,
                seed,
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

        #[test]
        fn the_laws_hold_for_any_document(case in any_case()) {
            identity(&case);
            agreement(&case);
            displacement(&case);
            return_trip(&case);
        }
    }
}

fn identity(case: &Case) {
    let model = case.build();
    let mut document = read(&model);
    assert_unchanged(&document, &model, case);
    for accessor in Oracle::read(&model).position_accessors() {
        let positions = document.positions(accessor).expect("positions");
        document
            .set_positions(accessor, &positions)
            .expect("the same positions");
    }
    assert_unchanged(&document, &model, case);
}

fn agreement(case: &Case) {
    let model = case.build();
    let document = read(&model);
    let oracle = Oracle::read(&model);
    for accessor in oracle.position_accessors() {
        let expected: Vec<[f64; 3]> = oracle
            .raw(accessor)
            .into_iter()
            .map(|raw| raw.map(|raw| dequantized(case, raw)))
            .collect();
        assert_eq!(
            document.positions(accessor).expect("positions"),
            expected,
            "{case:?}"
        );
        let stored: Vec<bool> = oracle
            .places(accessor)
            .iter()
            .map(Option::is_some)
            .collect();
        let slots = document.slots(accessor).expect("slots");
        assert_eq!(
            slots.iter().map(Option::is_some).collect::<Vec<_>>(),
            stored,
            "{case:?}"
        );
        let movable: Vec<bool> = document
            .fixed_elements(accessor)
            .expect("elements")
            .iter()
            .map(|fixed| !fixed)
            .collect();
        assert_eq!(movable, stored, "{case:?}");
    }
}

/// Whether the displacement was large enough to show.
fn displacement(case: &Case) -> bool {
    let model = case.build();
    let mut document = read(&model);
    let before = Oracle::read(&model);
    let accessors = before.position_accessors();

    let requests = displace(&mut document, &accessors, case.seed);
    let written = document.write().expect("a written document");
    let mut files = model.files.clone();
    assert!(
        written.files.keys().all(|name| files.contains_key(name)),
        "{case:?}"
    );
    files.extend(written.files.clone());
    let after = Oracle::read_parts(&written.model, &files);

    // The JSON differs in bounds only, and in those of changed accessors only.
    let changed: Vec<usize> = accessors
        .iter()
        .copied()
        .filter(|&accessor| before.raw(accessor) != after.raw(accessor))
        .collect();
    assert_eq!(
        before.json_without_bounds(&changed),
        after.json_without_bounds(&changed),
        "{case:?}"
    );
    assert_eq!(
        before.text_without_bounds(),
        after.text_without_bounds(),
        "{case:?}"
    );
    assert_eq!(before.rest, after.rest, "{case:?}");

    // The buffers differ in positions only.
    let mut position_bytes = BTreeSet::new();
    for &accessor in &accessors {
        let size = 3 * before.component(accessor).size();
        for (buffer, offset) in before.places(accessor).into_iter().flatten() {
            position_bytes.extend((offset..offset + size).map(|byte| (buffer, byte)));
        }
    }
    for (buffer, (old, new)) in before.buffers.iter().zip(&after.buffers).enumerate() {
        assert_eq!(old.len(), new.len(), "{case:?}");
        for (byte, (old, new)) in old.iter().zip(new).enumerate() {
            assert!(
                old == new || position_bytes.contains(&(buffer, byte)),
                "byte {byte} of buffer {buffer} of {case:?}"
            );
        }
    }
    for (name, bytes) in &written.files {
        assert_ne!(
            bytes, &model.files[name],
            "only changed files are given out, {case:?}"
        );
    }

    // The bounds are those of the stored numbers.
    for &accessor in &changed {
        let raw = after.raw(accessor);
        for (name, pick) in [("min", f64::min as fn(f64, f64) -> f64), ("max", f64::max)] {
            let Some(stated) = after.json["accessors"][accessor][name].as_array() else {
                assert!(!case.bounds, "{case:?}");
                continue;
            };
            for (axis, stated) in stated.iter().enumerate() {
                let expected = raw
                    .iter()
                    .map(|point| point[axis])
                    .reduce(pick)
                    .expect("elements");
                let stated = stated.as_f64().expect("a number");
                let stated = if case.component == Component::F32 {
                    f64::from(stated as f32)
                } else {
                    stated
                };
                assert_eq!(stated, expected, "{name} of {case:?}");
            }
        }
    }

    // What is read back is the nearest representable value, and what this document says too.
    let reread = Document::read(&written.model, &files).expect("the written document");
    for (accessor, requested) in requests {
        let stored = reread.positions(accessor).expect("positions");
        assert_eq!(
            stored,
            document.positions(accessor).expect("positions"),
            "{case:?}"
        );
        for (stored, requested) in stored.iter().flatten().zip(requested.iter().flatten()) {
            assert_nearest(
                reread.position_grid(accessor).expect("a grid"),
                *stored,
                *requested,
                case,
            );
        }
    }
    !changed.is_empty()
}

fn return_trip(case: &Case) {
    let model = case.build();
    let mut document = read(&model);
    let accessors = Oracle::read(&model).position_accessors();
    let originals: Vec<_> = accessors
        .iter()
        .map(|&accessor| document.positions(accessor).expect("positions"))
        .collect();
    displace(&mut document, &accessors, case.seed);
    for (&accessor, original) in accessors.iter().zip(&originals) {
        document
            .set_positions(accessor, original)
            .expect("the original positions");
    }
    for (&accessor, original) in accessors.iter().zip(&originals) {
        assert_eq!(
            &document.positions(accessor).expect("positions"),
            original,
            "{case:?}"
        );
    }
    // A normalized -1 has two spellings, of which only one can come back.
    let has_double = case.normalized && matches!(case.component, Component::I8 | Component::I16);
    if !has_double {
        assert_unchanged(&document, &model, case);
    }
}

/// Moves every position that can be moved, each stored one once, and gives what was asked for.
fn displace(
    document: &mut Document,
    accessors: &[usize],
    seed: u64,
) -> Vec<(usize, Vec<[f64; 3]>)> {
    let mut noise = Noise(seed ^ 0x5eed);
    let mut moved: BTreeSet<Slot> = BTreeSet::new();
    let mut requests = Vec::new();
    for &accessor in accessors {
        let amplitude = match document.position_grid(accessor).expect("a grid") {
            PositionGrid::Float32 => 1e-3,
            PositionGrid::Integer { step, .. } => 3.0 * step,
        };
        let fixed = document.fixed_elements(accessor).expect("elements");
        let slots = document.slots(accessor).expect("slots");
        let mut positions = document.positions(accessor).expect("positions");
        for (position, (fixed, slot)) in positions.iter_mut().zip(fixed.into_iter().zip(slots)) {
            if !fixed && slot.is_some_and(|slot| moved.insert(slot)) {
                *position =
                    position.map(|component| component + amplitude * (2.0 * noise.next() - 1.0));
            }
        }
        document
            .set_positions(accessor, &positions)
            .expect("movable positions");
        requests.push((accessor, positions));
    }
    requests
}

fn assert_nearest(grid: PositionGrid, stored: f64, requested: f64, case: &Case) {
    match grid {
        PositionGrid::Float32 => assert_eq!(stored, f64::from(requested as f32), "{case:?}"),
        PositionGrid::Integer { step, min, max } => {
            assert!((min..=max).contains(&stored), "{stored} of {case:?}");
            let distance = (stored - requested.clamp(min, max)).abs();
            assert!(
                distance <= 0.5 * step * (1.0 + 1e-9),
                "{stored} for {requested} of {case:?}"
            );
        }
    }
}

fn dequantized(case: &Case, raw: f64) -> f64 {
    match case.component {
        Component::I8 if case.normalized => (raw / 127.0).max(-1.0),
        Component::U8 if case.normalized => raw / 255.0,
        Component::I16 if case.normalized => (raw / 32767.0).max(-1.0),
        Component::U16 if case.normalized => raw / 65535.0,
        _ => raw,
    }
}

fn assert_unchanged(document: &Document, model: &Built, case: &Case) {
    let written = document.write().expect("a written document");
    assert!(written.model == model.bytes, "{case:?}");
    assert_eq!(written.files, Files::new(), "{case:?}");
}

fn read(model: &Built) -> Document {
    Document::read(&model.bytes, &model.files).expect("a readable document")
}
