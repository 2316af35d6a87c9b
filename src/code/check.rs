//! Check bits: what tells the owner's payload from a neighbour that differs in a few bits.
//!
//! The same key with another payload is no null event, so a small p proves that the key is in a model but not that every
//! bit of the payload is right. 12 bits that only the key can compute go with the 48: a wrong candidate of the decoder's
//! list passes them with probability 2^-12.

use super::MESSAGE_BITS;
use crate::bits::Payload;
use crate::key::{Key, Prf};

/// Check bits in a message.
pub const CHECK_BITS: u32 = MESSAGE_BITS - Payload::BITS;

/// Binds payloads to a key.
pub struct Checked(Prf);

impl Checked {
    /// The check of this key.
    pub fn new(key: &Key) -> Checked {
        Checked(key.prf("payload/check"))
    }

    /// The message that carries a payload: its 48 bits, then the 12 check bits.
    pub fn message(&self, payload: Payload) -> u64 {
        let (random, _) = self.0.at(payload.number());
        payload.number() << CHECK_BITS | random >> (u64::BITS - CHECK_BITS)
    }

    /// The payload of a message whose check bits hold.
    pub fn payload(&self, message: u64) -> Option<Payload> {
        let payload = Payload::from_number(message >> CHECK_BITS).ok()?;
        (self.message(payload) == message).then_some(payload)
    }
}
