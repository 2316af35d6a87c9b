//! The paper's Fig. 5: how often bits are wrong, for random and for chosen hosts, against the smoothing and against the strength,
//! before the codes and after; and the same for each way of finding hosts again.

use super::chain::Chain;
use super::smoothing::Smoothing;
use super::spherical::{Barycentre, Spherical};
use super::spread::Spread;
use super::stability::{Ranking, rank};
use crate::carrier::CarrierError;
use crate::carrier::direction::{CellReading, Cells};
use crate::code::{Block, TextCheck};
use crate::geometry::diagonal;
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Progress, Stage, step};
use crate::random::Random;
use serde::Serialize;
use std::ops::Range;

/// The strengths of Fig. 5: RMS displacements over all vertices, as fractions of the diagonal.
pub const STRENGTHS: [f64; 5] = [1e-4, 2e-4, 4e-4, 8e-4, 16e-4];

/// The strength at which smoothings are compared.
pub const STRENGTH: f64 = 8e-4;

/// The code of the study: 64 bits, so about a thousand hosts, as the paper has.
const BLOCK: Block = Block::Tc128;

/// Which vertices hold the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Hosts {
    /// Any, and others for each key.
    Random,
    /// The most stable, by a ranking.
    Ranked(Ranking),
    /// All of them, each the bit of its direction.
    All,
}

impl Hosts {
    /// Random hosts, those of every ranking, and all.
    pub fn every() -> impl Iterator<Item = Hosts> {
        let ranked = Ranking::ALL.into_iter().map(Hosts::Ranked);
        std::iter::once(Hosts::Random)
            .chain(ranked)
            .chain([Hosts::All])
    }

    /// The name that scripts and pages use: of a ranking its own.
    pub fn name(self) -> &'static str {
        match self {
            Hosts::Random => "random",
            Hosts::Ranked(ranking) => ranking.name(),
            Hosts::All => "all",
        }
    }
}

/// How the hosts are found again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Finding {
    /// Their new indices are known: the paper's assumption.
    Traced,
    /// The suspect is ranked again.
    Ranked,
    /// The original is known.
    Original,
    /// By their direction in the suspect's own frame.
    Cells,
}

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Which vertices hold the message.
    pub hosts: Hosts,
    /// What distances are measured from; cells have a frame of their own.
    pub barycentre: Barycentre,
    /// RMS displacement over all vertices, as a fraction of the diagonal.
    pub strength: f64,
    /// What happens to the marked mesh.
    pub smoothing: Smoothing,
    /// How often.
    pub iterations: u32,
}

/// The errors of one case and one way of finding, over all keys.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Errors {
    /// Which vertices held the message: [`Hosts::name`].
    pub hosts: &'static str,
    /// How they were found again.
    pub finding: Finding,
    /// What distances were measured from.
    pub barycentre: Barycentre,
    /// RMS displacement over all vertices, as a fraction of the diagonal.
    pub strength: f64,
    /// What happened to the marked mesh.
    pub smoothing: Smoothing,
    /// How often.
    pub iterations: u32,
    /// Share of the symbols with the wrong sign, before any code; 0.5 is chance. Of cells: of the code's bits.
    pub raw: Spread,
    /// Share of the message's 64 bits that are wrong after decoding; 0.5 is chance.
    pub payload: Spread,
    /// Share of the keys whose text was read without an error, and known to be right by its check bits.
    pub read: f64,
}

/// Both halves of Fig. 5.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Figure5 {
    /// MeshSmooth 0, 1 and 2 at [`STRENGTH`].
    pub against_smoothing: Vec<Errors>,
    /// MeshSmooth 1 at [`STRENGTHS`].
    pub against_strength: Vec<Errors>,
}

