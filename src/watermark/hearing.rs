//! Who is named: every buyer of a ledger is tested, alone and beside those who seem to have mixed their copies with theirs.
//!
//! Under the null hypothesis of one buyer, all but their own message is given: the suspect, and who else is in it or seems to be. So a test may
//! take for granted that others had a part, whether they had or not, as long as their choice does not hear this buyer's message. Beside the right
//! ones a share is seen that is lost among theirs otherwise (docs/SECURITY.md, "The bound of a tracing").

use super::error::Error;
use super::testimony::{Mix, Testimony};
use crate::bits::Payload;
use crate::code::{Checked, Codeword, Likeness, Numbers};
use crate::detection::{LN_P_FOUND, union};
use crate::key::Key;
use serde::Serialize;
use std::collections::BTreeSet;
use std::f64::consts::{LN_2, LN_10};

/// Rounds of the hearing: in each, one buyer more is supposed to have had a part.
const MOST_ROUNDS: usize = 6;
/// Who is supposed to have had a part stands out among all buyers, at odds of 1 in 10: it decides what is heard, and proves nothing.
const LN_P_SUPPOSED: f64 = -LN_10;

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

/// All that is heard.
pub(super) struct Hearing<'a> {
    testimonies: &'a [Testimony],
    buyers: Vec<(u64, Codeword)>,
}

/// What is heard where some are supposed to have had a part.
struct Round {
    /// These, by their places in the list of buyers.
    supposed: Vec<usize>,
    /// Of every buyer, the best bound of all tests, which are charged, and all buyers.
    bounds: Vec<f64>,
}

impl<'a> Hearing<'a> {
    pub fn new(
        testimonies: &'a [Testimony],
        key: &Key,
        numbers: &BTreeSet<u64>,
    ) -> Result<Hearing<'a>, Error> {
        let (permutation, check) = (Numbers::new(key), Checked::new(key));
        let buyer = |&number: &u64| {
            let message = check.message(permutation.payload(number)?);
            Ok((number, Codeword::new(message)))
        };
        Ok(Hearing {
            testimonies,
            buyers: numbers.iter().map(buyer).collect::<Result<_, Error>>()?,
        })
    }

    /// What each number is charged at first.
    pub fn ln_charge(&self) -> f64 {
        self.ln_num_tests(self.testimonies.len()) + ln_rounds(0)
    }

    /// Who is named, the most certain first.
    pub fn named(&self) -> Vec<Buyer> {
        let rounds = self.rounds(Vec::new(), None);
        let supposed = rounds.last().map_or(&[][..], |round| &round.supposed);
        let mut named = Vec::new();
        for (place, (number, _)) in self.buyers.iter().enumerate() {
            let ln_p = match supposed.iter().position(|one| *one == place) {
                None => first(&rounds, place),
                // What came after this one was supposed heard their message, and is heard again without it.
                Some(position) => {
                    let before = &rounds[..=position];
                    first(before, place).or_else(|| {
                        let supposed = before[position].supposed.clone();
                        first(&self.rounds(supposed, Some(place)), place)
                    })
                }
            };
            named.extend(ln_p.map(|ln_p| Buyer {
                number: *number,
                ln_p,
            }));
        }
        named.sort_by(|a, b| a.ln_p.total_cmp(&b.ln_p));
        named
    }

    /// Round after round from those who are supposed, each with the loudest of all others, until nobody else stands out; as if one buyer were not in the ledger.
    fn rounds(&self, supposed: Vec<usize>, except: Option<usize>) -> Vec<Round> {
        let mut rounds = vec![self.round(supposed)];
        while let [.., last] = rounds.as_slice()
            && last.supposed.len() + 1 < MOST_ROUNDS
        {
            let others = last.bounds.iter().enumerate();
            let others = others
                .filter(|(place, _)| !last.supposed.contains(place) && Some(*place) != except);
            let loudest = others.min_by(|a, b| a.1.total_cmp(b.1));
            let Some((place, _)) = loudest.filter(|(_, bound)| **bound <= LN_P_SUPPOSED) else {
                break;
            };
            let supposed = [last.supposed.as_slice(), &[place]].concat();
            rounds.push(self.round(supposed));
        }
        rounds
    }

    fn round(&self, supposed: Vec<usize>) -> Round {
        let tests = self.tests(&supposed);
        let ln_num_tests = self.ln_num_tests(tests.len());
        let bounds = self.bounds(&tests);
        let bounds = bounds.map(|bound| union(bound, ln_num_tests)).collect();
        Round { supposed, bounds }
    }

    /// What is tested of each buyer, where some are supposed to have had a part.
    fn tests(&self, supposed: &[usize]) -> Vec<Likeness> {
        let codewords: Vec<&Codeword> = supposed
            .iter()
            .map(|&place| &self.buyers[place].1)
            .collect();
        // Where nobody else is supposed, both ways to mix are one.
        let mixes = match supposed {
            [] => &[Mix::Mean],
            _ => &Mix::ALL[..],
        };
        let each = self.testimonies.iter().flat_map(|testimony| {
            let tests = mixes.iter();
            tests.map(|&mix| testimony.likeness(&codewords, mix))
        });
        each.collect()
    }

    /// Of every buyer, the best bound of some tests, before charges.
    fn bounds(&self, tests: &[Likeness]) -> impl Iterator<Item = f64> {
        self.buyers.iter().map(|(_, codeword)| {
            let bounds = tests.iter().map(|test| test.ln_p(codeword));
            bounds.fold(0.0, f64::min)
        })
    }

    /// The logarithm of how many tests all buyers come to.
    fn ln_num_tests(&self, num_each: usize) -> f64 {
        let num_buyers = self.buyers.len();
        libm::log((num_buyers * num_each).max(1) as f64) + ln_distinct(num_buyers)
    }
}

