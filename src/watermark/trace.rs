//! Tracing: whose copies a suspect was made of, if several mixed theirs too.
//!
//! Null hypothesis of a buyer: their copy had no part in the suspect. Their message, a keyed permutation of their number and the check bits
//! that follow, is then one of 2^60 that nothing else tells, and [`Likeness`] bounds the probability that its codeword agrees so well
//! with the suspect. Which ways of reading are followed may depend on all but messages, so the pilots choose; those that are
//! tested are charged, and so is every buyer.

use super::compare::{Blind, Compared, Informed, hear_with_original};
use super::error::Error;
use super::hearing::{Buyer, Hearing};
use super::judge::{Judge, Readings};
use super::loudest::Loudest;
use super::model::Model;
use super::overlay::Overlay;
use super::record::hear_with_record;
use super::report::{Comparison, Extraction, Input, Verdict};
use super::suspect::Suspect;
use super::testimony::Testimony;
use crate::carrier::{Carrier, Hypothesis, Reading};
use crate::code::Symbol;
use crate::detection::{LN_P_FOUND, Statistic};
use crate::evidence::Evidence;
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Progress, Stage};
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
    /// What each number was charged: the logarithm of the product of both, and of 2. Who is named beside others who were named before is charged
    /// more.
    pub ln_charge: f64,
    /// Triangles of the suspect; `None` for evidence.
    pub triangles: Option<usize>,
    /// What is read with the key alone.
    pub reading: Extraction,
    /// What is read with the original or the record, where there is one.
    pub comparison: Option<Comparison>,
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
    let leak = Leak::read(&mut suspect, key)?;
    leak.concluded(key, numbers, &mut suspect)
}

/// The same of evidence.
///
/// # Errors
/// [`Error::Payload`] for a number out of range.
pub fn trace_evidence(evidence: &Evidence, key: &Key, numbers: &[u64]) -> Result<Tracing, Error> {
    let read = |carrier| evidence.measurement(carrier).read_until(key, &is_loud);
    let readings = Carrier::STANDARD.map(read);
    let leak = Leak {
        testimonies: testimonies(&readings, &Loudest::default()),
        reading: Judge::new(key, None, Input::Evidence).conclude(&readings),
        triangles: None,
        comparison: None,
    };
    leak.tracing(key, numbers)
}

/// As [`trace`], with the original: the model as [`prepare`](super::prepare) or [`embed`](super::embed) got it. Buyers are named so who are named
/// by the suspect alone no more: of a piece with other triangles, a mirror image, a copy that was smoothed or simplified. Second comes the suspect laid
/// on the original, as from [`compare_overlaid`](super::compare_overlaid).
///
/// # Errors
/// As [`trace`], and where the original cannot be read.
pub fn trace_overlaid<'a, 'b>(
    suspect: impl Into<Suspect<'a>>,
    original: impl Into<Model<'b>>,
    key: &Key,
    numbers: &[u64],
) -> Result<(Tracing, Option<Overlay>), Error> {
    let mut suspect = suspect.into();
    let (leak, compared) = Leak::read_with_original(&mut suspect, &original.into(), key)?;
    let tracing = leak.concluded(key, numbers, &mut suspect)?;
    Ok((tracing, compared.overlaid().1))
}

/// As [`trace`], with the record of an embedding in the stead of the original, under the same key, whatever payload it was made with. The
/// suspect is laid on the recorded shape, as from [`compare_overlaid_with_record`](super::compare_overlaid_with_record).
///
/// # Errors
/// As [`trace`], and [`Error::Record`] as [`compare_with_record`](super::compare_with_record).
pub fn trace_overlaid_with_record<'a>(
    suspect: impl Into<Suspect<'a>>,
    record: &str,
    key: &Key,
    numbers: &[u64],
) -> Result<(Tracing, Option<Overlay>), Error> {
    let mut suspect = suspect.into();
    let (leak, compared) = Leak::read_with_record(&mut suspect, record, key)?;
    let tracing = leak.concluded(key, numbers, &mut suspect)?;
    Ok((tracing, compared.overlaid_on_record().1))
}

