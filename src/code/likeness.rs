//! How surprising it is that a message agrees with soft symbols, against all messages there are: exact, whatever the symbols are.
//!
//! For a message drawn from all 2^60 alike, the sum of soft values times the signs of its codeword has a moment generating function that
//! one pass through the code's trellis gives, 68 steps of 256 states. Chernoff's bound makes of it the probability of a sum that
//! large. Nothing is supposed of the symbols: where they come from, who made them and how they were chosen does not matter, as long as
//! the message had no part in it.

use super::convolutional::{Codeword, MESSAGE_BITS, Trellis};
use super::{SoftSymbol, Symbol};
use std::f64::consts::LN_2;

/// The bound is the best of so many exponents of Chernoff's, each so many times the one before. Between two of them less than a
/// hundredth of it is lost.
const EXPONENTS: usize = 28;
const RATIO: f64 = 1.2;
/// The first of them, in units of the inverse RMS sum of random signs.
const FIRST: f64 = 0.25;

/// The least logarithm of a probability that can be told: that of one message of all.
pub const LEAST_LN_P: f64 = -(MESSAGE_BITS as f64) * LN_2;

/// What soft symbols say about messages.
pub struct Likeness {
    trellis: Trellis,
    /// Chernoff's exponents, and the logarithm of the moment generating function at each.
    moments: Vec<(f64, f64)>,
}

impl Likeness {
    /// Of symbols; pilots, which agree with every message, are left out.
    pub fn new(symbols: &[SoftSymbol]) -> Likeness {
        let trellis = Trellis::new(symbols);
        let data = symbols.iter().filter(|soft| soft.symbol != Symbol::Pilot);
        let energy: f64 = data.map(|soft| soft.value * soft.value).sum();
        let mut moments = Vec::new();
        if energy.is_normal() {
            let mut exponent = FIRST / energy.sqrt();
            for _ in 0..EXPONENTS {
                moments.push((exponent, trellis.ln_moment(exponent)));
                exponent *= RATIO;
            }
        }
        Likeness { trellis, moments }
    }

    /// Natural logarithm of a bound of the probability that a message drawn from all alike agrees as well as this one.
    pub fn ln_p(&self, codeword: &Codeword) -> f64 {
        let sum = self.trellis.sum(codeword);
        let bounds = self.moments.iter();
        let bounds = bounds.map(|(exponent, ln_moment)| ln_moment - exponent * sum);
        bounds.fold(0.0, f64::min).max(LEAST_LN_P)
    }
}
