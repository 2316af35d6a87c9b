//! Payload coding: bits in, signs out, and back from soft values. Knows nothing of geometry.

mod check;
mod convolutional;
mod ldpc;
mod likeness;
mod numbers;
mod text;

pub use check::{CHECK_BITS, Checked};
pub use convolutional::{Codeword, MESSAGE_BITS, complete, decode};
pub use ldpc::{Block, Decoded};
pub use likeness::Likeness;
pub use numbers::Numbers;
pub use text::{TextCheck, TextError};

/// What one address of a carrier says about the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// Always +1: what a detector can look for before it knows any message.
    Pilot,
    /// The parity of the message bits that `taps` selects from the code's shift register at time `step`.
    Parity {
        /// Time step of the code, below [`convolutional::STEPS`].
        step: u8,
        /// Nine bits, the first and the last always set.
        taps: u16,
    },
}

impl Symbol {
    /// The symbol that 64 pseudo-random bits select: a third are pilots, the others uniform over steps and taps.
    pub fn select(random: u64) -> Symbol {
        let (choice, rest) = (random % 3, random / 3);
        if choice == 0 {
            return Symbol::Pilot;
        }
        let (step, rest) = (
            rest % convolutional::STEPS as u64,
            rest / convolutional::STEPS as u64,
        );
        Symbol::Parity {
            step: step as u8,
            taps: (rest % 128) as u16 * 2 + 257,
        }
    }
}

/// A symbol as a detector measured it: positive values speak for +1.
#[derive(Clone, Copy, Debug)]
pub struct SoftSymbol {
    /// Which symbol.
    pub symbol: Symbol,
    /// `weight * cos(phase)`: between `-weight` and `weight`.
    pub value: f64,
    /// Non-negative, and independent of the key.
    pub weight: f64,
}
