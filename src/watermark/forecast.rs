//! What a mark is likely to survive: tried on the marked model itself.

use super::extract::Reader;
use super::{Extraction, Verdict};
use crate::attack::{crop, noise, quantize_evenly, simplify, smooth};
use crate::bits::Payload;
use crate::carrier::{Reading, ring, solid};
use crate::detection::LN_P_FOUND;
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress, Stage, step};
use serde::Serialize;

/// How a mark is likely to stand an attack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// It is found with a wide margin: twice the exponent that is needed.
    Green,
    /// It is found, barely.
    Amber,
    /// It is not found.
    Red,
}

/// One attack, and what was left of the mark after it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Forecast {
    /// Which attack: a name of [`forecast`]'s list.
    pub attack: &'static str,
    /// What is likely.
    pub level: Level,
    /// Natural logarithm of the bound that the mark reached.
    pub ln_p: f64,
}

/// An attack as a function of a mesh.
type Attack = fn(&Mesh) -> Mesh;

/// One attack of a kind stands for its kind; seeds are fixed, so that the same model has the same forecast.
const ATTACKS: [(&str, Attack); 7] = [
    ("none", Mesh::clone),
    ("noise", |mesh| noise(mesh, 0.001, 1)),
    ("quantize", |mesh| quantize_evenly(mesh, 11)),
    ("smooth", |mesh| smooth(mesh, 0.1, 10)),
    ("simplify-30", |mesh| simplify(mesh, 0.3)),
    ("simplify-70", |mesh| simplify(mesh, 0.7)),
    ("crop", |mesh| crop(mesh, 0.3, 1)),
];

/// Attacks a marked mesh, and looks for the mark in what is left: with less patience than a detector, so it says red rather
/// too often than too rarely.
pub(super) fn forecast(
    host: &Mesh,
    marked: &Mesh,
    key: &Key,
    payload: Payload,
    progress: &mut dyn Progress,
) -> Result<Vec<Forecast>, Cancelled> {
    let host = solid::Surfaces::new(host);
    let reader = Reader::new(key, None);
    let mut forecasts = Vec::new();
    for (number, (name, attack)) in ATTACKS.into_iter().enumerate() {
        let done = number as f64 / ATTACKS.len() as f64;
        step(progress, Stage::Forecast, done)?;
        let suspect = attack(marked);
        let patience = if name == "smooth" {
            solid::FIRST_FAMILY
        } else {
            1
        };
        let surfaces = solid::Surfaces::new(&suspect).facing(&host);
        let solid = surfaces.read(patience, key, &mut |_, _| {
            progress.report(Stage::Forecast, done)
        })?;
        let mut found = reader.conclude(&solid, &Reading::default());
        if level(&found, payload) != Level::Green {
            found = reader.conclude(&solid, &ring::Measurement::new(&suspect).read(key));
        }
        forecasts.push(Forecast {
            attack: name,
            level: level(&found, payload),
            ln_p: found.ln_p,
        });
    }
    step(progress, Stage::Forecast, 1.0)?;
    Ok(forecasts)
}

fn level(found: &Extraction, payload: Payload) -> Level {
    let is_right = found.verdict == Verdict::Found && found.number == Some(payload.number());
    match found.ln_p {
        ln_p if is_right && ln_p <= 2.0 * LN_P_FOUND => Level::Green,
        _ if is_right => Level::Amber,
        _ => Level::Red,
    }
}
