//! Tracing: whose copies a suspect was made of, if several mixed theirs too.
//!
//! Null hypothesis of a buyer: their copy had no part in the suspect. Their message, a keyed permutation of their number and the check bits
//! that follow, is then one of 2^60 that nothing else tells, and [`Likeness`] bounds the probability that its codeword agrees so well
//! with the suspect. Which ways of reading are followed may depend on all but messages, so the pilots choose; those that are
//! tested are charged, and so is every buyer.

use super::error::Error;
use super::judge::{Judge, Readings};
use super::report::{Extraction, Input, Verdict};
use super::suspect::Suspect;
use crate::bits::Payload;
use crate::carrier::{Carrier, Hypothesis, Reading};
use crate::code::{Checked, Codeword, Likeness, Numbers, SoftSymbol, Symbol};
use crate::detection::{LN_P_FOUND, Statistic, union};
use crate::evidence::Evidence;
use crate::key::Key;
use crate::progress::Stage;
use serde::Serialize;
use std::collections::BTreeSet;

/// The answer to "whose copy is this?".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Traced {
    /// Some buyers are named: for any of them who had no part in it, the chance to be is at most 1e-9.
    Named,
    /// A mark of this key is there, and no copy of the ledger can be told from it.
    Nobody,
    /// No evidence of this key.
    NoMark,
    /// The model has too little geometry to answer.
    CannotCheck,
}

/// Whose copies a suspect was made of.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Tracing {
    /// The answer.
    pub traced: Traced,
    /// The answer in words.
    pub sentence: &'static str,
    /// Who is named, the most certain first.
    pub buyers: Vec<Buyer>,
    /// How many were asked for: distinct numbers.
    pub num_buyers: usize,
    /// How many ways of reading were tested.
    pub num_ways: usize,
    /// What every number that is told was charged: the logarithm of the product of both.
    pub ln_charge: f64,
    /// What is read with the key alone.
    pub reading: Extraction,
}

/// A buyer who is named.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Buyer {
    /// The number of the copy.
    pub number: u64,
    /// Natural logarithm of a bound of the probability that any buyer of the ledger who had no part in the suspect would be named so, every
    /// buyer and every way of reading charged.
    pub ln_p: f64,
}

/// Says whose copies a suspect was made of, among the numbers that were issued under a key: copies of one plan or of many.
///
/// Nobody is named whose bound is above 1e-9. The numbers have to be those of the ledger, written down before the suspect was looked at;
/// every one of them is charged, so a longer list says no more. It is no proof against who holds the key: they can stamp any number.
///
/// # Errors
/// As [`measure`](super::measure); [`Error::Payload`] for a number out of range.
pub fn trace<'a>(
    suspect: impl Into<Suspect<'a>>,
    key: &Key,
    numbers: &[u64],
) -> Result<Tracing, Error> {
    let mut suspect = suspect.into();
    suspect.step(Stage::Read, 0.0)?;
    let mesh = suspect.mesh()?;
    suspect.step(Stage::Measure, 0.0)?;
    let mut readings = Carrier::STANDARD.map(|_| Default::default());
    for carrier in Carrier::QUICKEST_FIRST {
        readings[carrier as usize] = carrier.read_until(&mesh, key, &is_loud, &mut suspect)?;
    }
    let tracing = conclude(&readings, key, numbers, Input::Model)?;
    suspect.step(Stage::Test, 1.0)?;
    Ok(tracing)
}

/// The same of evidence.
///
/// # Errors
/// [`Error::Payload`] for a number out of range.
pub fn trace_evidence(evidence: &Evidence, key: &Key, numbers: &[u64]) -> Result<Tracing, Error> {
    let read = |carrier| evidence.measurement(carrier).read_until(key, &is_loud);
    conclude(&Carrier::STANDARD.map(read), key, numbers, Input::Evidence)
}

/// Whether pilots speak so loudly that nothing has to be undone first.
fn is_loud(reading: &Reading) -> bool {
    let all = reading.hypotheses.iter();
    all.map(pilots)
        .any(|pilots| pilots.ln_p() <= 4.0 * LN_P_FOUND)
}

fn pilots(hypothesis: &Hypothesis) -> Statistic {
    let pilots = hypothesis.symbols.iter();
    let pilots = pilots.filter(|soft| soft.symbol == Symbol::Pilot);
    Statistic::new(pilots.map(|soft| (soft.value, soft.weight)))
}

