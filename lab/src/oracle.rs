//! What a detector gives away to whoever may ask it: forgers without the key send it suspects of their own making, hear reports alone,
//! and go on until a suspect is found.
//!
//! Suspects are lists of rings, one for each address: what RING measures of a fan of triangles whose tip is raised. SOLID sees nothing of them.

use crate::seed::Seed;
use meshmark::internals::carrier::{Measurement, ring};
use meshmark::internals::code::{Checked, Codeword, Symbol};
use meshmark::internals::key::{Prf, unit};
use meshmark::{Carrier, Evidence, Extraction, Key, Payload, Verdict, extract, verify};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Step of RING's quantizer (docs/FORMAT.md).
const STEP: f64 = 0.04;

/// Below which features RING's ways read: three by connectivity, three by geometry, four by position.
const CUTS: [f64; 10] = {
    let all = f64::INFINITY;
    [all, 0.12, 0.04, all, 0.12, 0.04, all, all, all, all]
};

/// A feature above RING's cuts, 0.12 and 0.04: of the ways by connectivity, it is read in one alone.
const ABOVE: f64 = 0.16;

/// Rings of a suspect with random features: a key owns some 50 pilots and 100 other symbols in each way, and the tail of so many is
/// nearly a normal distribution's. With more, questions take longer and hardly fewer are needed.
const RINGS: u64 = 600;

/// Features that are tried at an address: eighths of a step come within 0.92 of full agreement.
const PHASES: u64 = 8;

/// Owned addresses that the forger with details looks for: a third of them hold pilots.
const OWNED: usize = 300;

/// Features that the forger with details tries at an address: quarters of a step come within 0.7 of full agreement.
const QUARTERS: u32 = 4;

/// Rings by chance beside pilots.
const OTHERS: u64 = 24;

/// So many pilots that agree to 0.9 reach 73 nats: any payload whose check bits hold is then found, for the guess, the charges and 1e-9 take 58.
const PILOTS: usize = 90;

/// A forger gives up after so many questions: ten times what the slowest of twelve keys took.
const PATIENCE: u64 = 20_000_000;

/// A ring: the number that its addresses come from, and its feature.
#[derive(Clone, Copy)]
struct Ring {
    number: u64,
    feature: f64,
}

/// A suspect. With `lone`, its rings share their addresses by geometry and position.
fn suspect(rings: &[Ring], lone: Option<u64>) -> Evidence {
    let bytes = |ring: &Ring| {
        // Odd multipliers: different numbers have different addresses.
        let address = |number: u64, factor: u64| number.wrapping_mul(factor).to_le_bytes();
        let elsewhere = lone.unwrap_or(ring.number);
        let digit = |power: u32| (elsewhere / 1000u64.pow(power) % 1000) as i16 - 500;
        let mut bytes = address(ring.number, 0x9E37_79B9_7F4A_7C15).to_vec();
        bytes.extend(address(elsewhere, 0xBF58_476D_1CE4_E5B9));
        bytes.extend([0, 1, 2].map(digit).map(i16::to_le_bytes).concat());
        bytes.extend((ring.feature as f32).to_le_bytes());
        bytes
    };
    let bytes: Vec<u8> = rings.iter().flat_map(bytes).collect();
    Evidence::from_iter([Measurement::Ring(
        ring::Measurement::from_bytes(&bytes).expect("rings as they are stored"),
    )])
}

/// A detector that answers anybody, and counts what it was asked.
struct Detector {
    key: Key,
    expected: Payload,
    codeword: Codeword,
    questions: u64,
}

impl Detector {
    fn new(key: Key, expected: Payload) -> Detector {
        Detector {
            codeword: Codeword::new(Checked::new(&key).message(expected)),
            key,
            expected,
            questions: 0,
        }
    }

    fn verify(&mut self, rings: &[Ring], lone: Option<u64>) -> Extraction {
        self.questions += 1;
        verify(&suspect(rings, lone), &self.key, self.expected)
    }

    fn fits(&mut self, rings: &[Ring]) -> bool {
        matches!(
            self.verify(rings, None).verdict,
            Verdict::Partial | Verdict::Found
        )
    }

    fn is_found(&mut self, rings: &[Ring]) -> bool {
        self.verify(rings, None).verdict == Verdict::Found
    }

