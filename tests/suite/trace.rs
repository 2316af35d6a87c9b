//! Tracing: who is named, and that nobody else is.

use crate::portable_test;
use crate::support::fixtures::{asteroid, key};
use glam::DVec3;
use meshmark::internals::attack::{crop, quantize, similarity, simplify};
use meshmark::internals::code::{Checked, Codeword, Likeness, SoftSymbol, Symbol};
use meshmark::internals::document::Document;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{
    EmbedOptions, Error, Files, Payload, Plan, RecordOptions, Shape, Surface, Traced, Tracing,
    Verdict, demo_model, measure, prepare, record, trace, trace_evidence, trace_overlaid,
    trace_overlaid_with_record,
};

fn plan() -> Plan {
    prepare(&demo_model(), &key(72), &EmbedOptions::default())
        .unwrap()
        .0
}

fn mesh(model: &[u8]) -> Mesh {
    let document = Document::read(model, &Files::new()).unwrap();
    Scene::gather(&document).unwrap().mesh
}

/// What several buyers made of their copies.
fn mixed(plan: &Plan, numbers: &[u64], mix: fn(&[DVec3], usize) -> DVec3) -> Mesh {
    let copies = numbers.iter().map(|&n| mesh(&plan.stamp(n).unwrap().model));
    let copies: Vec<Mesh> = copies.collect();
    let positions = (0..copies[0].positions.len()).map(|vertex| {
        let all: Vec<DVec3> = copies.iter().map(|copy| copy.positions[vertex]).collect();
        mix(&all, vertex)
    });
    copies[0].with_positions(positions.collect())
}

fn average(all: &[DVec3], _: usize) -> DVec3 {
    all.iter().sum::<DVec3>() / all.len() as f64
}

fn alternate(all: &[DVec3], vertex: usize) -> DVec3 {
    all[vertex % all.len()]
}

fn traced(mesh: &Mesh, numbers: &[u64]) -> Tracing {
    let positions: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    trace(Surface::new(&positions, &mesh.triangles), &key(72), numbers).unwrap()
}

fn named(tracing: &Tracing) -> Vec<u64> {
    let mut named: Vec<u64> = tracing.buyers.iter().map(|buyer| buyer.number).collect();
    named.sort_unstable();
    named
}

#[portable_test]
fn who_leaks_a_copy_is_named_and_nobody_else() {
    let plan = plan();
    let ledger: Vec<u64> = (1..=1000).collect();
    let copy = plan.stamp(17).unwrap();
    let tracing = trace(&copy.model, &key(72), &ledger).unwrap();
    assert_eq!(tracing.traced, Traced::Named);
    assert_eq!(named(&tracing), [17]);
    assert_eq!(tracing.num_buyers, 1000);
    // No bound is below one message of all, charged.
    let least = -60.0 * std::f64::consts::LN_2 + tracing.ln_charge;
    assert!((tracing.buyers[0].ln_p - least).abs() < 1e-9);
    // Whoever is not in the ledger is not named.
    let without: Vec<u64> = ledger.iter().copied().filter(|n| *n != 17).collect();
    let tracing = trace(&copy.model, &key(72), &without).unwrap();
    assert_eq!(tracing.traced, Traced::Nobody);
    assert_eq!(named(&tracing), [0; 0]);
    // Of another key nothing is said.
    let tracing = trace(&copy.model, &key(73), &ledger).unwrap();
    assert_eq!(tracing.traced, Traced::NoMark);
    // Evidence says the same as the model.
    let evidence = measure(&copy.model).unwrap();
    let tracing = trace_evidence(&evidence, &key(72), &ledger).unwrap();
    assert_eq!(named(&tracing), [17]);
}

#[portable_test]
fn buyers_who_mix_their_copies_are_named() {
    let plan = plan();
    let ledger: Vec<u64> = (1..=1000).collect();
    for (name, numbers, mix) in [
        (
            "average",
            &[3, 8][..],
            average as fn(&[DVec3], usize) -> DVec3,
        ),
        ("alternate", &[3, 8], alternate),
        ("average of three", &[3, 8, 500], average),
    ] {
        let tracing = traced(&mixed(&plan, numbers, mix), &ledger);
        assert_eq!(named(&tracing), numbers, "{name}");
    }
}

/// A model, its plan and its record.
fn sold() -> (Vec<u8>, Plan, String) {
    let original = to_glb(&asteroid());
    let (plan, specimen) = prepare(&original, &key(72), &EmbedOptions::default()).unwrap();
    let record = record(&original, &specimen, &key(72), &RecordOptions::default()).unwrap();
    (original, plan, record)
}

/// A piece that was cut out, with other triangles, and moved.
fn piece_of(mesh: &Mesh) -> Vec<u8> {
    let piece = quantize(&simplify(&crop(mesh, 0.3, 3), 0.5), 10);
    to_glb(&similarity(&piece, 4))
}

