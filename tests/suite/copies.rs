//! Copies: what one plan gives for many numbers.

use crate::portable_test;
use crate::support::fixtures::key;
use meshmark::{
    EmbedOptions, Error, Key, Model, Payload, Plan, Strength, Verdict, demo_model, detect, prepare,
};

fn plan() -> Plan {
    let (plan, report) = prepare(&demo_model(), &key(71), &EmbedOptions::default()).unwrap();
    assert!(!report.is_fragile);
    plan
}

#[portable_test]
fn copies_are_read_back_by_anybody_with_the_key_and_have_their_numbers() {
    let (plan, key) = (plan(), key(71));
    for number in [1, 2, 999_999, (1 << 48) - 1] {
        let copy = plan.stamp(number).unwrap();
        let found = detect(&copy.model, &key, None).unwrap();
        assert_eq!(found.verdict, Verdict::Found, "{number}");
        assert_eq!(found.number, Some(copy.report.payload));
        let payload = Payload::from_number(copy.report.payload).unwrap();
        assert_eq!(payload.copy_number(&key), number);
        assert_eq!(Payload::of_copy(number, &key).unwrap(), payload);
        assert_eq!(copy.report.number, number);
        assert!(!copy.report.is_weaker, "{number}: {}", copy.report.ln_p);
        assert!(copy.report.rms_rel <= Strength::BALANCED.rms_rel());
        assert_eq!(copy.report.new_intersections, 0);
    }
}

#[portable_test]
fn a_plan_comes_back_from_its_bytes_and_makes_the_same_copies() {
    let plan = plan();
    let bytes = plan.to_bytes();
    let again = Plan::from_bytes(&bytes).unwrap();
    assert_eq!(again.to_bytes(), bytes);
    for number in [3, 4] {
        let [a, b] = [&plan, &again].map(|plan| plan.stamp(number).unwrap());
        assert_eq!(a.model, b.model);
        assert_eq!(a.report, b.report);
    }
    assert_ne!(plan.stamp(3).unwrap().model, plan.stamp(4).unwrap().model);
}

#[portable_test]
fn bytes_that_are_no_plan_are_refused() {
    let bytes = plan().to_bytes();
    let code = |bytes: &[u8]| Plan::from_bytes(bytes).map(|_| ()).unwrap_err().code();
    assert_eq!(code(b"glTF"), "plan.not-plan");
    assert_eq!(
        code(&[b"MMPL".as_slice(), &[2, 0]].concat()),
        "plan.version"
    );
    assert_eq!(code(&[&*bytes, &[0]].concat()), "plan.damaged");
    for length in (4..400).chain([bytes.len() - 1]) {
        assert_eq!(code(&bytes[..length]), "plan.damaged", "{length} bytes");
    }
    // A pitch that no embedder chooses would ask for any number of lattice points.
    let pitches = [0.05f64, 0.07, 0.1, 0.14, 0.2, 0.3].map(f64::to_le_bytes);
    let is_pitch = |window: &[u8]| pitches.iter().any(|pitch| pitch == window);
    let at = bytes.windows(8).position(is_pitch).unwrap();
    let mut forged = bytes;
    forged[at..at + 8].copy_from_slice(&1e-9f64.to_le_bytes());
    assert_eq!(code(&forged), "plan.damaged");
}

#[portable_test]
fn numbers_and_payloads_are_one_to_one_and_follow_the_key() {
    let keys: [Key; 2] = [key(1), key(2)];
    let mut seen = std::collections::BTreeSet::new();
    for number in (0..2000).chain([(1 << 24) - 1, 1 << 24, (1 << 48) - 1]) {
        let [a, b] = keys
            .each_ref()
            .map(|key| Payload::of_copy(number, key).unwrap());
        assert_eq!(a.copy_number(&keys[0]), number);
        assert_ne!(a, b);
        assert!(seen.insert(a));
    }
    assert!(Payload::of_copy(1 << 48, &keys[0]).is_err());
    // A promise: docs/FORMAT.md.
    assert_eq!(
        Payload::of_copy(1, &keys[0]).unwrap().number(),
        223_238_401_214_042
    );
    // Half of the bits differ between neighbours.
    let bits: u32 = (0..1000)
        .map(|number| {
            let [a, b] = [number, number + 1].map(|n| Payload::of_copy(n, &keys[0]).unwrap());
            (a.number() ^ b.number()).count_ones()
        })
        .sum();
    assert!((23_000..25_000).contains(&bits), "{bits}");
}

#[portable_test]
fn a_model_that_holds_no_number_has_no_copies() {
    let small =
        meshmark::internals::scene::to_glb(&meshmark::internals::mesh::shapes::asteroid(9, 12));
    let error = prepare(Model::new(&small), &key(5), &EmbedOptions::default())
        .map(|_| ())
        .unwrap_err();
    assert!(
        matches!(error, Error::NoCopies | Error::Refused { .. }),
        "{error}"
    );
}
