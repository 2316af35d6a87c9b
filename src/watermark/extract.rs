//! Measuring a suspect, and reading evidence with a key.

use super::error::Error;
use super::report::{CarrierReading, Details, Extraction, Input, Verdict};
use crate::bits::Payload;
use crate::carrier::{self, Carrier, Hypothesis, ring, solid};
use crate::code::{Checked, Codeword, SoftSymbol, Symbol, complete, decode};
use crate::detection::{LN_P_FOUND, LN_P_TRACE, Statistic, union};
use crate::document::{Document, Files};
use crate::evidence::Evidence;
use crate::key::Key;
use crate::progress::{Progress, Stage, ignore, step};
use crate::scene::Scene;
use std::f64::consts::LN_2;

/// Candidates of the decoder whose check bits are tried, where the likeliest fails: a wrong one ahead of the right one passes
/// with probability 2^-12. On a mesh of 500 vertices there are hardly more symbols than bits, and many messages fit alike.
const LIST: usize = 64;

/// Measures a suspect: everything that needs no key.
pub fn measure(
    model: &[u8],
    files: &Files,
    progress: &mut dyn Progress,
) -> Result<Evidence, Error> {
    step(progress, Stage::Read, 0.0)?;
    let scene = Scene::gather(&Document::read(model, files)?)?;
    step(progress, Stage::Measure, 0.0)?;
    let evidence = Evidence::measure(&scene.mesh);
    step(progress, Stage::Measure, 1.0)?;
    Ok(evidence)
}

/// Reads a payload from evidence, knowing only the key. The bound charges all 2^48 payloads.
pub fn extract(evidence: &Evidence, key: &Key) -> Extraction {
    read(evidence, Reader::new(key, None, Input::Evidence), key)
}

/// Reads evidence with every key of a list, as [`extract`] does with one, and in their order.
///
/// That there are many is charged in everything that is said, verdicts and details: the probability that the mark of any
/// of them is wrongly found is at most 1e-9.
pub fn extract_many(evidence: &Evidence, keys: &[Key]) -> Vec<Extraction> {
    let one = |key| {
        let reader = Reader::new(key, None, Input::Evidence).one_of(keys.len());
        read(evidence, reader, key)
    };
    keys.iter().map(one).collect()
}

/// Tests evidence for one payload that was expected before it was looked at.
///
/// A small p alone would say that the key is there, not that the payload is this one: copies of the same owner with other
/// payloads share the pilots and many parities. So the payload counts as found only where decoding gives it, or where
/// decoding gives none, the symbols other than pilots speak for it, and its own check bits fit best of all.
///
/// The payload must not come from the suspect, nor from a report of it, and payloads that are tried in turn add up as keys do.
pub fn verify(evidence: &Evidence, key: &Key, expected: Payload) -> Extraction {
    read(
        evidence,
        Reader::new(key, Some(expected), Input::Evidence),
        key,
    )
}

/// Reads a suspect in one go, ending as soon as it is sure: a marked model is mostly found before anything but itself was
/// measured. With `expected` the payload is tested as [`verify`] does it, else read as [`extract`] does.
pub fn detect(
    model: &[u8],
    files: &Files,
    key: &Key,
    expected: Option<Payload>,
    progress: &mut dyn Progress,
) -> Result<Extraction, Error> {
    step(progress, Stage::Read, 0.0)?;
    let mesh = Scene::gather(&Document::read(model, files)?)?.mesh;
    step(progress, Stage::Measure, 0.0)?;
    let ring = ring::Measurement::new(&mesh).read(key);
    step(progress, Stage::Measure, 0.5)?;
    let surfaces = solid::Surfaces::new(&mesh);
    step(progress, Stage::Test, 0.0)?;
    let solid = surfaces.read(key, progress)?;
    let conclusion = Reader::new(key, expected, Input::Model).conclude(&solid, &ring);
    step(progress, Stage::Test, 1.0)?;
    Ok(conclusion)
}

fn read(evidence: &Evidence, reader: Reader, key: &Key) -> Extraction {
    let solid = evidence.solid.read(key, &mut ignore).unwrap_or_default();
    reader.conclude(&solid, &evidence.ring.read(key))
}

