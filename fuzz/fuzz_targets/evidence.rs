//! Any bytes as evidence: refused, or the same bytes again and an answer that a key which marked nothing must not have.
#![no_main]

use libfuzzer_sys::fuzz_target;
use meshmark::{Evidence, Key, Verdict, extract};

fuzz_target!(|bytes: &[u8]| {
    let Ok(evidence) = Evidence::from_bytes(bytes) else {
        return;
    };
    assert_eq!(evidence.to_bytes(), bytes);
    // No seed is marked with this key. The fuzzer sees the dithers as the code compares with them, so that it is not found is no
    // proof of the bound; that it is found would be a gift.
    let key = Key::from_bytes(&[0x5A; Key::BYTES]).expect("32 bytes");
    assert_ne!(extract(&evidence, &key).verdict, Verdict::Found);
});
