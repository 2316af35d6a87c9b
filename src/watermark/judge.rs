//! The judge: what carriers read of a suspect becomes one answer, with every choice charged.

use super::report::{CarrierReading, Details, Extraction, Input, Verdict};
use crate::bits::Payload;
use crate::carrier::{self, Carrier, Hypothesis};
use crate::code::{Checked, Codeword, SoftSymbol, Symbol, complete, decode};
use crate::detection::{LN_P_FOUND, LN_P_TRACE, Statistic, union};
use crate::key::Key;
use std::f64::consts::LN_2;

/// Candidates of the decoder whose check bits are tried, where the likeliest fails: a wrong one ahead of the right one passes
/// with probability 2^-12. On a mesh of 500 vertices there are hardly more symbols than bits, and many messages fit alike.
const LIST: usize = 64;

/// What a carrier says, and what else the verdict depends on. All bounds are charged for the carrier's own choices.
struct Heard {
    report: CarrierReading,
    /// Bound of the payload in the report.
    ln_p_payload: f64,
    /// Whether the suspect offers enough for a mark to be found, whatever key it is read with.
    is_enough: bool,
    /// What was decoded where another payload was expected.
    other: Option<Other>,
    /// The places that say together what it says, of LOCAL.
    num_places: usize,
}

/// Another payload than the expected one.
#[derive(Clone, Copy)]
struct Other {
    payload: Payload,
    /// Its bound. It was not expected, so all 2^48 are charged, as in a blind reading.
    ln_p: f64,
}

/// A payload and what speaks for it.
struct Candidate {
    payload: Payload,
    /// All symbols against the payload.
    all: Statistic,
    /// Bound, all choices within the carrier charged.
    ln_p: f64,
    /// Which piece of the suspect it was read in.
    piece: usize,
}

/// Logarithm of the number of payloads.
const LN_PAYLOADS: f64 = Payload::BITS as f64 * LN_2;

/// What each carrier read, in the order of [`Carrier::STANDARD`].
pub(super) type Readings = [carrier::Reading; Carrier::STANDARD.len()];

/// What a carrier is charged, for one speaks for all, and which one is not known before: the logarithm of its share's inverse.
fn ln_carriers(carrier: Carrier) -> f64 {
    -libm::log(carrier.share())
}

/// The same of those that hold payloads: each has 15 of 32.
const LN_CARRIERS: f64 = 0.757_685_701_697_516;

/// What a suspect is judged by.
pub(super) struct Judge {
    check: Checked,
    expected: Option<Payload>,
    input: Input,
    /// Logarithm of the number of keys that the suspect is read with.
    ln_num_keys: f64,
}

impl Judge {
    pub(super) fn new(key: &Key, expected: Option<Payload>, input: Input) -> Judge {
        Judge {
            check: Checked::new(key),
            expected,
            input,
            ln_num_keys: 0.0,
        }
    }

    /// The same with one key of so many, which are charged.
    pub(super) fn one_of(self, num_keys: usize) -> Judge {
        Judge {
            ln_num_keys: libm::log(num_keys as f64),
            ..self
        }
    }

    /// The answer to what each carrier read, in the order of [`Carrier::STANDARD`].
    pub(super) fn conclude(&self, readings: &Readings) -> Extraction {
        self.conclude_with(readings, None)
    }

    /// The same where one was asked for beside these.
    pub(super) fn conclude_with(
        &self,
        readings: &Readings,
        asked: Option<(Carrier, carrier::Reading)>,
    ) -> Extraction {
        let decoded = readings
            .each_ref()
            .map(|reading| likeliest(reading.hypotheses.iter().filter_map(|h| self.decode(h))));
        // One model carries one payload of a key: the one that speaks loudest. What a carrier hears of it that decodes nothing, or
        // another one, does not count.
        let heard = decoded.iter().flatten();
        let payload = heard
            .min_by(|a, b| a.ln_p.total_cmp(&b.ln_p))
            .map(|loudest| loudest.payload);
        let all = Carrier::STANDARD.into_iter().zip(readings).zip(decoded);
        let heard = all.map(|((carrier, reading), own)| {
            let own = own.filter(|own| Some(own.payload) == payload);
            self.hear(carrier, reading, own, payload.is_some())
        });
        let asked = asked.map(|(carrier, reading)| self.hear_presence(carrier, &reading));
        conclude(heard.chain(asked).collect(), self.input)
    }

