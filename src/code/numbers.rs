//! Numbers of copies as payloads: a keyed permutation of 48 bits.
//!
//! To who has no key the payloads of an issue are as random bits, whatever its numbers are; so a codeword says nothing of the numbers
//! beside its own. A balanced Feistel network on the key's pseudo-random function (Luby and Rackoff 1988), with twelve rounds, eight more
//! than what hides it from who chooses numbers and sees payloads.

use crate::bits::{Payload, PayloadError};
use crate::key::{Key, Prf};

const ROUNDS: u64 = 12;
const HALF: u32 = Payload::BITS / 2;
const MASK: u64 = (1 << HALF) - 1;

/// The permutation of a key.
pub struct Numbers(Prf);

impl Numbers {
    /// The permutation of this key.
    pub fn new(key: &Key) -> Numbers {
        Numbers(key.prf("payload/number"))
    }

    /// The payload of the copy with a number below 2^48.
    ///
    /// # Errors
    /// [`PayloadError::Range`] for any other.
    pub fn payload(&self, number: u64) -> Result<Payload, PayloadError> {
        let number = Payload::from_number(number)?.number();
        let halves = [number >> HALF, number & MASK];
        let [high, low] = (0..ROUNDS).fold(halves, |[a, b], round| [b, a ^ self.round(round, b)]);
        Payload::from_number(high << HALF | low)
    }

    /// The number of the copy with a payload.
    pub fn number(&self, payload: Payload) -> u64 {
        let bits = payload.number();
        let halves = [bits >> HALF, bits & MASK];
        let back = |[a, b]: [u64; 2], round| [b ^ self.round(round, a), a];
        let [high, low] = (0..ROUNDS).rev().fold(halves, back);
        high << HALF | low
    }

    fn round(&self, round: u64, half: u64) -> u64 {
        self.0.at(round << HALF | half).0 & MASK
    }
}