/// Fig. 5 for a mesh, over keys, messages and random draws, each with a number for its seed. The paper's barycentre is that of the
/// vertices.
pub fn figure_5(
    mesh: &Mesh,
    barycentre: Barycentre,
    keys: Range<u64>,
    progress: &mut dyn Progress,
) -> Result<Figure5, CarrierError> {
    let case = |hosts, iterations, strength| Case {
        hosts,
        barycentre,
        strength,
        smoothing: Smoothing::MeshSmooth,
        iterations,
    };
    let against_smoothing =
        (0..=2).flat_map(|rounds| Hosts::every().map(move |hosts| case(hosts, rounds, STRENGTH)));
    let against_strength = STRENGTHS
        .into_iter()
        .flat_map(|strength| Hosts::every().map(move |hosts| case(hosts, 1, strength)));
    Ok(Figure5 {
        against_smoothing: each(mesh, against_smoothing.collect(), keys.clone(), progress)?,
        against_strength: each(mesh, against_strength.collect(), keys, progress)?,
    })
}

/// The same for every smoothing, once and twice, at [`STRENGTH`].
pub fn smoothings(
    mesh: &Mesh,
    barycentre: Barycentre,
    keys: Range<u64>,
    progress: &mut dyn Progress,
) -> Result<Vec<Errors>, CarrierError> {
    let mut cases = Vec::new();
    for smoothing in Smoothing::ALL {
        for iterations in 1..=2 {
            cases.extend(Hosts::every().map(|hosts| Case {
                hosts,
                barycentre,
                strength: STRENGTH,
                smoothing,
                iterations,
            }));
        }
    }
    each(mesh, cases, keys, progress)
}

fn each(
    mesh: &Mesh,
    cases: Vec<Case>,
    keys: Range<u64>,
    progress: &mut dyn Progress,
) -> Result<Vec<Errors>, CarrierError> {
    let mut all = Vec::new();
    for (number, case) in cases.iter().enumerate() {
        let done = number as f64 / cases.len() as f64;
        let mut within = |stage, _| progress.report(stage, done);
        all.extend(errors(mesh, case, keys.clone(), &mut within)?);
    }
    Ok(all)
}

/// Embeds a message for each key, smooths, and reads it in every way that these hosts can be found.
pub fn errors(
    mesh: &Mesh,
    case: &Case,
    keys: Range<u64>,
    progress: &mut dyn Progress,
) -> Result<Vec<Errors>, CarrierError> {
    let ranked = match case.hosts {
        Hosts::Ranked(ranking) => rank(mesh, ranking).order,
        _ => Vec::new(),
    };
    let num_keys = keys.end.saturating_sub(keys.start) as f64;
    let mut outcomes = Vec::new();
    for (number, key) in keys.enumerate() {
        step(progress, Stage::Test, number as f64 / num_keys)?;
        let trial = Trial::new(key);
        outcomes.extend(match case.hosts {
            Hosts::All => vec![trial.in_cells(mesh, case)?],
            Hosts::Random => {
                let order = Random::new(key).permutation(mesh.positions.len());
                trial.in_hosts(mesh, &order, None, case)?
            }
            Hosts::Ranked(ranking) => trial.in_hosts(mesh, &ranked, Some(ranking), case)?,
        });
    }
    let mut findings: Vec<Finding> = outcomes.iter().map(|outcome| outcome.finding).collect();
    findings.sort_unstable();
    findings.dedup();
    let summed = findings
        .into_iter()
        .map(|finding| case.sum(finding, &outcomes));
    Ok(summed.collect())
}

impl Case {
    /// What all trials say of one way of finding.
    fn sum(&self, finding: Finding, outcomes: &[Outcome]) -> Errors {
        let of = |value: fn(&Outcome) -> f64| {
            let here = outcomes.iter().filter(|outcome| outcome.finding == finding);
            Spread::of(&here.map(value).collect::<Vec<f64>>())
        };
        Errors {
            hosts: self.hosts.name(),
            finding,
            barycentre: self.barycentre,
            strength: self.strength,
            smoothing: self.smoothing,
            iterations: self.iterations,
            raw: of(|outcome| outcome.raw),
            payload: of(|outcome| outcome.payload),
            read: of(|outcome| f64::from(u8::from(outcome.is_read))).mean,
        }
    }
}

/// A key, and a text of five letters under it.
struct Trial {
    key: Key,
    check: TextCheck,
    message: Vec<u8>,
}

/// What one trial says of one way of finding.
struct Outcome {
    finding: Finding,
    raw: f64,
    payload: f64,
    is_read: bool,
}