    /// Whether what a carrier has read so far leaves nothing to look for: its payload is found by a wide margin, or it is a mark without
    /// one. That a reading ends there rejects nothing, so this may depend on all that was read (docs/SECURITY.md, 11).
    pub(super) fn is_settled(&self, reading: &carrier::Reading) -> bool {
        let is_found = |hypothesis: &Hypothesis| {
            let payload = self.decode(hypothesis);
            let payload = payload.filter(|own| self.expected.is_none_or(|it| it == own.payload));
            let is_wide = |own: Candidate| union(own.ln_p, LN_CARRIERS) <= 2.0 * LN_P_FOUND;
            let [pilots, presence] = without_payload(&hypothesis.symbols).map(|own| own.ln_p());
            // Of a mark with a payload, parities that say -1 are no more than half: its pilots are louder.
            let is_without = presence < pilots
                && union(presence, self.charge(hypothesis) + LN_CARRIERS) <= LN_P_FOUND;
            payload.is_some_and(is_wide) || is_without
        };
        reading.hypotheses.iter().any(is_found)
    }

    /// What a carrier says, of which a payload was decoded or not; and whether one was decoded of any.
    fn hear(
        &self,
        name: Carrier,
        reading: &carrier::Reading,
        decoded: Option<Candidate>,
        is_any_decoded: bool,
    ) -> Heard {
        let hypotheses = &reading.hypotheses;
        let (candidate, other) = match (decoded, self.expected) {
            (Some(decoded), Some(expected)) if decoded.payload != expected => {
                let other = Other {
                    payload: decoded.payload,
                    ln_p: union(decoded.ln_p, LN_PAYLOADS),
                };
                (None, Some(other))
            }
            (None, Some(expected)) if !is_any_decoded => (self.fit(hypotheses, expected), None),
            (decoded, _) => (decoded, None),
        };
        let charged = |h: &Hypothesis| {
            let [pilots, presence] = without_payload(&h.symbols).map(|own| own.ln_p());
            union(pilots.min(presence), self.charge(h))
        };
        let ln_p_presence = hypotheses.iter().map(charged).fold(0.0, f64::min);
        let ln_p_payload = candidate.as_ref().map_or(0.0, |candidate| candidate.ln_p);
        // A payload is named where chance is excluded, as the verdict is found: whoever learns a payload that chance gave, and
        // expects it from then on, no longer pays for having guessed it.
        let named = candidate
            .as_ref()
            .filter(|_| union(ln_p_payload, LN_CARRIERS) <= LN_P_FOUND);
        let payload = named.map(|candidate| candidate.payload);
        let piece = named.map(|candidate| candidate.piece);
        Heard {
            report: CarrierReading {
                name,
                ln_p: ln_p_presence.min(ln_p_payload),
                tag: payload.and_then(Payload::tag),
                number: payload.map(Payload::number),
                piece: piece.filter(|&piece| piece > 0),
                agreement: candidate.map_or(0.0, |candidate| candidate.all.agreement()),
                addresses: reading.num_addresses,
                owned_addresses: hypotheses
                    .iter()
                    .map(|h| h.symbols.len())
                    .max()
                    .unwrap_or(0),
            },
            ln_p_payload,
            is_enough: {
                let most = name.most_exponent(reading.num_addresses);
                let charge = |h: &Hypothesis| self.charge(h) + LN_CARRIERS;
                let first = hypotheses.first(); // all of RING's are charged alike, and of SOLID there is enough or nothing
                first.is_some_and(|h| charge(h) - most <= LN_P_FOUND)
            },
            other,
            num_places: 0,
        }
    }

    /// What a carrier says that holds no payload. One test is made of each way: of its symbols against a mark without a payload.
    fn hear_presence(&self, name: Carrier, reading: &carrier::Reading) -> Heard {
        let (mut ln_p, mut agreement, mut num_places) = (0.0, 0.0, 0);
        for (number, way) in (1..).zip(&reading.hypotheses) {
            let [_, presence] = without_payload(&way.symbols);
            let charged = union(presence.ln_p(), way.ln_num_tests + self.ln_num_keys);
            if charged < ln_p {
                (ln_p, agreement, num_places) = (charged, presence.agreement(), number);
            }
        }
        let owned = reading.hypotheses.iter().map(|way| way.symbols.len());
        Heard {
            report: CarrierReading {
                name,
                ln_p,
                tag: None,
                number: None,
                piece: None,
                agreement,
                addresses: reading.num_addresses,
                owned_addresses: owned.max().unwrap_or(0),
            },
            ln_p_payload: 0.0,
            is_enough: false,
            other: None,
            num_places,
        }
    }

