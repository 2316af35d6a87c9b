//! docs/VECTORS.md: what another implementation is checked against. Each line is computed here, and has to be there.

use crate::golden::{HOST_RINGS, HOST_SECTORS};
use crate::portable_test;
use crate::support::fixtures::{key, payload};
use meshmark::internals::carrier::{ring, solid};
use meshmark::internals::code::{Checked, Codeword, Numbers, Symbol};
use meshmark::internals::digest::sha256;
use meshmark::internals::document::Document;
use meshmark::internals::key::unit;
use meshmark::internals::mesh::shapes;
use meshmark::internals::progress::ignore;
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{EmbedOptions, Files, Key, Strength, embed};

const VECTORS: &str = include_str!("../../docs/VECTORS.md");

/// Says all that is missing at once.
fn are_there(lines: &[String]) {
    let is_missing = |line: &&String| !VECTORS.lines().any(|other| other == *line);
    let missing: Vec<&str> = lines
        .iter()
        .filter(is_missing)
        .map(String::as_str)
        .collect();
    assert!(
        missing.is_empty(),
        "docs/VECTORS.md lacks
{}",
        missing.join(
            "
"
        )
    );
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn said(symbol: Symbol) -> String {
    match symbol {
        Symbol::Pilot => "pilot".to_owned(),
        Symbol::Parity { step, taps } => format!("step {step}, taps {taps:09b}"),
    }
}

#[portable_test]
fn vectors_of_keys() {
    let mut lines = Vec::new();
    let words = Key::from_normalized("Ada", "correct horse battery staple").unwrap();
    lines.push(format!(
        "| key of owner `Ada`, passphrase `correct horse battery staple` | `{}` |",
        hex(&*words.to_bytes())
    ));
    let key = key(1);
    let work = key.for_normalized_work("Rock").unwrap();
    lines.push(format!(
        "| key of the work `Rock` | `{}` |",
        hex(&*work.to_bytes())
    ));
    lines.push(format!("| commitment | `{}` |", key.commitment()));
    for label in ["ring", "solid", "solid/lattice"] {
        let (first, second) = key.prf(label).at(1);
        let dither = unit(first);
        lines.push(format!(
            "| PRF `{label}` at 1 | `{first:016x}` `{second:016x}`, dither {dither:?} |"
        ));
    }
    are_there(&lines);
}

#[portable_test]
fn vectors_of_messages() {
    let mut lines = Vec::new();
    let message = Checked::new(&key(1)).message(payload());
    lines.push(format!(
        "| payload of the tag `ADA-1` | `{:012x}` |",
        payload().number()
    ));
    lines.push(format!("| its message | `{message:015x}` |"));
    let codeword = Codeword::new(message);
    for random in [0, 1, 0x0123_4567_89ab_cdee, u64::MAX - 1] {
        let symbol = Symbol::select(random);
        let sign = codeword.sign(symbol);
        lines.push(format!(
            "| symbol selected by `{random:016x}` | {}; sign {sign:+} |",
            said(symbol)
        ));
    }
    let numbers = Numbers::new(&key(1));
    for number in [0, 1, 1_000_000] {
        let payload = numbers.payload(number).unwrap().number();
        lines.push(format!("| payload of copy {number} | `{payload:012x}` |"));
    }
    are_there(&lines);
}

#[portable_test]
fn vectors_of_a_mark() {
    let mut lines = Vec::new();
    let host = to_glb(&shapes::asteroid(HOST_RINGS, HOST_SECTORS));
    lines.push(format!("| SHA-256 of the host | `{}` |", sha256(&host)));
    let options = EmbedOptions::default().with_strength(Strength::STRONG);
    let marked = embed(&host, payload(), &key(1), &options).unwrap().model;
    lines.push(format!(
        "| SHA-256 of the marked model | `{}` |",
        sha256(&marked)
    ));
    let document = Document::read(&marked, &Files::new()).unwrap();
    let mesh = Scene::gather(&document).unwrap().mesh;
    let prf = key(1).prf("ring");
    let owned = ring::rings(&mesh).into_iter().filter_map(|ring| {
        let (dither, choice) = prf.at(ring.by_connectivity);
        (choice % ring::SHARE == 0)
            .then(|| (ring, unit(dither), Symbol::select(choice / ring::SHARE)))
    });
    for (ring, dither, symbol) in owned.take(4) {
        lines.push(format!(
            "| {} | {:.9} | `{:016x}` | {dither:.9} | {} |",
            ring.vertex,
            ring.offset,
            ring.by_connectivity,
            said(symbol)
        ));
    }
    let plain: solid::Measurement = solid::Surfaces::new(&mesh).plain().collect();
    let reading = plain.read(&key(1), &mut ignore).unwrap();
    for soft in reading.hypotheses[0].symbols.iter().take(6) {
        lines.push(format!(
            "| {} | {:+.6} | {:.6} |",
            said(soft.symbol),
            soft.value,
            soft.weight
        ));
    }
    are_there(&lines);
}