fn conclude(
    readings: &Readings,
    key: &Key,
    numbers: &[u64],
    input: Input,
) -> Result<Tracing, Error> {
    let numbers: BTreeSet<u64> = numbers.iter().copied().collect();
    let reading = Judge::new(key, None, input).conclude(readings);
    let ways = ways(readings);
    let ln_charge =
        libm::log((numbers.len() * ways.len()).max(1) as f64) + ln_distinct(numbers.len());
    let (permutation, check) = (Numbers::new(key), Checked::new(key));
    let mut buyers = Vec::new();
    for number in &numbers {
        let codeword = Codeword::new(check.message(permutation.payload(*number)?));
        let bounds = ways.iter().map(|way| way.ln_p(&codeword));
        let ln_p = union(bounds.fold(0.0, f64::min), ln_charge);
        if ln_p <= LN_P_FOUND {
            buyers.push(Buyer {
                number: *number,
                ln_p,
            });
        }
    }
    buyers.sort_by(|a, b| a.ln_p.total_cmp(&b.ln_p));
    let traced = match reading.verdict {
        _ if !buyers.is_empty() => Traced::Named,
        Verdict::Found | Verdict::Present => Traced::Nobody,
        Verdict::CannotCheck => Traced::CannotCheck,
        _ => Traced::NoMark,
    };
    Ok(Tracing {
        traced,
        sentence: traced.sentence(),
        buyers,
        num_buyers: numbers.len(),
        num_ways: ways.len(),
        ln_charge,
        reading,
    })
}

/// Payloads are distinct: who knows all others' has so many fewer to choose from for one buyer's.
fn ln_distinct(num_buyers: usize) -> f64 {
    let all = (1u64 << Payload::BITS) as f64;
    -libm::log1p(-(num_buyers as f64 / all).min(0.5))
}

/// What is tested: of each carrier and piece the way of reading in which the pilots agree best, and those that have none for they spent
/// them; and the best of both carriers together.
fn ways(readings: &Readings) -> Vec<Likeness> {
    let mut chosen: Vec<&Hypothesis> = Vec::new();
    let mut together: Vec<SoftSymbol> = Vec::new();
    let mut num_together = 0;
    for reading in readings {
        let (mut loudest, mut in_piece) = (None, Vec::<&Hypothesis>::new());
        for hypothesis in &reading.hypotheses {
            let exponent = -pilots(hypothesis).ln_p();
            if !hypothesis
                .symbols
                .iter()
                .any(|soft| soft.symbol == Symbol::Pilot)
            {
                chosen.push(hypothesis);
                continue;
            }
            if loudest.is_none_or(|(most, _)| exponent > most) {
                loudest = Some((exponent, hypothesis));
            }
            let same = in_piece
                .iter_mut()
                .find(|one| one.piece == hypothesis.piece);
            match same {
                Some(best) if -pilots(best).ln_p() >= exponent => {}
                Some(best) => *best = hypothesis,
                None => in_piece.push(hypothesis),
            }
        }
        chosen.extend(in_piece);
        if let Some((_, hypothesis)) = loudest {
            // A carrier counts as much as its pilots agree.
            let share = pilots(hypothesis).agreement().max(0.0);
            let symbols = hypothesis.symbols.iter();
            together.extend(symbols.map(|soft| SoftSymbol {
                value: soft.value * share,
                ..*soft
            }));
            num_together += 1;
        }
    }
    let alone = chosen
        .iter()
        .map(|hypothesis| Likeness::new(&hypothesis.symbols));
    let together = (num_together > 1).then(|| Likeness::new(&together));
    alone.chain(together).collect()
}

impl Traced {
    /// The answer in words for a person.
    pub fn sentence(self) -> &'static str {
        match self {
            Traced::Named => {
                "Copies that were issued under these numbers are in this model, unless the ledger or the key was in other hands."
            }
            Traced::Nobody => {
                "Your mark is there, but none of the copies in the ledger can be told from it."
            }
            Traced::NoMark => {
                "No evidence of this key. This does not prove that the model is not yours."
            }
            Traced::CannotCheck => "Cannot check.",
        }
    }
}
