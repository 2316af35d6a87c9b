//! Measuring a suspect, and reading it or its evidence with a key.

use super::error::Error;
use super::judge::Judge;
use super::report::{Extraction, FoundIn, Input};
use super::suspect::Suspect;
use crate::bits::Payload;
use crate::carrier::{Carrier, Reading};
use crate::evidence::Evidence;
use crate::key::Key;
use crate::mesh::{Edges, Mesh};
use crate::progress::{Cancelled, Progress, Stage};

/// Measures a suspect: everything that needs no key. What is measured once can be tested with as many keys as there are.
///
/// # Errors
/// Where the suspect cannot be read, or holds no triangles; [`Error::Cancelled`] where its progress was told to stop.
pub fn measure<'a>(suspect: impl Into<Suspect<'a>>) -> Result<Evidence, Error> {
    let mut suspect = suspect.into();
    suspect.step(Stage::Read, 0.0)?;
    let mesh = suspect.mesh()?;
    suspect.step(Stage::Measure, 0.0)?;
    let evidence = Evidence::of_mesh(&mesh);
    suspect.step(Stage::Measure, 1.0)?;
    Ok(evidence)
}

/// Reads a payload from evidence, knowing only the key. The bound charges all 2^48 payloads.
pub fn extract(evidence: &Evidence, key: &Key) -> Extraction {
    read(evidence, key, Judge::new(key, None, Input::Evidence))
}

/// Reads evidence with every key of a list, as [`extract`] does with one, and in their order.
///
/// That there are many is charged in everything that is said, verdicts and details: the probability that the mark of any
/// of them is wrongly found is at most 1e-9.
pub fn extract_many(evidence: &Evidence, keys: &[Key]) -> Vec<Extraction> {
    let one = |key| {
        let judge = Judge::new(key, None, Input::Evidence).one_of(keys.len());
        read(evidence, key, judge)
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
    let judge = Judge::new(key, Some(expected), Input::Evidence);
    read(evidence, key, judge)
}

fn read(evidence: &Evidence, key: &Key, judge: Judge) -> Extraction {
    let read = |carrier| {
        let is_settled = |reading: &Reading| judge.is_settled(reading);
        evidence.measurement(carrier).read_until(key, &is_settled)
    };
    judge.conclude(&Carrier::STANDARD.map(read))
}

/// Reads a suspect in one go, ending as soon as it is sure: a marked model is mostly found before anything but itself was
/// measured. With `expected` the payload is tested as [`verify`] does it, else read as [`extract`] does.
///
/// # Errors
/// As [`measure`].
pub fn detect<'a>(
    suspect: impl Into<Suspect<'a>>,
    key: &Key,
    expected: Option<Payload>,
) -> Result<Extraction, Error> {
    read_in_one_go(suspect.into(), key, expected, None, Carrier::read_until)
}

/// The same, and looks for what LOCAL marked too: it is found in a piece that was cut out, and then simplified or remeshed. That takes seconds.
/// LOCAL holds no payload: where it alone is found, the verdict is [`Verdict::Present`](super::Verdict::Present).
///
/// [`detect`] pays for this reading whether it is made or not, so who was told "no evidence" there may ask again here: both answers
/// together are wrong with a probability of 1e-9 at most.
///
/// # Errors
/// As [`measure`].
#[cfg(feature = "local")]
pub fn detect_with_local<'a>(
    suspect: impl Into<Suspect<'a>>,
    key: &Key,
    expected: Option<Payload>,
) -> Result<Extraction, Error> {
    read_in_one_go(
        suspect.into(),
        key,
        expected,
        Some(Carrier::Local),
        Carrier::read_until,
    )
}

/// Reads what was marked just now, also with a carrier that was asked for. A detector that undoes what may have been done to a copy finds
/// no less.
pub(super) fn read_back(
    copy: Suspect,
    key: &Key,
    asked: Option<Carrier>,
) -> Result<Extraction, Error> {
    read_in_one_go(copy, key, None, asked, Carrier::read_untouched)
}

/// How a carrier is read: [`Carrier::read_until`], or with less patience.
type Read = fn(
    Carrier,
    &Mesh,
    &Key,
    &dyn Fn(&Reading) -> bool,
    &mut dyn Progress,
) -> Result<Reading, Cancelled>;

/// Reads with the carriers that hold payloads, and with one that was asked for.
fn read_in_one_go(
    mut suspect: Suspect,
    key: &Key,
    expected: Option<Payload>,
    asked: Option<Carrier>,
    read: Read,
) -> Result<Extraction, Error> {
    suspect.step(Stage::Read, 0.0)?;
    let mesh = suspect.mesh()?;
    suspect.step(Stage::Measure, 0.0)?;
    let judge = Judge::new(key, expected, Input::Model);
    let mut readings = Carrier::STANDARD.map(|_| Default::default());
    for carrier in Carrier::QUICKEST_FIRST {
        let is_settled = |reading: &Reading| judge.is_settled(reading);
        readings[carrier as usize] = read(carrier, &mesh, key, &is_settled, &mut suspect)?;
    }
    let mut read_asked = |carrier: Carrier| {
        let reading = read(carrier, &mesh, key, &|_| false, &mut suspect);
        reading.map(|reading| (carrier, reading))
    };
    let asked = asked.map(&mut read_asked).transpose()?;
    let mut conclusion = judge.conclude_with(&readings, asked);
    let carriers = &conclusion.details().carriers;
    let piece = carriers.iter().find_map(|carrier| carrier.piece);
    conclusion.found_in = piece.and_then(|number| {
        let triangles = Carrier::piece(&mesh, number)?;
        let vertices = triangles.concat();
        let piece = Edges::new(&mesh.part(triangles));
        Some(FoundIn {
            name: suspect.name_of(&vertices),
            parts: piece.num_components(),
            of_parts: Edges::new(&mesh).num_components(),
        })
    });
    suspect.step(Stage::Test, 1.0)?;
    Ok(conclusion)
}