#[portable_test]
fn with_the_original_or_the_record_who_leaks_a_piece_is_named() {
    let (original, plan, record) = sold();
    let (key, ledger) = (key(72), (1..=1000).collect::<Vec<u64>>());
    let piece = piece_of(&mesh(&plan.stamp(17).unwrap().model));
    let blind = trace(&piece, &key, &ledger).unwrap();
    assert_eq!(named(&blind), [0; 0]);
    assert_eq!(blind.comparison, None);
    let (tracing, overlay) = trace_overlaid(&piece, &original, &key, &ledger).unwrap();
    assert_eq!(named(&tracing), [17]);
    assert_eq!(tracing.traced, Traced::Named);
    let comparison = tracing.comparison.unwrap();
    assert_eq!(
        (comparison.shape, comparison.verdict),
        (Shape::Same, Verdict::Found)
    );
    assert!(overlay.is_some_and(|overlay| !overlay.is_recorded));
    let (tracing, overlay) = trace_overlaid_with_record(&piece, &record, &key, &ledger).unwrap();
    assert_eq!(named(&tracing), [17]);
    assert!(overlay.is_some_and(|overlay| overlay.is_recorded));
    // Whoever is not in the ledger is not named, and the mark is there all the same.
    let without: Vec<u64> = ledger.iter().copied().filter(|n| *n != 17).collect();
    let (tracing, _) = trace_overlaid(&piece, &original, &key, &without).unwrap();
    assert_eq!(named(&tracing), [0; 0]);
    assert_eq!(tracing.traced, Traced::Nobody);
}

#[portable_test]
fn with_the_original_who_average_and_cut_are_named() {
    let (original, plan, _) = sold();
    let (key, ledger) = (key(72), (1..=1000).collect::<Vec<u64>>());
    let piece = piece_of(&mixed(&plan, &[3, 8], average));
    assert_eq!(named(&trace(&piece, &key, &ledger).unwrap()), [0; 0]);
    let (tracing, _) = trace_overlaid(&piece, &original, &key, &ledger).unwrap();
    assert_eq!(named(&tracing), [3, 8]);
}

#[portable_test]
fn with_the_original_nobody_is_named_in_what_is_no_copy() {
    let (original, plan, record) = sold();
    let ledger: Vec<u64> = (1..=1000).collect();
    // The original itself, and a copy with another key.
    let copy = plan.stamp(17).unwrap().model;
    for (suspect, number) in [(&original, 72), (&copy, 73)] {
        let (tracing, _) = trace_overlaid(suspect, &original, &key(number), &ledger).unwrap();
        assert_eq!(named(&tracing), [0; 0]);
        assert_eq!(tracing.traced, Traced::NoMark);
        let comparison = tracing.comparison.unwrap();
        assert_eq!(comparison.shape, Shape::Same);
        assert_eq!(tracing.sentence, comparison.sentence);
    }
    let refused = trace_overlaid_with_record(&copy, &record, &key(73), &ledger);
    assert!(matches!(refused, Err(Error::Record(_))));
}

#[portable_test]
fn numbers_that_are_none_are_refused_and_repetitions_cost_nothing() {
    let model = demo_model();
    assert!(matches!(
        trace(&model, &key(1), &[1 << 48]),
        Err(Error::Payload(_))
    ));
    let tracing = trace(&model, &key(1), &[4, 4, 4]).unwrap();
    assert_eq!(tracing.num_buyers, 1);
    assert_eq!(tracing.traced, Traced::NoMark);
    assert_eq!(trace(&model, &key(1), &[]).unwrap().traced, Traced::NoMark);
}

/// The bound against what chance gives: of many messages that had no part, no larger share is below a probability than that.
#[portable_test]
fn the_bound_holds_for_messages_that_had_no_part() {
    let key = key(9);
    let (check, prf) = (Checked::new(&key), key.prf("test"));
    let guilty = Payload::of_copy(1, &key).unwrap();
    let guilty = Codeword::new(check.message(guilty));
    let symbols: Vec<SoftSymbol> = (0..250)
        .map(|address| {
            let (choice, noise) = prf.at(address);
            let symbol = Symbol::select(choice);
            let noise = meshmark::internals::key::unit(noise) - 0.5;
            let value = (guilty.sign(symbol) * 0.4 + 2.0 * noise).clamp(-1.0, 1.0);
            SoftSymbol {
                symbol,
                value,
                weight: 1.0,
            }
        })
        .collect();
    let likeness = Likeness::new(&symbols);
    assert!(likeness.ln_p(&guilty) < -15.0, "{}", likeness.ln_p(&guilty));
    let bounds: Vec<f64> = (0..100_000)
        .map(|number| {
            let payload = Payload::of_copy(1000 + number, &key).unwrap();
            likeness.ln_p(&Codeword::new(check.message(payload)))
        })
        .collect();
    for ln_p in [-1.0, -2.0, -4.0, -6.0, -8.0] {
        let share = bounds.iter().filter(|bound| **bound <= ln_p).count() as f64 / 1e5;
        assert!(share <= libm::exp(ln_p), "{share} of {ln_p}");
    }
    // It is not far from the truth either: a bound that is never reached says nothing.
    let share = bounds.iter().filter(|bound| **bound <= -4.0).count() as f64 / 1e5;
    assert!(share > 0.02 * libm::exp(-4.0), "{share}");
}
