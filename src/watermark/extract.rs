//! Measuring a suspect, and reading evidence with a key.

use super::error::Error;
use super::report::{CarrierReading, Extraction, Verdict};
use crate::bits::Payload;
use crate::carrier::{self, Carrier, Hypothesis, ring, solid};
use crate::code::{Checked, Codeword, SoftSymbol, Symbol, decode};
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
    read(evidence, key, None)
}

/// Tests evidence for one payload that was expected before it was looked at.
///
/// A small p alone would say that the key is there, not that the payload is this one: copies of the same owner with other
/// payloads share the pilots and many parities. So the payload counts as found only where decoding gives it, or where
/// decoding gives none and the symbols other than pilots speak for it.
pub fn verify(evidence: &Evidence, key: &Key, expected: Payload) -> Extraction {
    read(evidence, key, Some(expected))
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
    let conclusion = Reader::new(key, expected).conclude(&solid, &ring);
    step(progress, Stage::Test, 1.0)?;
    Ok(conclusion)
}

fn read(evidence: &Evidence, key: &Key, expected: Option<Payload>) -> Extraction {
    let solid = evidence.solid.read(key, &mut ignore).unwrap_or_default();
    Reader::new(key, expected).conclude(&solid, &evidence.ring.read(key))
}

/// A carrier's reading, and what else the verdict depends on. All bounds are charged for the carrier's own choices.
struct Reading {
    report: CarrierReading,
    /// Bound of the payload in the report.
    ln_p_payload: f64,
    /// That bound if every symbol agreed.
    ln_p_at_best: f64,
    /// A payload that was decoded where another was expected.
    other: Option<Payload>,
}

/// A payload and what speaks for it.
struct Candidate {
    payload: Payload,
    /// All symbols against the payload.
    all: Statistic,
    /// Bound, all choices within the carrier charged.
    ln_p: f64,
}

pub(super) struct Reader {
    check: Checked,
    expected: Option<Payload>,
}

impl Reader {
    pub(super) fn new(key: &Key, expected: Option<Payload>) -> Reader {
        Reader {
            check: Checked::new(key),
            expected,
        }
    }

    pub(super) fn conclude(&self, solid: &carrier::Reading, ring: &carrier::Reading) -> Extraction {
        conclude(vec![
            self.read(Carrier::Solid, solid),
            self.read(Carrier::Ring, ring),
        ])
    }

