//! Any text as a record of an embedding: refused by name, whatever model and key it is used with.
#![no_main]

use libfuzzer_sys::fuzz_target;
use meshmark::internals::mesh::shapes;
use meshmark::internals::scene::to_glb;
use meshmark::{Key, compare_with_record};

fuzz_target!(|text: &str| {
    let suspect = to_glb(&shapes::asteroid(6, 8));
    let key = Key::from_bytes(&[1; Key::BYTES]).expect("32 bytes");
    let _ = compare_with_record(&*suspect, text, &key);
});
