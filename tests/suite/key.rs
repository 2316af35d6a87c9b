//! Keys: the format's derivation, and its laws. The primitives' own vectors are for their crates to test.

use crate::portable_test;
use meshmark::Key;

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// In wasm it is the JavaScript engine that normalizes, on the way in: the package's tests hold it to the same.
#[cfg(not(target_arch = "wasm32"))]
#[test]
fn key_is_the_same_however_the_words_are_typed() {
    let composed = Key::from_passphrase("Zo\u{eb}", "caf\u{e9} \u{ff11}").unwrap();
    let decomposed = Key::from_passphrase(" Zoe\u{308} ", "cafe\u{301} 1").unwrap();
    assert_eq!(composed.to_bytes(), decomposed.to_bytes());
    let other_case = Key::from_passphrase("zo\u{eb}", "caf\u{e9} 1").unwrap();
    assert_ne!(composed.to_bytes(), other_case.to_bytes());
}

/// What docs/FORMAT.md promises: a change here orphans every mark that was ever made.
#[portable_test]
fn key_derivation_never_changes() {
    let key = Key::from_passphrase("Ada", "correct horse battery staple").unwrap();
    assert_eq!(
        hex(&*key.to_bytes()),
        "1e880652b5b6d7b3009828ff54ee8de813fb064b83b8b4311e9721e4505dd825"
    );
    assert_eq!(
        key.prf("ring").at(1),
        (0xcc83cd55b306151a, 0x8a89a23c5c1c991d)
    );
}

/// The same of a work's key.
#[portable_test]
fn key_of_a_work_never_changes() {
    let key = Key::from_bytes(&[7; Key::BYTES]).unwrap();
    let work = |title| hex(&*key.for_work(title).unwrap().to_bytes());
    assert_eq!(
        work("Rock"),
        "f1d19ad4a13a2489f4518e1e0087e2d9076a7449e05b535c2af5c25bcf55d104"
    );
    assert_eq!(work(" Rock\u{a0}"), work("Rock"));
    assert_eq!(work("Zoe\u{308}"), work("Zo\u{eb}"));
    assert_ne!(work("rock"), work("Rock"));
    let error = key.for_work(" ").unwrap_err();
    assert_eq!(error.code(), "key.empty-work");
}

#[portable_test]
fn key_sub_keys_differ_by_label_and_by_key() {
    let [a, b] = [[1; 32], [2; 32]].map(|bytes| Key::from_bytes(&bytes).unwrap());
    assert_ne!(a.prf("x").at(0), a.prf("y").at(0));
    assert_ne!(a.prf("x").at(0), b.prf("x").at(0));
    assert_eq!(a.prf("x").at(0), a.clone().prf("x").at(0));
}

#[portable_test]
fn key_refuses_what_is_no_secret() {
    assert_eq!(
        Key::from_passphrase(" \t", "p").unwrap_err().code(),
        "key.empty-owner"
    );
    assert_eq!(
        Key::from_passphrase("o", "").unwrap_err().code(),
        "key.empty-passphrase"
    );
    assert_eq!(Key::from_bytes(&[0; 31]).unwrap_err().code(), "key.length");
}

#[portable_test]
fn key_is_never_shown() {
    assert_eq!(
        format!("{:?}", Key::from_bytes(&[7; 32]).unwrap()),
        "Key(..)"
    );
}