/// The bound of the first round that names a buyer.
fn first(rounds: &[Round], place: usize) -> Option<f64> {
    let bounds = rounds
        .iter()
        .map(|round| union(round.bounds[place], ln_rounds(round.supposed.len())));
    bounds.into_iter().find(|ln_p| *ln_p <= LN_P_FOUND)
}

/// The first round has half of the probability, the second a quarter, and so on.
fn ln_rounds(num_supposed: usize) -> f64 {
    (num_supposed + 1) as f64 * LN_2
}

/// Payloads are distinct: who knows all others' has so many fewer to choose from for one buyer's.
fn ln_distinct(num_buyers: usize) -> f64 {
    let all = (1u64 << Payload::BITS) as f64;
    -libm::log1p(-(num_buyers as f64 / all).min(0.5))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::*;
    use crate::carrier::Place;
    use crate::code::Symbol;
    use crate::key::unit;
    use glam::DVec3;

    const NUM_BUYERS: u64 = 20_000;

    fn key() -> Key {
        Key::from_bytes(&[9; Key::BYTES]).unwrap()
    }

    fn codeword(number: u64) -> Codeword {
        let payload = Numbers::new(&key()).payload(number).unwrap();
        Codeword::new(Checked::new(&key()).message(payload))
    }

    /// What windows show of a mean of copies.
    fn testimony(num_windows: u64, guilty: &[u64], noise: f64) -> Testimony {
        let prf = key().prf("test");
        let guilty: Vec<Codeword> = guilty.iter().map(|&number| codeword(number)).collect();
        let place = |index: u64| {
            let ((choice, error), (a, b)) = (prf.at(2 * index), prf.at(2 * index + 1));
            let error = unit(error) - 0.5;
            let errors = [
                error,
                if error > 0.0 {
                    error - 0.5
                } else {
                    error + 0.5
                },
            ];
            let symbol = Symbol::select(choice);
            let shown = guilty
                .iter()
                .map(|codeword| errors[usize::from(codeword.sign(symbol) > 0.0)]);
            let shown = shown.sum::<f64>() / guilty.len() as f64;
            Place {
                symbol,
                response: 0.1 * (shown + noise * (unit(a) + unit(b) - 1.0)),
                errors,
                centre: DVec3::ZERO,
            }
        };
        let places: Vec<Place> = (0..num_windows).map(place).collect();
        Testimony::of_places(&places).unwrap()
    }

    fn named(testimony: Testimony) -> Vec<u64> {
        let testimonies = [testimony];
        let numbers = (1..=NUM_BUYERS).collect();
        let hearing = Hearing::new(&testimonies, &key(), &numbers).unwrap();
        let mut named: Vec<u64> = hearing.named().iter().map(|buyer| buyer.number).collect();
        named.sort_unstable();
        named
    }

    /// The bound against what chance gives: of many buyers who had no part, no larger share is below a probability than that, alone or beside others,
    /// whether these had a part or not.
    #[test]
    fn bounds_hold_for_buyers_who_had_no_part() {
        let testimonies = [testimony(600, &[1, 2], 1.0)];
        let numbers = (1..=NUM_BUYERS).collect();
        let hearing = Hearing::new(&testimonies, &key(), &numbers).unwrap();
        for supposed in [&[][..], &[0], &[0, 1], &[0, 1, 2, 3], &[7, 8]] {
            for test in hearing.tests(supposed) {
                let bounds: Vec<f64> = hearing.bounds(&[test]).collect();
                for ln_p in [-1.0, -2.0, -4.0, -6.0, -8.0] {
                    let below = bounds[9..].iter().filter(|bound| **bound <= ln_p).count();
                    let share = below as f64 / (NUM_BUYERS - 9) as f64;
                    assert!(
                        share <= libm::exp(ln_p),
                        "{share} of {ln_p} beside {supposed:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn who_mixes_is_heard_beside_others() {
        let guilty = [3, 700, 15_000];
        // Alone, the copies of three drown each other; beside the others, each is heard.
        assert_eq!(named(testimony(700, &guilty, 0.4)), guilty);
        assert_eq!(named(testimony(700, &guilty[..1], 0.4)), guilty[..1]);
    }
}
