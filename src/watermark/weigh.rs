//! The judge of readings with the original: what ways of reading say becomes one bound, every choice charged.

use crate::bits::Payload;
use crate::carrier::{Place, Way};
use crate::code::{Checked, Codeword, SoftSymbol, Symbol, decode};
use crate::detection::{LN_P_FOUND, LN_P_TRACE, exponents_of_errors, ln_p_of_errors, union};
use crate::key::Key;
use glam::DVec3;
use std::f64::consts::LN_2;

/// Logarithm of the number of payloads.
const LN_PAYLOADS: f64 = Payload::BITS as f64 * LN_2;
/// Tests of a way: the pilots alone, all symbols against a mark without a payload, and against a payload.
const TESTS: f64 = 3.0;
/// Candidates of the decoder whose check bits are tried.
const LIST: usize = 64;

/// What speaks loudest of all ways that were heard.
pub(super) struct Scales {
    check: Checked,
    /// The bound of a mark of the key, whatever it holds.
    pub ln_p_presence: f64,
    /// The bound of the payload.
    pub ln_p_payload: f64,
    /// What was read, whatever its bound.
    pub payload: Option<Payload>,
    /// The list of the way that spoke loudest.
    pub list: usize,
    /// What its windows said.
    pub spoken: Spoken,
}

/// What each window said for the mark that was heard.
#[derive(Default)]
pub(super) struct Spoken {
    /// Of every window, in the original's scene units.
    pub radius: f64,
    /// The windows that were seen: their centres, and what each adds to the exponent before charges.
    pub windows: Vec<(DVec3, f64)>,
}

impl Spoken {
    /// Of a way, with the errors that the mark leaves.
    fn of(way: &Way, error: impl Fn(&Place) -> f64) -> Spoken {
        let terms = way.places.iter().map(|p| (p.response, error(p)));
        let exponents = exponents_of_errors(&terms.collect::<Vec<_>>());
        let all = way.places.iter().zip(exponents);
        let seen = all.filter(|(place, _)| place.response != 0.0);
        Spoken {
            radius: way.radius,
            windows: seen.map(|(p, exponent)| (p.centre, exponent)).collect(),
        }
    }
}

impl Scales {
    pub(super) fn new(key: &Key) -> Scales {
        Scales {
            check: Checked::new(key),
            ln_p_presence: 0.0,
            ln_p_payload: 0.0,
            payload: None,
            list: 0,
            spoken: Spoken::default(),
        }
    }

    /// Hears a way of reading; `true` where nothing more needs to be heard.
    pub(super) fn hear(&mut self, way: &Way) -> bool {
        let charge = way.ln_num_tests + libm::log(TESTS);
        let pilots = way.places.iter();
        let pilots = pilots.filter(|place| place.symbol == Symbol::Pilot);
        let pilots = ln_p_of_errors(pilots.map(|place| (place.response, place.errors[1])));
        let presence = against(&way.places, &Codeword::Presence);
        let ln_p = union(pilots.min(presence), charge);
        if ln_p < self.ln_p_presence {
            self.ln_p_presence = ln_p;
            if self.payload.is_none() {
                self.list = way.list;
                let of_pilot = |p: &Place| match p.symbol {
                    Symbol::Pilot => p.errors[1],
                    _ => 0.0,
                };
                self.spoken = match presence < pilots {
                    true => Spoken::of(way, |p| error(p, &Codeword::Presence)),
                    false => Spoken::of(way, of_pilot),
                };
            }
        }
        if let Some((payload, ln_p)) = self.decoded(&way.places, charge)
            && ln_p < self.ln_p_payload
        {
            self.ln_p_payload = ln_p;
            self.payload = Some(payload);
            self.list = way.list;
            let codeword = Codeword::new(self.check.message(payload));
            self.spoken = Spoken::of(way, |p| error(p, &codeword));
        }
        // Of a mark with a payload, parities that say -1 are no more than half: its pilots are louder.
        let is_without = presence < pilots && union(presence, charge) <= 2.0 * LN_P_FOUND;
        self.ln_p_payload <= 2.0 * LN_P_FOUND || is_without
    }

    /// The likeliest payload whose check bits hold, if it stands out from what noise would give, and its bound.
    fn decoded(&self, places: &[Place], charge: f64) -> Option<(Payload, f64)> {
        let charged = |ln_p: f64| union(ln_p + LN_PAYLOADS, charge);
        let ln_p_of = |message: u64| charged(against(places, &Codeword::new(message)));
        let symbols: Vec<SoftSymbol> = places.iter().map(soft).collect();
        let first = decode(&symbols, 1);
        // The likeliest message is mostly the right one, and where it does not stand out, none does.
        if !first.iter().any(|&message| ln_p_of(message) <= LN_P_TRACE) {
            return None;
        }
        let valid = |message: u64| Some((self.check.payload(message)?, ln_p_of(message)));
        let found = first.into_iter().find_map(valid);
        found
            .or_else(|| decode(&symbols, LIST).into_iter().find_map(valid))
            .filter(|(_, ln_p)| *ln_p <= LN_P_TRACE)
    }
}

/// What a window says for the decoder: by how much better +1 fits than -1.
fn soft(place: &Place) -> SoftSymbol {
    let value = place.response * (place.errors[1] - place.errors[0]);
    SoftSymbol {
        symbol: place.symbol,
        value,
        weight: value.abs(),
    }
}

/// The bound of errors against a codeword.
fn against(places: &[Place], codeword: &Codeword) -> f64 {
    ln_p_of_errors(places.iter().map(|p| (p.response, error(p, codeword))))
}

/// By how much of a step the embedder had to move a window for a codeword.
fn error(place: &Place, codeword: &Codeword) -> f64 {
    place.errors[usize::from(codeword.sign(place.symbol) > 0.0)]
}
