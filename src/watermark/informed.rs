//! Reading a suspect with the original at hand.

use super::{EmbedOptions, Error, Model, Strength, Suspect, Verdict};
use crate::bits::Payload;
use crate::carrier::{Host, solid};
use crate::code::{Checked, Codeword, SoftSymbol, Symbol, decode};
use crate::detection::{LN_P_FOUND, LN_P_TRACE, ln_p_of_errors, union};
use crate::document::Document;
use crate::geometry::{LEAST_NEAR, Leeway, Original, Registration, Search, Shown, Views};
use crate::key::Key;
use crate::progress::Stage;
use crate::scene::Scene;
use std::f64::consts::LN_2;

/// Logarithm of the number of payloads.
const LN_PAYLOADS: f64 = Payload::BITS as f64 * LN_2;
/// Tests of a way: the pilots alone, all symbols against a mark without a payload, and against a payload.
const TESTS: f64 = 3.0;
/// Candidates of the decoder whose check bits are tried.
const LIST: usize = 64;

/// What a suspect is, held against an original and a key.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Comparison {
    /// The answer about the mark.
    pub verdict: Verdict,
    /// Whether the suspect has the original's shape, or a piece of it, whoever marked it.
    pub is_same_shape: bool,
    /// The share of the suspect's surface that lies on the original, 0 to 1.
    pub near: f64,
    /// The share of the original's surface that the suspect shows, 0 to 1.
    pub covered: f64,
    /// Whether the suspect is a mirror image.
    pub is_mirrored: bool,
    /// The payload as a tag, where it is found.
    pub tag: Option<String>,
    /// The payload as a number, where it is found.
    pub number: Option<u64>,
    pub(super) ln_p: f64,
}

impl Comparison {
    /// For dev.
    pub fn ln_p(&self) -> f64 {
        self.ln_p
    }
}

/// Reads a suspect with the original.
pub fn compare<'a, 'b>(
    suspect: impl Into<Suspect<'a>>,
    original: impl Into<Model<'b>>,
    key: &Key,
) -> Result<Comparison, Error> {
    compare_in(suspect.into(), &original.into(), key)
}

fn compare_in(mut suspect: Suspect, model: &Model, key: &Key) -> Result<Comparison, Error> {
    suspect.step(Stage::Read, 0.0)?;
    let document = Document::read(model.bytes, model.files)?;
    let scene = Scene::gather(&document)?;
    let mesh = suspect.mesh()?;
    suspect.step(Stage::Measure, 0.0)?;
    let original = Original::new(&scene.mesh);
    let views = Views::new(&scene.mesh);
    suspect.step(Stage::Measure, 1.0)?;
    let options = EmbedOptions::default().with_strength(Strength::BALANCED);
    let parts = scene.parts();
    let leeway = Leeway::new(&scene.mesh, &parts, options.bounds()?);
    let host = Host {
        mesh: &scene.mesh,
        leeway: &leeway,
        admissible: &scene.admissible,
        rms_rel: options.strength.rms_rel(),
        hidden: options.strength.is_hidden(),
        on_top: false,
    };
    let mut best = Best::new(key);
    let mut lies: Vec<(Registration, Shown)> = Vec::new();
    // Each search has a third of the probability of a false alarm, whether it is made or not.
    let ln_num_searches = libm::log(Search::ALL.len() as f64);
    for search in Search::ALL {
        let first = lies.len();
        for registration in original.registrations(&mesh, search) {
            let is_near = registration.near >= LEAST_NEAR;
            let shown = || Shown::new(&original, &views, &mesh, &registration.motion);
            if let Some(shown) = is_near.then(shown).flatten() {
                lies.push((registration, shown));
            }
        }
        let observe: Vec<_> = lies[first..]
            .iter()
            .map(|(_, shown)| move |radius: f64| shown.observations(radius))
            .collect();
        let seen: Vec<&solid::Seen> = observe.iter().map(|o| o as &solid::Seen).collect();
        let mut is_settled = false;
        solid::read_with_original(&host, key, &seen, &mut suspect, &mut |mut way| {
            way.list += first;
            way.ln_num_tests += ln_num_searches;
            is_settled = best.hear(&way);
            is_settled
        })?;
        if is_settled {
            break;
        }
    }
    let lie = lies.get(best.list);
    let ln_p = best.ln_p_payload.min(best.ln_p_presence);
    Ok(Comparison {
        verdict: if best.ln_p_payload <= LN_P_FOUND {
            Verdict::Found
        } else if ln_p <= LN_P_FOUND {
            Verdict::Present
        } else if ln_p <= LN_P_TRACE {
            Verdict::Partial
        } else {
            Verdict::None
        },
        is_same_shape: lie.is_some(),
        near: lie.map_or(0.0, |(registration, _)| registration.near),
        covered: lie.map_or(0.0, |(_, shown)| shown.covered()),
        is_mirrored: lie.is_some_and(|(registration, _)| registration.motion.is_mirrored()),
        tag: best.payload.and_then(Payload::tag),
        number: best.payload.map(Payload::number),
        ln_p,
    })
}

