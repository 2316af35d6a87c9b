//! The owner's payload: 48 bits that people see as a short tag or as a number.

/// 48 bits, shown as a tag of up to 8 characters or as a number.
///
/// A tag's characters are six bits each, in the order `A-Z a-z 0-9 - .`, the first character in the highest bits; a
/// shorter tag is filled up with dots, so a tag cannot end in one. Tag and number are two spellings of the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Payload(u64);

/// Why a payload was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PayloadError {
    /// A tag with a character outside the alphabet.
    #[error(
        "a tag is made of the letters A-Z and a-z, the digits 0-9, '-' and '.'; {0:?} is none of them"
    )]
    Character(char),
    /// An empty tag, or one of more than 8 characters.
    #[error("a tag has 1 to 8 characters, this one has {0}")]
    Length(usize),
    /// A tag that ends in a dot, which is what shorter tags are filled up with.
    #[error("a tag cannot end in '.'")]
    TrailingDot,
    /// A number that needs more than 48 bits.
    #[error("a payload is a whole number from 0 to 281474976710655 (48 bits)")]
    Range,
}

impl PayloadError {
    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            PayloadError::Character(_) => "payload.character",
            PayloadError::Length(_) => "payload.length",
            PayloadError::TrailingDot => "payload.trailing-dot",
            PayloadError::Range => "payload.range",
        }
    }
}

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-.";
const CHARACTERS: usize = 8;
const FILLER: char = '.';

impl Payload {
    /// Bits in a payload.
    pub const BITS: u32 = 48;

    /// A payload from a whole number below 2^48.
    ///
    /// # Errors
    /// [`PayloadError::Range`] for any other.
    pub fn from_number(number: u64) -> Result<Payload, PayloadError> {
        if number >> Self::BITS == 0 {
            Ok(Payload(number))
        } else {
            Err(PayloadError::Range)
        }
    }

    /// A payload from a tag of 1 to 8 characters.
    ///
    /// # Errors
    /// Where it is empty or longer, has a character outside the alphabet, or ends in a dot.
    pub fn from_tag(tag: &str) -> Result<Payload, PayloadError> {
        let length = tag.chars().count();
        if !(1..=CHARACTERS).contains(&length) {
            return Err(PayloadError::Length(length));
        }
        if tag.ends_with(FILLER) {
            return Err(PayloadError::TrailingDot);
        }
        let filled = tag
            .chars()
            .chain(std::iter::repeat(FILLER))
            .take(CHARACTERS);
        filled
            .map(|c| {
                ALPHABET
                    .iter()
                    .position(|&a| char::from(a) == c)
                    .ok_or(PayloadError::Character(c))
            })
            .try_fold(0, |bits, digit| Ok(bits << 6 | digit? as u64))
            .map(Payload)
    }

    /// The payload as a number below 2^48.
    pub fn number(self) -> u64 {
        self.0
    }

    /// The payload as a tag; `None` for the one number, 2^48 - 1, whose tag would be empty.
    pub fn tag(self) -> Option<String> {
        let digits = (0..CHARACTERS)
            .rev()
            .map(|i| (self.0 >> (6 * i) & 63) as usize);
        let tag: String = digits.map(|digit| char::from(ALPHABET[digit])).collect();
        let tag = tag.trim_end_matches(FILLER);
        (!tag.is_empty()).then(|| tag.to_owned())
    }
}