/// As [`trace`] for each of several ledgers, the suspect read once: for experiments, which of one suspect make many. With the original or the record where one is given.
///
/// # Errors
/// As the function for one ledger.
pub fn trace_all(
    suspect: Suspect,
    beside: Beside,
    key: &Key,
    ledgers: &[Vec<u64>],
) -> Result<Vec<Tracing>, Error> {
    let mut suspect = suspect;
    let leak = match beside {
        Beside::Nothing => Leak::read(&mut suspect, key)?,
        Beside::Original(original) => Leak::read_with_original(&mut suspect, &original, key)?.0,
        Beside::Record(record) => Leak::read_with_record(&mut suspect, record, key)?.0,
    };
    let ledgers = ledgers.iter();
    ledgers.map(|numbers| leak.tracing(key, numbers)).collect()
}

/// What is at hand beside the key and the ledgers.
pub enum Beside<'a> {
    /// Nothing.
    Nothing,
    /// The original.
    Original(Model<'a>),
    /// A record, as text.
    Record(&'a str),
}

/// What a suspect says of messages, before anybody is asked for.
struct Leak {
    testimonies: Vec<Testimony>,
    reading: Extraction,
    triangles: Option<usize>,
    comparison: Option<Comparison>,
}

impl Leak {
    fn read(suspect: &mut Suspect, key: &Key) -> Result<Leak, Error> {
        suspect.step(Stage::Read, 0.0)?;
        let mesh = suspect.mesh()?;
        suspect.step(Stage::Measure, 0.0)?;
        let readings = read_blind(&mesh, key, &is_loud, suspect)?;
        Ok(Leak {
            testimonies: testimonies(&readings, &Loudest::default()),
            reading: Judge::new(key, None, Input::Model).conclude(&readings),
            triangles: Some(mesh.triangles.len()),
            comparison: None,
        })
    }

    fn read_with_original(
        suspect: &mut Suspect,
        original: &Model,
        key: &Key,
    ) -> Result<(Leak, Compared), Error> {
        let mut loudest = Loudest::default();
        let informed = hear_with_original(suspect, original, key, None, Some(&mut loudest))?;
        Leak::informed(informed, &loudest, suspect, key)
    }

    fn read_with_record(
        suspect: &mut Suspect,
        record: &str,
        key: &Key,
    ) -> Result<(Leak, Compared), Error> {
        let mut loudest = Loudest::default();
        let informed = hear_with_record(suspect, record, key, None, Some(&mut loudest))?;
        Leak::informed(informed, &loudest, suspect, key)
    }

    /// With what was heard with the original or the record, and what is read blind, which has a half of the probability.
    fn informed(
        informed: Informed,
        loudest: &Loudest,
        suspect: &mut Suspect,
        key: &Key,
    ) -> Result<(Leak, Compared), Error> {
        let is_enough = |reading: &Reading| loudest.are_loud() || is_loud(reading);
        let readings = read_blind(&informed.suspect, key, &is_enough, suspect)?;
        let judge = Judge::new(key, None, Input::Model).one_of(2);
        let reading = judge.conclude(&readings);
        let triangles = Some(informed.suspect.triangles.len());
        let compared = informed.concluded(Some(Blind::of(&reading)));
        let leak = Leak {
            testimonies: testimonies(&readings, loudest),
            reading,
            triangles,
            comparison: Some(compared.comparison.clone()),
        };
        Ok((leak, compared))
    }

    fn concluded(
        &self,
        key: &Key,
        numbers: &[u64],
        suspect: &mut Suspect,
    ) -> Result<Tracing, Error> {
        let tracing = self.tracing(key, numbers)?;
        suspect.step(Stage::Test, 1.0)?;
        Ok(tracing)
    }

    fn tracing(&self, key: &Key, numbers: &[u64]) -> Result<Tracing, Error> {
        let numbers: BTreeSet<u64> = numbers.iter().copied().collect();
        let hearing = Hearing::new(&self.testimonies, key, &numbers)?;
        let buyers = hearing.named();
        let traced = match self.reading.verdict {
            _ if !buyers.is_empty() => Traced::Named,
            Verdict::Found | Verdict::Present => Traced::Nobody,
            Verdict::CannotCheck => Traced::CannotCheck,
            _ => Traced::NoMark,
        };
        let tracing = Tracing {
            traced,
            sentence: traced.sentence(),
            buyers,
            num_buyers: numbers.len(),
            num_ways: self.testimonies.len(),
            ln_charge: hearing.ln_charge(),
            triangles: self.triangles,
            reading: self.reading.clone(),
            comparison: None,
        };
        Ok(match &self.comparison {
            Some(comparison) => tracing.with(comparison),
            None => tracing,
        })
    }
}

fn read_blind(
    mesh: &Mesh,
    key: &Key,
    is_enough: &dyn Fn(&Reading) -> bool,
    progress: &mut dyn Progress,
) -> Result<Readings, Error> {
    let mut readings = Carrier::STANDARD.map(|_| Default::default());
    for carrier in Carrier::QUICKEST_FIRST {
        readings[carrier as usize] = carrier.read_until(mesh, key, is_enough, progress)?;
    }
    Ok(readings)
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

impl Tracing {
    /// Hears what is read with the original or the record.
    fn with(mut self, comparison: &Comparison) -> Tracing {
        let is_mark = matches!(comparison.verdict, Verdict::Found | Verdict::Present);
        match self.traced {
            Traced::Named | Traced::Nobody => {}
            _ if is_mark => {
                self.traced = Traced::Nobody;
                self.sentence = self.traced.sentence();
            }
            _ => {
                self.traced = Traced::NoMark;
                self.sentence = comparison.sentence;
            }
        }
        self.comparison = Some(comparison.clone());
        self
    }
}

/// What is tested: of each carrier and piece the way of reading in which the pilots agree best, and those that have none for they spent
/// them; with the original or a record, of each way to look at the suspect the loudest; and the loudest of several together.
fn testimonies(readings: &Readings, loudest: &Loudest) -> Vec<Testimony> {
    let mut all: Vec<Testimony> = readings.iter().flat_map(chosen).collect();
    let blind = Carrier::STANDARD.map(|carrier| loudest_of(&readings[carrier as usize]));
    let informed = loudest.testimonies();
    if let [Some(a), Some(b)] = &blind {
        all.push(Testimony::together(&[a, b]));
    }
    if let (Some(told), Some(ring)) = (informed.first(), &blind[Carrier::Ring as usize]) {
        all.push(Testimony::together(&[told, ring]));
    }
    all.extend(informed);
    all
}

/// Of a carrier's ways of reading, those that are tested alone.
fn chosen(reading: &Reading) -> Vec<Testimony> {
    let mut chosen: Vec<&Hypothesis> = Vec::new();
    for hypothesis in &reading.hypotheses {
        let place = match has_pilots(hypothesis) {
            true => chosen
                .iter()
                .position(|one| has_pilots(one) && one.piece == hypothesis.piece),
            false => None,
        };
        match place {
            Some(place) if pilots(chosen[place]).ln_p() <= pilots(hypothesis).ln_p() => {}
            Some(place) => chosen[place] = hypothesis,
            None => chosen.push(hypothesis),
        }
    }
    chosen.into_iter().map(Testimony::of_hypothesis).collect()
}

fn loudest_of(reading: &Reading) -> Option<Testimony> {
    let with_pilots = reading.hypotheses.iter().filter(|one| has_pilots(one));
    let best = with_pilots.min_by(|a, b| pilots(a).ln_p().total_cmp(&pilots(b).ln_p()));
    best.map(Testimony::of_hypothesis)
}

fn has_pilots(hypothesis: &Hypothesis) -> bool {
    let mut symbols = hypothesis.symbols.iter();
    symbols.any(|soft| soft.symbol == Symbol::Pilot)
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