/// A carrier's reading, and what else the verdict depends on. All bounds are charged for the carrier's own choices.
struct Reading {
    report: CarrierReading,
    /// Bound of the payload in the report.
    ln_p_payload: f64,
    /// Whether the suspect offers enough for a payload to be read, whatever key it is read with.
    is_enough: bool,
    /// What was decoded where another payload was expected.
    other: Option<Other>,
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
}

/// Logarithm of the number of payloads.
const LN_PAYLOADS: f64 = Payload::BITS as f64 * LN_2;

/// Logarithm of the number of carriers: one speaks for all, and which one is not known before.
const LN_CARRIERS: f64 = LN_2;
const _: () = assert!(Carrier::ALL.len() == 2);

pub(super) struct Reader {
    check: Checked,
    expected: Option<Payload>,
    input: Input,
    /// Logarithm of the number of keys that the suspect is read with.
    ln_num_keys: f64,
}

impl Reader {
    pub(super) fn new(key: &Key, expected: Option<Payload>, input: Input) -> Reader {
        Reader {
            check: Checked::new(key),
            expected,
            input,
            ln_num_keys: 0.0,
        }
    }

    /// The same with one key of so many, which are charged.
    fn one_of(self, num_keys: usize) -> Reader {
        Reader {
            ln_num_keys: libm::log(num_keys as f64),
            ..self
        }
    }

    pub(super) fn conclude(&self, solid: &carrier::Reading, ring: &carrier::Reading) -> Extraction {
        let carriers = [(Carrier::Solid, solid), (Carrier::Ring, ring)];
        let decoded = carriers.map(|(_, reading)| {
            likeliest(reading.hypotheses.iter().filter_map(|h| self.decode(h)))
        });
        // One model carries one payload of a key: the one that speaks loudest. What a carrier hears of it that decodes nothing, or
        // another one, does not count.
        let heard = decoded.iter().flatten();
        let payload = heard
            .min_by(|a, b| a.ln_p.total_cmp(&b.ln_p))
            .map(|loudest| loudest.payload);
        let mut decoded = decoded.into_iter();
        let readings = carriers.map(|(name, reading)| {
            let own = decoded.next().flatten();
            let own = own.filter(|own| Some(own.payload) == payload);
            self.read(name, reading, own, payload.is_some())
        });
        conclude(readings, self.input)
    }

    /// What a carrier says, of which a payload was decoded or not; and whether one was decoded of any.
    fn read(
        &self,
        name: Carrier,
        reading: &carrier::Reading,
        decoded: Option<Candidate>,
        is_any_decoded: bool,
    ) -> Reading {
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
        let charged = |h: &Hypothesis| union(pilots(&h.symbols).ln_p(), self.charge(h));
        let pilots = hypotheses.iter().map(charged).fold(0.0, f64::min);
        let ln_p_payload = candidate.as_ref().map_or(0.0, |candidate| candidate.ln_p);
        // A payload is named where chance is excluded, as the verdict is found: whoever learns a payload that chance gave, and
        // expects it from then on, no longer pays for having guessed it.
        let named = candidate
            .as_ref()
            .filter(|_| union(ln_p_payload, LN_CARRIERS) <= LN_P_FOUND);
        let payload = named.map(|candidate| candidate.payload);
        Reading {
            report: CarrierReading {
                name,
                ln_p: pilots.min(ln_p_payload),
                tag: payload.and_then(Payload::tag),
                number: payload.map(Payload::number),
                agreement: candidate.map_or(0.0, |candidate| candidate.all.agreement()),
                addresses: reading.num_addresses,
                owned_addresses: hypotheses
                    .iter()
                    .map(|h| h.symbols.len())
                    .max()
                    .unwrap_or(0),
            },
            ln_p_payload,
            is_enough: match name {
                // The verdict must not say which addresses are a key's. A key owns a share of them, and n of equal weight that agree
                // give ln p = -n: more is not to be hoped for.
                Carrier::Ring => {
                    let owned = reading.num_addresses as f64 / ring::SHARE as f64;
                    let charge = |h: &Hypothesis| self.ln_guesses() + self.charge(h) + LN_CARRIERS;
                    let first = hypotheses.first(); // all are charged alike
                    first.is_some_and(|h| charge(h) - owned <= LN_P_FOUND)
                }
                // A surface is read at a pitch or not at all, which no key has a part in; one that is read has 680 squared pitches or
                // more, and a window for each: some hundreds of nats, where a mark that can be found needs 70.
                Carrier::Solid => reading.num_addresses > 0,
            },
            other,
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
    /// the pilots alone and all symbols against a payload; where a payload is expected, also the symbols that are no pilots against
    /// it. Another payload than the expected one is found by none of them: that it is named where it passes with the pilots'
    /// share is a fourth event, which makes 1e-9 with the two that find.
    fn charge(&self, hypothesis: &Hypothesis) -> f64 {
        let tests = if self.expected.is_some() { 3.0 } else { 2.0 };
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
        })
    }
}

