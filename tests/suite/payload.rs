//! Tags and numbers.

use crate::portable_test;
use meshmark::{Payload, PayloadError};

#[portable_test]
fn payload_tag_and_number_are_two_spellings() {
    for (tag, number) in [
        ("AAAAAAAA", 0),
        ("B.......", u64::MAX),
        ("A", (1 << 42) - 1),
        ("AAAAAAAB", 1),
    ] {
        match Payload::from_tag(tag) {
            Ok(payload) => {
                assert_eq!(payload.number(), number, "{tag}");
                assert_eq!(Payload::from_number(number), Ok(payload));
                assert_eq!(payload.tag().as_deref(), Some(tag));
            }
            Err(error) => assert_eq!((number, error), (u64::MAX, PayloadError::TrailingDot)),
        }
    }
}

#[portable_test]
fn payload_tags_come_back() {
    for tag in ["a", "Z9", "x-.y", "ADA-1", "12345678", "......-"] {
        assert_eq!(Payload::from_tag(tag).unwrap().tag().as_deref(), Some(tag));
    }
}

#[portable_test]
fn payload_the_last_number_has_no_tag() {
    let last = (1 << Payload::BITS) - 1;
    assert_eq!(Payload::from_number(last).unwrap().tag(), None);
    assert_eq!(Payload::from_number(last + 1), Err(PayloadError::Range));
}

#[portable_test]
fn payload_refuses_other_tags_by_name() {
    for (tag, code) in [
        ("", "payload.length"),
        ("123456789", "payload.length"),
        ("é", "payload.character"),
        ("a b", "payload.character"),
        ("a.", "payload.trailing-dot"),
    ] {
        assert_eq!(Payload::from_tag(tag).unwrap_err().code(), code, "{tag:?}");
    }
}
