//! What a mark is likely to survive: tried on the marked model itself.

use super::judge::Judge;
use super::read_back::is_read;
use super::report::{CarrierReading, Extraction, Forecast, Input, Level};
use crate::attack::{Attack, CROP, NOISE, QUANTIZE_EVENLY, SIMPLIFY, SMOOTH, Step};
use crate::bits::Payload;
use crate::carrier::{Carrier, KnownHost, Reading};
use crate::detection::LN_P_FOUND;
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress, Stage, step};

/// One attack of a kind stands for its kind, each by its name in reports: an attack of the catalogue, and how much of it.
const ATTACKS: [(&str, Step); 8] = [
    (WEB, of(&QUANTIZE_EVENLY, 13.0)),
    ("noise", of(&NOISE, 0.1)),
    ("quantize", of(&QUANTIZE_EVENLY, 11.0)),
    ("smooth", of(&SMOOTH, 10.0)),
    ("simplify-30", of(&SIMPLIFY, 30.0)),
    ("simplify-50", of(&SIMPLIFY, 50.0)),
    ("simplify-70", of(&SIMPLIFY, 70.0)),
    ("crop", of(&CROP, 30.0)),
];

/// What programs for the web do by default: 14 bits, of which one is the sign.
const WEB: &str = "web";

/// Rows that stand for programs that differ much: some leave less of the same triangles than this project's simplifier. Where a shape has no
/// axes of its own, or the mark is read in one object of several, no margin is wide enough. Else it has to be four times that of other rows:
/// the widest with which a mark was lost after half of the triangles had an exponent of 137, and the next that was seen, 181, was found;
/// eight times what is needed is 166 (docs/FORECAST.md). Without 30 % of the triangles this was not measured.
const SIMPLIFIED: [&str; 2] = ["simplify-50", "simplify-70"];

/// Of the exponent that is needed, so many times are a wide margin.
const WIDE: f64 = 2.0;
const WIDE_IF_SIMPLIFIED: f64 = 8.0;

/// The same model has the same forecast.
const SEED: u64 = 1;

const fn of(attack: &'static Attack, level: f64) -> Step {
    Step { attack, level }
}

/// What a marked model's mark is without an attack, as it was read back; then attacks the marked mesh, and looks for the mark in what
/// is left: with less patience than a detector, so it says red rather too often than too rarely.
pub(super) fn forecast(
    host: &Mesh,
    marked: &Mesh,
    read_back: &Extraction,
    key: &Key,
    payload: Option<Payload>,
    progress: &mut dyn Progress,
) -> Result<Vec<Forecast>, Cancelled> {
    let is_in_piece = |carrier: &CarrierReading| carrier.piece.is_some();
    let in_pieces = read_back.details().carriers.iter().any(is_in_piece);
    let is_steady = Carrier::has_axes(host) && !in_pieces;
    let host = KnownHost::new(host, in_pieces);
    let judge = Judge::new(key, None, Input::Model);
    let wide = |attack| match SIMPLIFIED.contains(&attack) {
        true if is_steady => WIDE_IF_SIMPLIFIED,
        true => f64::INFINITY,
        false => WIDE,
    };
    let forecast = |attack, found: &Extraction| Forecast {
        attack,
        level: level(found, payload, wide(attack)),
        ln_p: found.details().ln_p,
    };
    let mut forecasts = vec![forecast("none", read_back)];
    for (number, (name, attack)) in ATTACKS.into_iter().enumerate() {
        let done = number as f64 / ATTACKS.len() as f64;
        step(progress, Stage::Forecast, done)?;
        let suspect = attack.apply(marked, SEED);
        let mut report = |_, _| progress.report(Stage::Forecast, done);
        let is_smoothed = name == "smooth";
        // Mostly the first carrier says all: the others are asked only where it does not.
        let mut readings = Carrier::STANDARD.map(|_| Default::default());
        let mut found = judge.conclude(&readings);
        for carrier in Carrier::STANDARD {
            let is_settled = |reading: &Reading| judge.is_settled(reading);
            let reading =
                carrier.read_copy(&suspect, &host, is_smoothed, key, &is_settled, &mut report)?;
            readings[carrier as usize] = reading;
            found = judge.conclude(&readings);
            if level(&found, payload, wide(name)) == Level::Green {
                break;
            }
        }
        forecasts.push(forecast(name, &found));
    }
    step(progress, Stage::Forecast, 1.0)?;
    Ok(forecasts)
}

/// Whether the usual steps of a web pipeline take a mark.
pub(super) fn is_fragile(forecast: &[Forecast]) -> bool {
    let taken = |row: &Forecast| row.attack == WEB && row.level == Level::Red;
    forecast.iter().any(taken)
}

/// What is likely, where so many times the exponent that is needed are a wide margin.
fn level(found: &Extraction, payload: Option<Payload>, wide: f64) -> Level {
    let is_right = is_read(found, payload);
    match found.details().ln_p {
        ln_p if is_right && ln_p <= wide * LN_P_FOUND => Level::Green,
        _ if is_right => Level::Amber,
        _ => Level::Red,
    }
}