fn likeliest(candidates: impl Iterator<Item = Candidate>) -> Option<Candidate> {
    candidates.min_by(|a, b| a.ln_p.total_cmp(&b.ln_p))
}

fn pilots(symbols: &[SoftSymbol]) -> Statistic {
    let pilots = symbols.iter().filter(|soft| soft.symbol == Symbol::Pilot);
    Statistic::new(pilots.map(|soft| (soft.value, soft.weight)))
}

fn against(symbols: &[SoftSymbol], sign: impl Fn(Symbol) -> f64) -> Statistic {
    Statistic::new(
        symbols
            .iter()
            .map(|soft| (soft.value * sign(soft.symbol), soft.weight)),
    )
}

/// One verdict from all carriers' readings; the choice between carriers is charged. Below `found` the words hold nothing that
/// follows the key but the verdict.
fn conclude(readings: [Reading; Carrier::ALL.len()], input: Input) -> Extraction {
    let best = |ln_p: fn(&Reading) -> f64| {
        union(readings.iter().map(ln_p).fold(0.0, f64::min), LN_CARRIERS)
    };
    let ln_p_payload = best(|reading| reading.ln_p_payload);
    // The number beside a payload speaks for it: pilots speak for the key alone.
    let ln_p = if ln_p_payload <= LN_P_FOUND {
        ln_p_payload
    } else {
        best(|reading| reading.report.ln_p)
    };
    let [first, second] = &readings;
    let loudest = if second.ln_p_payload < first.ln_p_payload {
        second
    } else {
        first
    };
    let other = match (first.other, second.other) {
        (Some(a), Some(b)) if b.ln_p < a.ln_p => Some(b),
        (a, b) => a.or(b),
    };
    let ln_p_other = other.map_or(0.0, |other| union(other.ln_p, LN_CARRIERS));
    let CarrierReading {
        number, agreement, ..
    } = loudest.report;
    let tag = loudest.report.tag.clone();
    let other = other.filter(|_| ln_p_other <= LN_P_TRACE);
    let (verdict, reason) = if ln_p_payload <= LN_P_FOUND {
        (Verdict::Found, None)
    } else if other.is_some() {
        let reason = "The model carries a mark of this key, but with another payload.";
        (Verdict::Partial, Some(reason))
    } else if ln_p <= LN_P_TRACE {
        let reason =
            "Something of this key is there, but too little to read its payload with certainty.";
        (Verdict::Partial, Some(reason))
    } else if !readings.iter().any(|reading| reading.is_enough) {
        let reason = "The model has too few places for symbols to tell.";
        (Verdict::CannotCheck, Some(reason))
    } else {
        let reason = "This key's places for symbols agree as by chance.";
        (Verdict::None, Some(reason))
    };
    let mut reason = reason.map(str::to_owned);
    if let (Some(reason), Some(other)) = (&mut reason, other.filter(|_| ln_p_other <= LN_P_FOUND)) {
        let tag = other.payload.tag();
        reason.push_str(" It is ");
        reason.push_str(&tag.unwrap_or_else(|| other.payload.number().to_string()));
        reason.push('.');
    }
    Extraction {
        verdict,
        input,
        sentence: verdict.sentence(),
        reason,
        tag,
        number,
        details: Details {
            ln_p,
            agreement,
            carriers: readings.map(|reading| reading.report).into(),
        },
        shows_details: verdict == Verdict::Found,
    }
}