    /// Logarithm of the number of payloads that a reading chooses from.
    fn ln_guesses(&self) -> f64 {
        if self.expected.is_some() {
            0.0
        } else {
            LN_PAYLOADS
        }
    }

    /// What a hypothesis is charged: its own share, the number of tests that are made of it, and the number of keys. The tests are
    /// the pilots alone, all symbols against a mark without a payload, and all symbols against a payload; where a payload is
    /// expected, also the symbols that are no pilots against it, and all symbols against another payload, which is named.
    fn charge(&self, hypothesis: &Hypothesis) -> f64 {
        let tests = if self.expected.is_some() { 5.0 } else { 3.0 };
        hypothesis.ln_num_tests + libm::log(tests) + self.ln_num_keys
    }

    /// The likeliest payload whose check bits hold, if it stands out from what noise would give.
    fn decode(&self, hypothesis: &Hypothesis) -> Option<Candidate> {
        let (symbols, charge) = (&hypothesis.symbols, self.charge(hypothesis));
        let statistic = |message| {
            let codeword = Codeword::new(message);
            against(symbols, |symbol| codeword.sign(symbol))
        };
        let stands_out = |all: &Statistic| union(all.ln_p() + LN_PAYLOADS, charge) <= LN_P_TRACE;
        // The likeliest message is mostly the right one, and where it does not stand out, none does.
        let likeliest = decode(symbols, 1);
        if !likeliest
            .iter()
            .any(|&message| stands_out(&statistic(message)))
        {
            return None;
        }
        let valid = |message: u64| Some((self.check.payload(message)?, statistic(message)));
        let first = likeliest.into_iter().find_map(valid);
        let (payload, all) = first.or_else(|| decode(symbols, LIST).into_iter().find_map(valid))?;
        stands_out(&all).then(|| Candidate {
            payload,
            all,
            ln_p: union(all.ln_p() + self.ln_guesses(), charge),
            piece: hypothesis.piece,
        })
    }

    /// The expected payload, held against the symbols that are no pilots, where nothing was decoded.
    ///
    /// Neighbours of a payload that is there share most of its parities, so it has to prove itself by its check bits: of all that
    /// could follow it, they must fit best, in the way of reading in which any fit best. Those of a payload that no suspect was
    /// marked with are independent of the suspect: they do so with a probability of 2^-12.
    fn fit(&self, hypotheses: &[Hypothesis], payload: Payload) -> Option<Candidate> {
        let candidates = hypotheses.iter().map(|hypothesis| {
            let message = complete(&hypothesis.symbols, payload.number(), Payload::BITS);
            let codeword = Codeword::new(message);
            let sign = |symbol| codeword.sign(symbol);
            let symbols = hypothesis.symbols.iter();
            let others = symbols.filter(|soft| soft.symbol != Symbol::Pilot);
            let others = Statistic::new(others.map(|s| (s.value * sign(s.symbol), s.weight)));
            let ln_p = union(others.ln_p(), self.charge(hypothesis));
            (ln_p, message, hypothesis)
        });
        let (ln_p, message, hypothesis) = candidates.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let codeword = Codeword::new(message);
        (self.check.message(payload) == message).then(|| Candidate {
            payload,
            all: against(&hypothesis.symbols, |symbol| codeword.sign(symbol)),
            ln_p,
            piece: hypothesis.piece,
        })
    }
}

fn likeliest(candidates: impl Iterator<Item = Candidate>) -> Option<Candidate> {
    candidates.min_by(|a, b| a.ln_p.total_cmp(&b.ln_p))
}

/// What speaks for a mark whatever its payload is, and for one that has none.
fn without_payload(symbols: &[SoftSymbol]) -> [Statistic; 2] {
    let pilots = symbols.iter().filter(|soft| soft.symbol == Symbol::Pilot);
    let pilots = Statistic::new(pilots.map(|soft| (soft.value, soft.weight)));
    [
        pilots,
        against(symbols, |symbol| Codeword::Presence.sign(symbol)),
    ]
}

