//! Evidence as bytes.

use crate::portable_test;
use crate::support::fixtures::asteroid;
use meshmark::Evidence;

#[portable_test]
fn evidence_is_its_bytes() {
    let evidence = Evidence::of_mesh(&asteroid());
    assert_eq!(Evidence::from_bytes(&evidence.to_bytes()), Ok(evidence));
}

#[portable_test]
fn evidence_refuses_what_is_none_by_name() {
    let bytes = Evidence::of_mesh(&asteroid()).to_bytes();
    let with = |offset: usize, value: u8| {
        let mut bytes = bytes.clone();
        bytes[offset] = value;
        bytes
    };
    for (bytes, code) in [
        (vec![], "evidence.not-evidence"),
        (b"glTF".to_vec(), "evidence.not-evidence"),
        (with(4, 9), "evidence.version"),
        (with(6, b'X'), "evidence.damaged"),
        (with(10, 0xff), "evidence.damaged"),
        (bytes[..bytes.len() - 1].to_vec(), "evidence.damaged"),
        ([bytes.as_slice(), &[0]].concat(), "evidence.damaged"),
        (bytes[..5].to_vec(), "evidence.damaged"),
        // An offset that is no number.
        (
            [
                &bytes[..14 + 22],
                &f32::NAN.to_le_bytes(),
                &bytes[14 + 26..],
            ]
            .concat(),
            "evidence.impossible",
        ),
    ] {
        assert_eq!(
            Evidence::from_bytes(&bytes).map(drop).unwrap_err().code(),
            code
        );
    }
}