/// What speaks loudest of all ways that were heard.
struct Best {
    check: Checked,
    ln_p_presence: f64,
    ln_p_payload: f64,
    payload: Option<Payload>,
    list: usize,
}

impl Best {
    fn new(key: &Key) -> Best {
        Best {
            check: Checked::new(key),
            ln_p_presence: 0.0,
            ln_p_payload: 0.0,
            payload: None,
            list: 0,
        }
    }

    /// Hears a way of reading; `true` where nothing more needs to be heard.
    fn hear(&mut self, way: &solid::Way) -> bool {
        let charge = way.ln_num_tests + libm::log(TESTS);
        let places = &way.places;
        let pilots = places.iter().filter(|place| place.symbol == Symbol::Pilot);
        let pilots = ln_p_of_errors(pilots.map(|place| (place.response, place.errors[1])));
        let presence = against(places, &Codeword::Presence);
        let ln_p = union(pilots.min(presence), charge);
        if ln_p < self.ln_p_presence {
            self.ln_p_presence = ln_p;
            if self.payload.is_none() {
                self.list = way.list;
            }
        }
        let soft = |place: &solid::Place| {
            let value = place.response * (place.errors[1] - place.errors[0]);
            SoftSymbol {
                symbol: place.symbol,
                value,
                weight: value.abs(),
            }
        };
        let symbols: Vec<SoftSymbol> = places.iter().map(soft).collect();
        let stands_out = |ln_p: f64| union(ln_p + LN_PAYLOADS, charge) <= LN_P_TRACE;
        let ln_p_of = |message: u64| against(places, &Codeword::new(message));
        let first = decode(&symbols, 1);
        if !first.iter().any(|&message| stands_out(ln_p_of(message))) {
            return false;
        }
        let valid = |message: u64| Some((self.check.payload(message)?, ln_p_of(message)));
        let found = first.into_iter().find_map(valid);
        let found = found.or_else(|| decode(&symbols, LIST).into_iter().find_map(valid));
        let Some((payload, ln_p)) = found else {
            return false;
        };
        let ln_p = union(ln_p + LN_PAYLOADS, charge);
        if ln_p < self.ln_p_payload {
            self.ln_p_payload = ln_p;
            self.payload = Some(payload);
            self.list = way.list;
        }
        self.ln_p_payload <= 2.0 * LN_P_FOUND
    }
}

/// The bound of errors against a codeword.
fn against(places: &[solid::Place], codeword: &Codeword) -> f64 {
    ln_p_of_errors(places.iter().map(|place| {
        let sign = codeword.sign(place.symbol) > 0.0;
        (place.response, place.errors[usize::from(sign)])
    }))
}