    fn read(&self, name: Carrier, reading: &carrier::Reading) -> Reading {
        let hypotheses = &reading.hypotheses;
        let (candidate, other) = match (
            likeliest(hypotheses.iter().filter_map(|h| self.decode(h))),
            self.expected,
        ) {
            (Some(decoded), Some(expected)) if decoded.payload != expected => {
                (None, Some(decoded.payload))
            }
            (Some(decoded), _) => (Some(decoded), None),
            (None, Some(expected)) => (
                likeliest(hypotheses.iter().map(|h| self.fit(h, expected))),
                None,
            ),
            (None, None) => (None, None),
        };
        let best = |ln_p: &dyn Fn(&Hypothesis) -> f64| {
            let charged = hypotheses.iter().map(|h| union(ln_p(h), self.charge(h)));
            charged.fold(0.0, f64::min)
        };
        let pilots = best(&|h| pilots(&h.symbols).ln_p());
        let ln_p_payload = candidate.as_ref().map_or(0.0, |candidate| candidate.ln_p);
        // A payload is named where chance is excluded: among many candidates, a wrong one may pass its check bits.
        let named = candidate.as_ref().filter(|_| ln_p_payload <= LN_P_FOUND);
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
            ln_p_at_best: best(&|h| {
                against(&h.symbols, |_| 1.0).ln_p_at_best() + self.ln_guesses()
            }),
            other,
        }
    }

    /// Logarithm of the number of payloads that a reading chooses from.
    fn ln_guesses(&self) -> f64 {
        if self.expected.is_some() {
            0.0
        } else {
            f64::from(Payload::BITS) * LN_2
        }
    }

    /// What a hypothesis is charged: its own share, and the number of tests that are made of it. These are the pilots alone and
    /// all symbols against a payload; where a payload is expected, also the symbols that are no pilots against it.
    fn charge(&self, hypothesis: &Hypothesis) -> f64 {
        let tests = if self.expected.is_some() { 3.0 } else { 2.0 };
        hypothesis.ln_num_tests + libm::log(tests)
    }

    /// The likeliest payload whose check bits hold, if it stands out from what noise would give.
    fn decode(&self, hypothesis: &Hypothesis) -> Option<Candidate> {
        let (symbols, charge) = (&hypothesis.symbols, self.charge(hypothesis));
        let guess = f64::from(Payload::BITS) * LN_2;
        let statistic = |message| {
            let codeword = Codeword::new(message);
            against(symbols, |symbol| codeword.sign(symbol))
        };
        let stands_out = |all: &Statistic| union(all.ln_p() + guess, charge) <= LN_P_TRACE;
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

    /// The expected payload, held against the symbols that other payloads of the same key do not share.
    fn fit(&self, hypothesis: &Hypothesis, payload: Payload) -> Candidate {
        let codeword = Codeword::new(self.check.message(payload));
        let sign = |symbol| codeword.sign(symbol);
        let others = hypothesis
            .symbols
            .iter()
            .filter(|soft| soft.symbol != Symbol::Pilot);
        let ln_p =
            Statistic::new(others.map(|soft| (soft.value * sign(soft.symbol), soft.weight))).ln_p();
        Candidate {
            payload,
            all: against(&hypothesis.symbols, sign),
            ln_p: union(ln_p, self.charge(hypothesis)),
        }
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

/// One verdict from all carriers' readings; the choice between carriers is charged.
fn conclude(readings: Vec<Reading>) -> Extraction {
    let charge = libm::log(readings.len() as f64);
    let best =
        |ln_p: fn(&Reading) -> f64| union(readings.iter().map(ln_p).fold(0.0, f64::min), charge);
    let ln_p = best(|reading| reading.report.ln_p);
    let loudest = readings
        .iter()
        .min_by(|a, b| a.ln_p_payload.total_cmp(&b.ln_p_payload));
    let report = loudest.map(|reading| &reading.report);
    let other = readings.iter().find_map(|reading| reading.other);
    let ln_p_payload = best(|reading| reading.ln_p_payload);
    let tag = report.and_then(|report| report.tag.clone());
    let number = report.and_then(|report| report.number);
    let addresses: usize = readings
        .iter()
        .map(|reading| reading.report.addresses)
        .sum();
    let owned: usize = readings
        .iter()
        .map(|reading| reading.report.owned_addresses)
        .sum();
    let (verdict, reason) = if ln_p_payload <= LN_P_FOUND {
        (Verdict::Found, None)
    } else if let Some(other) = other {
        let other = other.tag().unwrap_or_else(|| other.number().to_string());
        (
            Verdict::Partial,
            Some(format!(
                "The model carries a mark of this key, but with another payload: {other}."
            )),
        )
    } else if ln_p <= LN_P_TRACE {
        let reason =
            "Something of this key is there, but too little to read its payload with certainty."
                .to_owned();
        (Verdict::Partial, Some(reason))
    } else if best(|reading| reading.ln_p_at_best) > LN_P_FOUND {
        let reason = format!(
            "The model offers {addresses} places for symbols, and {owned} of them are this key's: too few to tell."
        );
        (Verdict::CannotCheck, Some(reason))
    } else {
        let reason = format!(
            "{owned} of the model's {addresses} places for symbols are this key's: they agree as by chance."
        );
        (Verdict::None, Some(reason))
    };
    Extraction {
        verdict,
        sentence: verdict.sentence(),
        reason,
        tag,
        number,
        ln_p,
        agreement: report.map_or(0.0, |report| report.agreement),
        carriers: readings.into_iter().map(|reading| reading.report).collect(),
    }
}
