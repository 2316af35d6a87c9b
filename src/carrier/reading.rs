//! What a key makes of a measurement.

use crate::code::{Codeword, SoftSymbol};
use crate::detection::Statistic;

/// How a key reads a measurement.
#[derive(Default)]
pub struct Reading {
    /// The ways of reading that were followed, for the others had nothing to say.
    pub hypotheses: Vec<Hypothesis>,
    /// Distinct addresses that were there to be read, whoever's they are.
    pub num_addresses: usize,
}

impl Reading {
    /// The exponent of the bound for a codeword that is known, in the hypothesis that it fits best, before charges.
    pub fn exponent(&self, codeword: &Codeword) -> f64 {
        let fit = |hypothesis: &Hypothesis| {
            let symbols = hypothesis.symbols.iter();
            let signed = symbols.map(|soft| (soft.value * codeword.sign(soft.symbol), soft.weight));
            -Statistic::new(signed).ln_p()
        };
        self.hypotheses.iter().map(fit).fold(0.0, f64::max)
    }
}

/// One way of reading a measurement: its soft symbols.
pub struct Hypothesis {
    /// One for each address that is the key's.
    pub symbols: Vec<SoftSymbol>,
    /// What this way of reading is charged: the logarithm of the inverse of its share in the probability of a false alarm.
    /// The shares of all ways that were declared before any key was known add up to 1 at most.
    pub ln_num_tests: f64,
    /// Which piece of the suspect is read: 0 is the whole, 1 the first of those that are read alone.
    pub piece: usize,
}
