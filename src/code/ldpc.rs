//! Low-density parity-check codes: CCSDS 231.1-O-1's three of rate 1/2, and soft decoding by min-sum.
//!
//! Bits are in the order of transmission: the highest of a byte first, the message before its parities.

use labrador_ldpc::LDPCCode;

/// Rounds of message passing. Words that can be decoded mostly are after ten.
const ROUNDS: usize = 60;

/// Evidence is cut off here: no sum of it overflows, and none of it is a NaN.
const MOST: f64 = 1e6;

/// A code of fixed length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Block {
    /// 64 bits in 128.
    Tc128,
    /// 128 bits in 256.
    Tc256,
    /// 256 bits in 512.
    Tc512,
}

/// What a decoder made of a received word.
#[derive(Clone, Debug, PartialEq)]
pub struct Decoded {
    /// The message, as far as it could be made out.
    pub message: Vec<u8>,
    /// Whether all parities hold. A wrong codeword is rare, and possible: see [`TextCheck`](super::TextCheck).
    pub is_codeword: bool,
}

impl Block {
    /// Every code, the shortest first.
    pub const ALL: [Block; 3] = [Block::Tc128, Block::Tc256, Block::Tc512];

    fn code(self) -> LDPCCode {
        match self {
            Block::Tc128 => LDPCCode::TC128,
            Block::Tc256 => LDPCCode::TC256,
            Block::Tc512 => LDPCCode::TC512,
        }
    }

    /// Bytes of a message: 8, 16 or 32.
    pub fn message_bytes(self) -> usize {
        self.code().k() / 8
    }

    /// Bits of a codeword: 128, 256 or 512.
    pub fn code_bits(self) -> usize {
        self.code().n()
    }

    /// The codeword of a message of [`message_bytes`](Block::message_bytes) bytes; missing ones are zero, others are not read.
    pub fn encode(self, message: &[u8]) -> Vec<bool> {
        let code = self.code();
        let mut word = vec![0u8; code.n() / 8];
        let bytes = message.iter().take(self.message_bytes());
        word.iter_mut()
            .zip(bytes)
            .for_each(|(to, from)| *to = *from);
        code.encode(&mut word);
        bits(&word)
    }

    /// Decodes evidence of a codeword's bits, `ln P(0) / P(1)` each, in any unit; missing bits are erased.
    pub fn decode(self, evidence: &[f64]) -> Decoded {
        let code = self.code();
        let mut values = vec![0.0; code.n()];
        for (value, &evidence) in values.iter_mut().zip(evidence) {
            *value = if evidence.is_nan() {
                0.0
            } else {
                evidence.clamp(-MOST, MOST)
            };
        }
        let mut word = vec![0; code.output_len()];
        let mut working = vec![0.0; code.decode_ms_working_len()];
        let mut signs = vec![0; code.decode_ms_working_u8_len()];
        let (is_codeword, _) = code.decode_ms(&values, &mut word, &mut working, &mut signs, ROUNDS);
        word.truncate(self.message_bytes());
        Decoded {
            message: word,
            is_codeword,
        }
    }
}

/// The bits of bytes, the highest of each first.
fn bits(bytes: &[u8]) -> Vec<bool> {
    let of = |byte: &u8| {
        let byte = *byte;
        (0..8).rev().map(move |bit| byte >> bit & 1 == 1)
    };
    bytes.iter().flat_map(of).collect()
}
