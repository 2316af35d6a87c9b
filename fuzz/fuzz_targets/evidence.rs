//! Any bytes as evidence: refused, or evidence that is the same when it is stored and read again, and in which a key that marked
//! nothing finds nothing.
#![no_main]

use libfuzzer_sys::fuzz_target;
use meshmark::{Evidence, Key, Verdict, extract};

fuzz_target!(|bytes: &[u8]| {
    let Ok(evidence) = Evidence::from_bytes(bytes) else {
        return;
    };
    // Rings are accepted in any order, and stored in one.
    let stored = evidence.to_bytes();
    let again = Evidence::from_bytes(&stored);
    assert_eq!(again.map(|again| again.to_bytes()), Ok(stored));
    // No seed is marked with this key.
    let key = Key::from_bytes(&[0x5A; Key::BYTES]).expect("32 bytes");
    assert_ne!(extract(&evidence, &key).verdict, Verdict::Found);
});
