//! What one way of reading says of every symbol: what was seen of it, and what each sign of it would have shown. All ways to look at a suspect come
//! to this, with the original or without it, so that they can be put together.
//!
//! None of it knows a message. So what is made of it here, however it is chosen, bounds what a message that had no part can do
//! (docs/SECURITY.md, "The bound of a tracing").

use crate::carrier::{Hypothesis, Place};
use crate::code::{Codeword, Likeness, SoftSymbol, Symbol};
use crate::detection::Statistic;

/// How well what was read of a suspect agrees with its mark, where no pilots are left to say it.
const USUAL_AGREEMENT: f64 = 0.75;

/// One symbol.
#[derive(Clone, Copy)]
struct Term {
    symbol: Symbol,
    seen: f64,
    /// What would have been seen, but for noise, of a symbol of -1, and of +1.
    expected: [f64; 2],
    /// Inverse of the noise's variance.
    precision: f64,
}

/// What one way of reading says.
#[derive(Clone)]
pub(super) struct Testimony(Vec<Term>);

/// How a copy may be mixed with others that are supposed to be there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mix {
    /// The mean of all.
    Mean,
    /// Each symbol is of one of them.
    Places,
}

impl Mix {
    pub const ALL: [Mix; 2] = [Mix::Mean, Mix::Places];
}

impl Testimony {
    /// Of a hypothesis of blind reading.
    pub fn of_hypothesis(hypothesis: &Hypothesis) -> Testimony {
        let symbols = &hypothesis.symbols;
        let pilots = symbols.iter().filter(|soft| soft.symbol == Symbol::Pilot);
        let pilots = Statistic::new(pilots.map(|soft| (soft.value, soft.weight)));
        let agreement = match pilots.agreement() {
            agreement if agreement > 0.0 => agreement,
            _ => USUAL_AGREEMENT,
        };
        let term = |soft: &SoftSymbol| {
            let expected = agreement * soft.weight;
            Term {
                symbol: soft.symbol,
                seen: soft.value,
                expected: [-expected, expected],
                // Weights are in the values already.
                precision: 1.0 / expected,
            }
        };
        let heard = symbols.iter().filter(|soft| soft.weight > 0.0);
        Testimony(heard.map(term).collect()).calibrated()
    }

    /// Of windows that were read with the original or a record. Pilots say which share of an error is seen; `None` where they say nothing.
    pub fn of_places(places: &[Place]) -> Option<Testimony> {
        let heard = || places.iter().filter(|place| place.response != 0.0);
        let pilots = heard().filter(|place| place.symbol == Symbol::Pilot);
        let pilots = pilots.map(|place| (place.response, place.errors[1]));
        let (mut product, mut squares, mut responses, mut num) = (0.0, 0.0, 0.0, 0.0);
        for (response, error) in pilots {
            product += response * error;
            squares += error * error;
            responses += response * response;
            num += 1.0;
        }
        let share = product / squares;
        let variance = (responses - share * product) / num;
        let precision = 1.0 / variance;
        let term = |place: &Place| Term {
            symbol: place.symbol,
            seen: place.response,
            expected: place.errors.map(|error| share * error),
            precision,
        };
        (share > 0.0 && precision.is_normal())
            .then(|| Testimony(heard().map(term).collect()).calibrated())
    }

    /// Several together.
    pub fn together(all: &[&Testimony]) -> Testimony {
        Testimony(all.iter().flat_map(|one| &one.0).copied().collect())
    }

    /// The same, with the noise that the pilots bear out: a term that is louder than they are as a whole is not believed more.
    fn calibrated(mut self) -> Testimony {
        let pilots = self.0.iter().filter(|term| term.symbol == Symbol::Pilot);
        let values = pilots.map(|term| term.value(&[], Mix::Mean));
        let (sum, squares) = values.fold((0.0, 0.0), |(sum, squares), value| {
            (sum + value, squares + value * value)
        });
        let unit = sum / squares;
        if unit.is_normal() && unit > 0.0 {
            self.0.iter_mut().for_each(|term| term.precision *= unit);
        }
        self
    }

    /// How surprising each message's agreement would be, where copies with other messages are supposed to be there.
    pub fn likeness(&self, supposed: &[&Codeword], mix: Mix) -> Likeness {
        let symbol = |term: &Term| {
            let value = term.value(supposed, mix);
            SoftSymbol {
                symbol: term.symbol,
                value,
                weight: value.abs(),
            }
        };
        Likeness::new(&self.0.iter().map(symbol).collect::<Vec<_>>())
    }
}

impl Term {
    /// By how much likelier than not a copy with a symbol of +1 makes what was seen: half of the logarithm of the ratio.
    fn value(&self, supposed: &[&Codeword], mix: Mix) -> f64 {
        let supposed = supposed.iter();
        let mut supposed = supposed.map(|codeword| self.expected_of(codeword.sign(self.symbol)));
        let [minus, plus] = match mix {
            Mix::Mean => {
                let (sum, num) = supposed.fold((0.0, 1.0), |(sum, num), expected| {
                    (sum + expected, num + 1.0)
                });
                self.expected
                    .map(|own| self.ln_likelihood((sum + own) / num))
            }
            Mix::Places => {
                // Far from what any of them would show, noise is larger than it seems: what is least far is what counts.
                let nearest = supposed.clone().chain(self.expected);
                let most = nearest.map(|expected| self.ln_likelihood(expected));
                let most = most.fold(f64::NEG_INFINITY, f64::max);
                let likelihood = |expected: f64| libm::exp(self.ln_likelihood(expected) - most);
                let others: f64 = supposed.by_ref().map(likelihood).sum();
                self.expected
                    .map(|own| libm::log((others + likelihood(own)).max(f64::MIN_POSITIVE)))
            }
        };
        0.5 * (plus - minus)
    }

    fn expected_of(&self, sign: f64) -> f64 {
        self.expected[usize::from(sign > 0.0)]
    }

    fn ln_likelihood(&self, expected: f64) -> f64 {
        let away = self.seen - expected;
        -0.5 * self.precision * away * away
    }
}