    /// Whether some payload is found where pilots agree and a few other rings say anything: one whose check bits hold by chance will do.
    fn is_found_among(&mut self, pilots: &[Ring], chance: &mut Chance) -> bool {
        self.questions += 1;
        let by_chance = (0..OTHERS).map(|place| Ring {
            number: (self.questions << 20) + place,
            feature: (chance.unit() - 0.5) * STEP,
        });
        let rings: Vec<Ring> = pilots.iter().copied().chain(by_chance).collect();
        extract(&suspect(&rings, None), &self.key).verdict == Verdict::Found
    }

    /// What the key owns of the rings below a number, each by itself.
    fn owned(&self, num_rings: u64) -> Vec<Owned> {
        let read = |number, feature| {
            suspect(&[Ring { number, feature }], None)
                .measurement(Carrier::Ring)
                .read_until(&self.key, &|_| false)
        };
        let mut owned = Vec::new();
        for number in 0..num_rings {
            let [first, second] = [0.0, STEP / 4.0].map(|feature| read(number, feature).hypotheses);
            for (way, (first, second)) in first.iter().zip(&second).enumerate() {
                for (first, second) in first.symbols.iter().zip(&second.symbols) {
                    let sign = self.codeword.sign(first.symbol);
                    owned.push(Owned {
                        ring: number as usize,
                        way,
                        is_pilot: first.symbol == Symbol::Pilot,
                        cos: sign * first.value,
                        sin: -sign * second.value,
                    });
                }
            }
        }
        owned
    }

    /// The same answer as [`fits`](Self::fits), in a tenth of the time where it is no: of rings by chance none is decoded, and neither
    /// pilots nor the other symbols come near the 13.3 nats that are asked of a way.
    fn fits_by_chance(&mut self, rings: &[Ring], owned: &[Owned]) -> bool {
        const NEAR: f64 = 13.0;
        let turns = |ring: &Ring| libm::sincos(TAU * ring.feature / STEP);
        let turns: Vec<(f64, f64)> = rings.iter().map(turns).collect();
        let mut sums = [[(0.0, 0.0); 2]; CUTS.len()];
        for owned in owned {
            if rings[owned.ring].feature.abs() < CUTS[owned.way] {
                let (sin, cos) = turns[owned.ring];
                let (sum, energy) = &mut sums[owned.way][usize::from(owned.is_pilot)];
                *sum += cos * owned.cos - sin * owned.sin;
                *energy += 1.0;
            }
        }
        let is_near = |(sum, energy): &(f64, f64)| *sum > 0.0 && sum * sum > NEAR * energy;
        if sums.iter().flatten().any(is_near) {
            return self.fits(rings);
        }
        self.questions += 1;
        false
    }
}

/// What a key makes of a ring's address in one way of reading: the cosine and the sine of its dither, times the symbol's sign.
struct Owned {
    ring: usize,
    way: usize,
    is_pilot: bool,
    cos: f64,
    sin: f64,
}

/// Random numbers of a forger.
struct Chance {
    prf: Prf,
    drawn: u64,
}

impl Chance {
    fn unit(&mut self) -> f64 {
        self.drawn += 1;
        unit(self.prf.at(self.drawn).0)
    }
}

/// Forges with the details of reports: whether an address is owned, and by ln p at which feature it agrees best. Where the feature
/// makes no difference, the address holds no pilot.
fn with_details(detector: &mut Detector, chance: &mut Chance) -> bool {
    let mut ask =
        |rings: &[Ring], lone| detector.verify(rings, Some(lone)).details().carriers[1].clone();
    let ring = |number, feature| Ring { number, feature };
    // An address by geometry and a place of which the key owns nothing.
    let lone = (0..).find(|&number| ask(&[ring(number, 0.0)], number).owned_addresses == 0);
    let lone = lone.expect("a key owns one address in four");
    let numbers = (1000..).filter(|&number| ask(&[ring(number, ABOVE)], lone).owned_addresses > 0);
    let owned: Vec<u64> = numbers.take(OWNED).collect();
    let mut rings: Vec<Ring> = Vec::new();
    while rings.is_empty() || ask(&rings, lone).ln_p == 0.0 {
        let features = owned.iter().map(|&n| ring(n, ABOVE + STEP * chance.unit()));
        rings = features.collect();
    }
    let mut pilots = Vec::new();
    for place in 0..rings.len() {
        let answers = (0..QUARTERS).map(|quarter| {
            let feature = ABOVE + STEP * f64::from(quarter) / f64::from(QUARTERS);
            rings[place].feature = feature;
            (ask(&rings, lone).ln_p, feature)
        });
        let mut answers: Vec<(f64, f64)> = answers.collect();
        answers.sort_by(|a, b| a.0.total_cmp(&b.0));
        rings[place].feature = answers[0].1;
        if answers[0].0 < answers[QUARTERS as usize - 1].0 {
            pilots.push(rings[place]);
        }
    }
    while detector.questions < PATIENCE {
        if detector.is_found_among(&pilots, chance) {
            return true;
        }
    }
    false
}

