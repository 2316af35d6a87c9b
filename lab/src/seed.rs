//! Everything random, from one number.

use meshmark::{Key, Payload};

/// Gives each purpose numbers of its own, whatever else is run.
pub struct Seed {
    pub number: u64,
    key: Key,
}

impl Seed {
    pub fn new(number: u64) -> Seed {
        let mut bytes = [0; Key::BYTES];
        bytes[..8].copy_from_slice(&number.to_le_bytes());
        Seed {
            number,
            key: Key::from_bytes(&bytes).expect("as many bytes as a key has"),
        }
    }

    /// A number for a purpose.
    pub fn number(&self, purpose: &str, index: u64) -> u64 {
        self.key.prf(purpose).at(index).0
    }

    /// A key for a purpose.
    pub fn key(&self, purpose: &str, index: u64) -> Key {
        let prf = self.key.prf(&format!("{purpose}, key"));
        let ((a, b), (c, d)) = (prf.at(2 * index), prf.at(2 * index + 1));
        let bytes = [a, b, c, d].map(u64::to_le_bytes).concat();
        Key::from_bytes(&bytes).expect("as many bytes as a key has")
    }

    /// A payload for a purpose.
    pub fn payload(&self, purpose: &str) -> Payload {
        let number = self.number(purpose, 0) >> (u64::BITS - Payload::BITS);
        Payload::from_number(number).expect("as many bits as a payload has")
    }
}
