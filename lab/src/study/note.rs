//! The notes of the study.

use crate::seed::Seed;
use meshmark::Key;

/// What a detector says.
#[derive(Clone, Copy)]
pub struct Read {
    pub is_right: bool,
    pub ln_p: f64,
}

/// A note that any model of the study has room for.
pub fn text(seed: &Seed, purpose: &str) -> String {
    let number = seed.number(&format!("{purpose}, text"), 0);
    let letter = |place: u32| char::from(b'a' + ((number >> (5 * place)) % 26) as u8);
    (0..5).map(letter).collect()
}

pub fn read_note(bytes: &[u8], key: &Key, text: &str) -> Result<Read, String> {
    let read = meshmark::read_note(bytes, key).map_err(|error| error.to_string())?;
    Ok(Read {
        is_right: read.text.as_deref() == Some(text),
        ln_p: read.ln_p,
    })
}