impl Trial {
    fn new(number: u64) -> Trial {
        let mut random = Random::new(number);
        let bytes: Vec<u8> = (0..Key::BYTES).map(|_| random.bits() as u8).collect();
        let key = Key::from_bytes(&bytes).expect("a key has as many bytes");
        let letters =
            (0..BLOCK.text_bytes()).map(|_| char::from(b'a' + (random.bits() % 26) as u8));
        let check = TextCheck::new(&key);
        let message = check.message(&letters.collect::<String>(), BLOCK);
        Trial {
            message: message.expect("the text is as long as the block holds"),
            check,
            key,
        }
    }

    fn in_hosts(
        &self,
        mesh: &Mesh,
        order: &[u32],
        ranking: Option<Ranking>,
        case: &Case,
    ) -> Result<Vec<Outcome>, CarrierError> {
        let chain = Chain {
            key: &self.key,
            block: BLOCK,
            barycentre: case.barycentre,
        };
        let embedded = chain.embed(mesh, order, &self.message, case.strength)?;
        let hosts = &order[..Chain::num_hosts(BLOCK)];
        let suspect = case.smoothing.apply(&embedded.mesh, case.iterations);
        // No smoothing gives a vertex another index.
        let traced: Vec<Option<u32>> = hosts.iter().map(|&host| Some(host)).collect();
        let step = embedded.step;
        let ways = [
            (Finding::Traced, chain.read_traced(&suspect, &traced, step)),
            (
                Finding::Ranked,
                ranking.and_then(|ranking| chain.read_ranked(&suspect, ranking, step)),
            ),
            (
                Finding::Original,
                chain.read_with_original(&suspect, mesh, hosts, step),
            ),
        ];
        let read = ways.into_iter().filter_map(|(finding, read)| {
            let received = read?;
            let (raw, _) = received.symbol_errors(&embedded.symbols);
            Some(self.outcome(finding, raw, &received.decoded.message))
        });
        Ok(read.collect())
    }

    fn in_cells(&self, mesh: &Mesh, case: &Case) -> Result<Outcome, CarrierError> {
        let size = Spherical::of(mesh, Barycentre::Volume).map_or(1.0, |volume| volume.scale);
        // Every vertex moves by an error that is uniform over a step.
        let step = case.strength * diagonal(&mesh.positions) / size * 12f64.sqrt();
        let cells = Cells::new(&self.key, BLOCK, step);
        let displacement = cells.embed(mesh, &self.message)?;
        let moved = mesh.positions.iter().zip(displacement).map(|(p, d)| *p + d);
        let marked = mesh.with_positions(moved.collect());
        let suspect = case.smoothing.apply(&marked, case.iterations);
        let readings = cells.read(&suspect);
        let is_right = |message: &[u8]| self.check.text(message).is_some();
        let right = readings
            .iter()
            .find_map(|reading| Some((reading, reading.message(is_right)?)));
        let best = || {
            let codewords = readings
                .iter()
                .filter(|reading| reading.decoded.is_codeword);
            codewords.chain(&readings).next()
        };
        let word = BLOCK.encode(&self.message);
        let wrong = |reading: &CellReading| {
            let pairs = reading.evidence.iter().zip(&word);
            let wrong = pairs.filter(|(evidence, bit)| (**evidence < 0.0) != **bit);
            wrong.count() as f64 / word.len() as f64
        };
        let outcome = right.or_else(|| best().map(|best| (best, best.decoded.message.clone())));
        let (raw, message) = outcome.map_or((0.5, Vec::new()), |(reading, message)| {
            (wrong(reading), message)
        });
        Ok(self.outcome(Finding::Cells, raw, &message))
    }

    fn outcome(&self, finding: Finding, raw: f64, message: &[u8]) -> Outcome {
        let pairs = self.message.iter().zip(message);
        let wrong: u32 = pairs.map(|(sent, read)| (sent ^ read).count_ones()).sum();
        // Of bits that were not read at all, half would be right by chance.
        let missing = 8 * (self.message.len() - message.len().min(self.message.len()));
        let bits = 8 * self.message.len();
        Outcome {
            finding,
            raw,
            payload: (f64::from(wrong) + 0.5 * missing as f64) / bits as f64,
            is_read: message == self.message && self.check.text(message).is_some(),
        }
    }
}
