//! Base64 data URIs (RFC 2397) as they stand in JSON text, decoded and edited character by character.

use std::ops::Range;

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

/// As browsers decode: padding may be missing, unused bits may be set.
const FORGIVING: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// Whether a JSON string token (quotes included) holds a data URI.
pub(super) fn is_data_uri(token: &str) -> bool {
    token
        .get(..6)
        .is_some_and(|start| start.eq_ignore_ascii_case("\"data:"))
}

/// The base64 payload of a data URI: its range in the JSON string token, and the decoded bytes.
/// The error is what is wrong, in words.
pub(super) fn decode(token: &str) -> Result<(Range<usize>, Vec<u8>), String> {
    let inner = token.strip_suffix('"').unwrap_or(token);
    let (header, payload) = inner.split_once(',').ok_or("the data URI has no comma")?;
    let is_base64 = header
        .rsplit_once(';')
        .is_some_and(|(_, last)| last.eq_ignore_ascii_case("base64"));
    if !is_base64 {
        return Err("the data URI is not base64".into());
    }
    let symbols: Option<Vec<u8>> = symbols(payload).map(|symbol| Some(symbol?.0)).collect();
    let symbols = symbols.ok_or("the data URI contains a character that is not base64")?;
    let bytes = FORGIVING
        .decode(symbols)
        .map_err(|error| format!("the data URI is not base64: {error}"))?;
    let start = inner.len().saturating_sub(payload.len());
    Ok((start..inner.len(), bytes))
}

/// The payload with the symbols exchanged whose bytes differ between `original`, which the payload
/// encodes, and `patched`, which has the same length. All other characters stay as they are spelled.
pub(super) fn replace(payload: &str, original: &[u8], patched: &[u8]) -> String {
    let mut output = String::with_capacity(payload.len());
    let mut groups = original
        .chunks(3)
        .zip(patched.chunks(3))
        .map(|(old, new)| (old != new).then(|| (FORGIVING.encode(old), FORGIVING.encode(new))));
    let mut current = None;
    for (position, symbol) in symbols(payload).enumerate() {
        if position.is_multiple_of(4) {
            current = groups.next().flatten();
        }
        let Some((_, range)) = symbol else { break };
        let exchange = current.as_ref().and_then(|(old, new)| {
            let place = position.checked_rem(4)?;
            let (old, new) = (old.as_bytes().get(place)?, new.as_bytes().get(place)?);
            (old != new).then_some(*new)
        });
        match exchange {
            Some(symbol) => output.push(char::from(symbol)),
            None => output.push_str(payload.get(range).unwrap_or_default()),
        }
    }
    output
}

/// The symbols of a payload and the range that spells each: a plain character, a JSON escape
/// (`\/`, `\u002B`) or a percent escape (`%2B`). `None` for anything else.
fn symbols(payload: &str) -> impl Iterator<Item = Option<(u8, Range<usize>)>> {
    let mut position = 0_usize;
    std::iter::from_fn(move || {
        let rest = payload.get(position..)?;
        let symbol = match *rest.as_bytes().first()? {
            b'\\' => match rest.as_bytes().get(1) {
                Some(b'/') => Some((b'/', 2)),
                Some(b'u') => hexadecimal(rest, 2..6).map(|code| (code, 6)),
                _ => None,
            },
            b'%' => hexadecimal(rest, 1..3).map(|code| (code, 3)),
            byte if byte.is_ascii() => Some((byte, 1)),
            _ => None,
        };
        let Some((symbol, length)) = symbol else {
            position = payload.len();
            return Some(None);
        };
        let start = position;
        position = start.checked_add(length)?;
        Some(Some((symbol, start..position)))
    })
}

fn hexadecimal(text: &str, digits: Range<usize>) -> Option<u8> {
    let digits = text.get(digits)?;
    let plain = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    plain.then(|| u8::from_str_radix(digits, 16).ok()).flatten()
}

/// Undoes percent escapes (RFC 3986, section 2.1). A `%` that starts no escape stays, and so does a
/// text whose escapes are not UTF-8.
pub(super) fn percent_decode(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&byte, tail)) = rest.split_first() {
        let escape = (byte == b'%')
            .then(|| tail.split_at_checked(2))
            .flatten()
            .and_then(|(digits, tail)| {
                Some((hexadecimal(std::str::from_utf8(digits).ok()?, 0..2)?, tail))
            });
        let (decoded, tail) = escape.unwrap_or((byte, tail));
        bytes.push(decoded);
        rest = tail;
    }
    String::from_utf8(bytes).unwrap_or_else(|_| uri.to_owned())
}
