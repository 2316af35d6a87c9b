//! What a mark is likely to survive: tried on the marked model itself.

use super::judge::Judge;
use super::{Extraction, Input, Verdict};
use crate::attack::{crop, noise, quantize_evenly, simplify_on, smooth};
use crate::bits::Payload;
use crate::carrier::{Carrier, KnownHost};
use crate::detection::LN_P_FOUND;
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress, Stage, step};
use serde::Serialize;

/// How a mark is likely to stand an attack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
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
#[non_exhaustive]
pub struct Forecast {
    /// Which attack: `none`, `noise`, `quantize`, `smooth`, `simplify-30`, `simplify-70` or `crop`.
    pub attack: &'static str,
    /// What is likely.
    pub level: Level,
    /// Natural logarithm of the bound that the mark reached.
    pub ln_p: f64,
}

/// An attack as a function of a mesh, which may leave several copies.
type Attack = fn(&Mesh) -> Vec<Mesh>;

/// One attack of a kind stands for its kind; seeds are fixed, so that the same model has the same forecast. Each copy has a name.
const ATTACKS: [(&[&str], Attack); 5] = [
    (&["noise"], |mesh| vec![noise(mesh, 0.001, 1)]),
    (&["quantize"], |mesh| vec![quantize_evenly(mesh, 11)]),
    (&["smooth"], |mesh| vec![smooth(mesh, 0.1, 10)]),
    (&["simplify-30", "simplify-70"], |mesh| {
        simplify_on(mesh, &[0.3, 0.7])
    }),
    (&["crop"], |mesh| vec![crop(mesh, 0.3, 1)]),
];

/// What a marked model's mark is without an attack, as it was read back; then attacks the marked mesh, and looks for the mark in what
/// is left: with less patience than a detector, so it says red rather too often than too rarely.
pub(super) fn forecast(
    host: &Mesh,
    marked: &Mesh,
    read_back: &Extraction,
    key: &Key,
    payload: Payload,
    progress: &mut dyn Progress,
) -> Result<Vec<Forecast>, Cancelled> {
    let host = KnownHost::new(host);
    let judge = Judge::new(key, None, Input::Model);
    let forecast = |attack, found: &Extraction| Forecast {
        attack,
        level: level(found, payload),
        ln_p: found.details().ln_p,
    };
    let mut forecasts = vec![forecast("none", read_back)];
    let num_names: usize = ATTACKS.iter().map(|(names, _)| names.len()).sum();
    for (names, attack) in ATTACKS {
        for (&name, suspect) in names.iter().zip(attack(marked)) {
            let done = (forecasts.len() - 1) as f64 / num_names as f64;
            step(progress, Stage::Forecast, done)?;
            let mut report = |_, _| progress.report(Stage::Forecast, done);
            let is_smoothed = name == "smooth";
            // Mostly the first carrier says all: the others are asked only where it does not.
            let mut readings = Carrier::ALL.map(|_| Default::default());
            let mut found = judge.conclude(&readings);
            for carrier in Carrier::ALL {
                let reading = carrier.read_copy(&suspect, &host, is_smoothed, key, &mut report)?;
                readings[carrier as usize] = reading;
                found = judge.conclude(&readings);
                if level(&found, payload) == Level::Green {
                    break;
                }
            }
            forecasts.push(forecast(name, &found));
        }
    }
    step(progress, Stage::Forecast, 1.0)?;
    Ok(forecasts)
}

fn level(found: &Extraction, payload: Payload) -> Level {
    let is_right = found.verdict == Verdict::Found && found.number == Some(payload.number());
    match found.details().ln_p {
        ln_p if is_right && ln_p <= 2.0 * LN_P_FOUND => Level::Green,
        _ if is_right => Level::Amber,
        _ => Level::Red,
    }
}