fn against(symbols: &[SoftSymbol], sign: impl Fn(Symbol) -> f64) -> Statistic {
    Statistic::new(
        symbols
            .iter()
            .map(|soft| (soft.value * sign(soft.symbol), soft.weight)),
    )
}

/// What is said of a mark that is in no carrier but one that can be carried over.
const CARRIED_OVER: &str = "Only the way in which vertices are connected says so. Whoever has a marked copy can carry that over to another \
     model without the key: compare the shape with your original.";

/// One verdict from all carriers' readings; the choice between carriers is charged. Below `found` the words hold nothing that
/// follows the key but the verdict.
fn conclude(heard: Vec<Heard>, input: Input) -> Extraction {
    let best = |ln_p: fn(&Heard) -> f64| {
        let charged = |heard: &Heard| union(ln_p(heard), ln_carriers(heard.report.name));
        heard.iter().map(charged).fold(0.0, f64::min)
    };
    let ln_p_payload = best(|heard| heard.ln_p_payload);
    // The number beside a payload speaks for it: pilots speak for the key alone.
    let ln_p = if ln_p_payload <= LN_P_FOUND {
        ln_p_payload
    } else {
        best(|heard| heard.report.ln_p)
    };
    let by_payload = |a: &&Heard, b: &&Heard| a.ln_p_payload.total_cmp(&b.ln_p_payload);
    let loudest = heard.iter().min_by(by_payload);
    let loudest = &loudest.expect("there are carriers").report;
    let others = heard.iter().filter_map(|heard| heard.other);
    let other = others.min_by(|a, b| a.ln_p.total_cmp(&b.ln_p));
    let ln_p_other = other.map_or(0.0, |other| union(other.ln_p, LN_CARRIERS));
    let (tag, number, agreement) = (loudest.tag.clone(), loudest.number, loudest.agreement);
    let other = other.filter(|_| ln_p_other <= LN_P_TRACE);
    let (verdict, reason) = if ln_p_payload <= LN_P_FOUND {
        (Verdict::Found, None)
    } else if other.is_some() {
        let reason = "The model carries a mark of this key, but with another payload.";
        (Verdict::Partial, Some(reason))
    } else if ln_p <= LN_P_FOUND {
        (Verdict::Present, None)
    } else if ln_p <= LN_P_TRACE {
        let reason =
            "Something of this key is there, but too little to read its payload with certainty.";
        (Verdict::Partial, Some(reason))
    } else if !heard.iter().any(|heard| heard.is_enough) {
        let reason = "The model has too few places for symbols to tell.";
        (Verdict::CannotCheck, Some(reason))
    } else {
        let reason = "This key's places for symbols agree as by chance.";
        (Verdict::None, Some(reason))
    };
    let mut reason = reason.map(str::to_owned);
    let says_so =
        |heard: &&Heard| union(heard.report.ln_p, ln_carriers(heard.report.name)) <= LN_P_FOUND;
    if verdict == Verdict::Present
        && let Some(local) = heard.iter().find(|heard| heard.num_places > 0)
        && says_so(&local)
    {
        reason = Some(match local.num_places {
            1 => "Found by LOCAL, in one place. LOCAL holds no payload.".to_owned(),
            places => format!("Found by LOCAL, in {places} places. LOCAL holds no payload."),
        });
    }
    if let (Some(reason), Some(other)) = (&mut reason, other.filter(|_| ln_p_other <= LN_P_FOUND)) {
        let tag = other.payload.tag();
        reason.push_str(" It is ");
        reason.push_str(&tag.unwrap_or_else(|| other.payload.number().to_string()));
        reason.push('.');
    }
    let is_there = matches!(verdict, Verdict::Found | Verdict::Present);
    let mut saying_so = heard.iter().filter(says_so);
    let is_in_shape = saying_so.any(|heard| !heard.report.name.can_be_carried_over());
    Extraction {
        verdict,
        input,
        sentence: verdict.sentence(),
        reason,
        caution: (is_there && !is_in_shape).then_some(CARRIED_OVER),
        found_in: None,
        tag,
        number,
        details: Details {
            ln_p,
            agreement,
            carriers: heard.into_iter().map(|heard| heard.report).collect(),
        },
        shows_details: is_there,
    }
}

#[cfg(test)]
mod tests;