/// Forges with found, partial and none. Returns the questions until the first partial fit, if there was one.
fn with_verdicts(detector: &mut Detector, chance: &mut Chance) -> Option<(u64, bool)> {
    let owned = detector.owned(RINGS);
    let mut core: Vec<Ring> = Vec::new();
    while core.is_empty() || !detector.fits_by_chance(&core, &owned) {
        if detector.questions >= PATIENCE {
            return None;
        }
        let ring = |number| Ring {
            number,
            feature: (chance.unit() - 0.5) * STEP * 8.0,
        };
        core = (0..RINGS).map(ring).collect();
    }
    let until_partial = detector.questions;
    // What can be left out is no help; of what is left, every ring is owned and agrees.
    let mut is_smaller = true;
    while is_smaller {
        is_smaller = false;
        for place in (0..core.len()).rev() {
            let mut without = core.clone();
            without.remove(place);
            if detector.fits(&without) {
                core = without;
                is_smaller = true;
            }
        }
    }
    // A ring that makes up for one of these agrees as well as that one.
    let mut gained = core.clone();
    let mut fresh = RINGS;
    while detector.questions < PATIENCE {
        fresh += 1;
        let mut probe = core.clone();
        probe.remove(fresh as usize % core.len());
        for phase in 0..PHASES {
            let ring = Ring {
                number: fresh,
                feature: STEP * phase as f64 / PHASES as f64,
            };
            probe.push(ring);
            if detector.fits(&probe) {
                gained.push(ring);
                if detector.is_found(&gained) {
                    return Some((until_partial, true));
                }
                break;
            }
            probe.pop();
        }
        // Where it is pilots that fit, they say nothing of a payload: any whose check bits hold will do.
        if gained.len() >= PILOTS && detector.is_found_among(&gained, chance) {
            return Some((until_partial, true));
        }
    }
    Some((until_partial, false))
}

/// The table: for each key, the questions that forgers took.
pub fn table(seed: &Seed, num_keys: u64) -> String {
    let row = |index: u64| {
        let expected = seed.payload(&format!("oracle, payload {index}"));
        let detector = || Detector::new(seed.key("oracle", index), expected);
        let chance = || Chance {
            prf: seed.key("oracle, chance", index).prf("features"),
            drawn: 0,
        };
        let mut open = detector();
        let is_open_found = with_details(&mut open, &mut chance());
        let mut closed = detector();
        let ended = with_verdicts(&mut closed, &mut chance());
        let number = |is_found: bool, questions: u64| match is_found {
            true => questions.to_string(),
            false => format!("not within {questions}"),
        };
        let (partial, found) = match ended {
            Some((partial, is_found)) => (partial.to_string(), number(is_found, closed.questions)),
            None => (number(false, closed.questions), String::new()),
        };
        let details = number(is_open_found, open.questions);
        format!("| {} | {details} | {partial} | {found} |\n", index + 1)
    };
    let rows: Vec<String> = (0..num_keys).into_par_iter().map(row).collect();
    let mut text = String::from(
        "| key | with details: questions until found | with verdicts: until partial | until found |\n|--:|--:|--:|--:|\n",
    );
    text.extend(rows);
    let _ = writeln!(
        text,
        "\n`cargo xtask lab --oracle {num_keys} --seed {}`",
        seed.number
    );
    text
}
