//! The judge of readings with the original: what ways of reading say becomes one bound, every choice charged.

use crate::bits::Payload;
use crate::carrier::{Place, Way};
use crate::code::{Checked, Codeword, SoftSymbol, Symbol, complete, decode};
use crate::detection::{LN_P_FOUND, LN_P_TRACE, exponents_of_errors, ln_p_of_errors, union};
use crate::key::Key;
use glam::DVec3;
use std::f64::consts::LN_2;

/// Logarithm of the number of payloads.
const LN_PAYLOADS: f64 = Payload::BITS as f64 * LN_2;
/// Tests of a way: the pilots alone, all symbols against a mark without a payload, and against a payload. Where one is expected also the symbols that
/// are no pilots against it, and all symbols against another one.
const TESTS: f64 = 3.0;
const TESTS_EXPECTING: f64 = 5.0;
/// Candidates of the decoder whose check bits are tried.
const LIST: usize = 64;

/// What speaks loudest of all ways that were heard.
pub(super) struct Scales {
    check: Checked,
    expected: Option<Payload>,
    /// What fits the expected payload best where nothing is decoded.
    fit: Option<Fit>,
    /// Another payload than the expected one, which is decoded, and its bound.
    pub other: Option<(Payload, f64)>,
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

/// The message that begins with an expected payload and fits a way best, held against the symbols that are no pilots.
struct Fit {
    message: u64,
    ln_p: f64,
    list: usize,
    spoken: Spoken,
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
            expected: None,
            fit: None,
            other: None,
            ln_p_presence: 0.0,
            ln_p_payload: 0.0,
            payload: None,
            list: 0,
            spoken: Spoken::default(),
        }
    }

    /// The same where a payload was expected before the suspect was looked at: it alone is charged.
    pub(super) fn expecting(self, expected: Option<Payload>) -> Scales {
        Scales { expected, ..self }
    }

    /// Hears a way of reading; `true` where nothing more needs to be heard.
    pub(super) fn hear(&mut self, way: &Way) -> bool {
        let tests = match self.expected {
            Some(_) => TESTS_EXPECTING,
            None => TESTS,
        };
        let charge = way.ln_num_tests + libm::log(tests);
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
        match self.decoded(&way.places, charge) {
            Some((payload, ln_p)) if self.expected.is_none_or(|it| it == payload) => {
                if ln_p < self.ln_p_payload {
                    self.ln_p_payload = ln_p;
                    self.payload = Some(payload);
                    self.list = way.list;
                    let codeword = Codeword::new(self.check.message(payload));
                    self.spoken = Spoken::of(way, |p| error(p, &codeword));
                }
            }
            Some(other) => {
                if other.1 < self.ln_p_other() {
                    self.other = Some(other);
                }
            }
            None => self.fit_expected(way, charge),
        }
        // Of a mark with a payload, parities that say -1 are no more than half: its pilots are louder.
        let is_without = presence < pilots && union(presence, charge) <= 2.0 * LN_P_FOUND;
        self.ln_p_payload.min(self.ln_p_other()) <= 2.0 * LN_P_FOUND || is_without
    }

    /// Holds the expected payload against the symbols that are no pilots. Neighbours of a payload that is there share most of its parities, so it
    /// has to prove itself by its check bits, as in a blind reading (docs/SECURITY.md, "Wrong payloads of a right key").
    fn fit_expected(&mut self, way: &Way, charge: f64) {
        let Some(expected) = self.expected else {
            return;
        };
        let symbols: Vec<SoftSymbol> = way.places.iter().map(soft).collect();
        let message = complete(&symbols, expected.number(), Payload::BITS);
        let codeword = Codeword::new(message);
        let of_other = |p: &Place| match p.symbol {
            Symbol::Pilot => 0.0,
            _ => error(p, &codeword),
        };
        let others = way.places.iter();
        let others = others.filter(|place| place.symbol != Symbol::Pilot);
        let ln_p = ln_p_of_errors(others.map(|place| (place.response, of_other(place))));
        let ln_p = union(ln_p, charge);
        if self.fit.as_ref().map_or(0.0, |fit| fit.ln_p) > ln_p {
            self.fit = Some(Fit {
                message,
                ln_p,
                list: way.list,
                spoken: Spoken::of(way, of_other),
            });
        }
    }

    /// What is left to say once all was heard: where nothing was decoded, what fits an expected payload best speaks for it if its check bits are the
    /// payload's own; where another payload speaks louder, the expected one is not there.
    pub(super) fn conclude(mut self) -> Scales {
        if self.payload.is_none()
            && self.other.is_none()
            && let (Some(expected), Some(fit)) = (self.expected, self.fit.take())
            && fit.message == self.check.message(expected)
        {
            self.ln_p_payload = fit.ln_p;
            self.payload = Some(expected);
            self.list = fit.list;
            self.spoken = fit.spoken;
        }
        match self.ln_p_other() < self.ln_p_payload {
            true => {
                self.ln_p_payload = 0.0;
                self.payload = None;
            }
            false => self.other = None,
        }
        self
    }

    fn ln_p_other(&self) -> f64 {
        self.other.map_or(0.0, |(_, ln_p)| ln_p)
    }

    /// The likeliest payload whose check bits hold, if it stands out from what noise would give, and its bound.
    /// Nothing is charged for one that was expected.
    fn decoded(&self, places: &[Place], charge: f64) -> Option<(Payload, f64)> {
        let ln_p_of = |message: u64| against(places, &Codeword::new(message));
        let stands_out = |ln_p: f64| union(ln_p + LN_PAYLOADS, charge) <= LN_P_TRACE;
        let symbols: Vec<SoftSymbol> = places.iter().map(soft).collect();
        let first = decode(&symbols, 1);
        // The likeliest message is mostly the right one, and where it does not stand out, none does.
        if !first.iter().any(|&message| stands_out(ln_p_of(message))) {
            return None;
        }
        let valid = |message: u64| Some((self.check.payload(message)?, ln_p_of(message)));
        let found = first.into_iter().find_map(valid);
        let found = found.or_else(|| decode(&symbols, LIST).into_iter().find_map(valid));
        let (payload, ln_p) = found.filter(|(_, ln_p)| stands_out(*ln_p))?;
        let ln_guesses = match self.expected == Some(payload) {
            true => 0.0,
            false => LN_PAYLOADS,
        };
        Some((payload, union(ln_p + ln_guesses, charge)))
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
    let terms = places.iter().map(|p| (p.response, error(p, codeword)));
    // The bound goes over them many times.
    let terms: Vec<(f64, f64)> = terms.collect();
    ln_p_of_errors(terms.iter().copied())
}

/// By how much of a step the embedder had to move a window for a codeword.
fn error(place: &Place, codeword: &Codeword) -> f64 {
    place.errors[usize::from(codeword.sign(place.symbol) > 0.0)]
}
