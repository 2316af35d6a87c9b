//! What a key makes of a measurement, and of a suspect that lies on its original.

use crate::code::{Codeword, SoftSymbol, Symbol};
use crate::detection::Statistic;
use glam::DVec3;

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

/// One address of an original, as a suspect that lies on it shows it: a window of SOLID's, a ring of RING's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// What it holds.
    pub symbol: Symbol,
    /// What the suspect shows of it, or how much it counts: knows nothing of its dither.
    pub response: f64,
    /// For a symbol of -1, and of +1: of a window by how much of a step the embedder had to move it, of a ring how near its feature is to the
    /// symbol's lattice. -1/2 to 1/2, uniform to who has no key.
    pub errors: [f64; 2],
    /// Its centre, in the original's scene units.
    pub centre: DVec3,
}

/// One way of reading a suspect that lies on its original.
#[derive(Clone)]
pub struct Way {
    /// Places, each of an address of its own.
    pub places: Vec<Place>,
    /// What this way is charged: the shares of all that were declared add up to 1 at most.
    pub ln_num_tests: f64,
    /// Which of the ways in which the suspect may lie on the host it is of.
    pub list: usize,
    /// Of the places, in the original's scene units.
    pub radius: f64,
}
