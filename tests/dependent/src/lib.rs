//! Somebody else's program for wasm32 that depends on the library: it exports what it says itself, and nothing of the library's.
//! `check.mjs` sees to that.

use meshmark::{EmbedOptions, Key, Payload, Verdict, demo_model, detect, embed};

/// 1 where a mark is found in what was marked, else 0.
#[unsafe(no_mangle)]
pub extern "C" fn marks_and_finds() -> i32 {
    i32::from(is_found().unwrap_or(false))
}

fn is_found() -> Result<bool, meshmark::Error> {
    let key = Key::from_passphrase("Ada", "correct horse battery staple")?;
    let payload = Payload::from_tag("ADA-1")?;
    let marked = embed(&demo_model(), payload, &key, &EmbedOptions::default())?;
    Ok(detect(&marked.model, &key, None)?.verdict == Verdict::Found)
}
