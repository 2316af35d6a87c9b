//! Any bytes as a plan for copies: refused, or a plan that is the same when it is stored, and that stamps or says why not.
#![no_main]

use libfuzzer_sys::fuzz_target;
use meshmark::Plan;

fuzz_target!(|bytes: &[u8]| {
    let Ok(plan) = Plan::from_bytes(bytes) else {
        return;
    };
    let stored = plan.to_bytes();
    let again = Plan::from_bytes(&stored).expect("what was stored");
    assert_eq!(again.to_bytes(), stored);
    let _ = plan.stamp(1);
});
