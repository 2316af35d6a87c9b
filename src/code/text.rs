//! Texts as messages of a block code: UTF-8, zeros to fill up, and check bits that only the key can compute.
//!
//! A decoder that finds a codeword may have found a wrong one, or its complement. 24 check bits pass a message that was not
//! made with the key with probability 2^-24.

use super::Block;
use crate::key::{Key, Prf};

/// Bytes of check bits in a message.
const CHECK_BYTES: usize = 3;

/// Why a text cannot be a message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TextError {
    /// Nothing to say.
    #[error("the text is empty")]
    Empty,
    /// U+0000 fills messages up.
    #[error("the text has a character U+0000")]
    Nul,
    /// More than the longest block holds.
    #[error("the text has {bytes} bytes, and there is room for {capacity}")]
    TooLong {
        /// The text's length in UTF-8.
        bytes: usize,
        /// What there is room for.
        capacity: usize,
    },
}

impl TextError {
    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            TextError::Empty => "text.empty",
            TextError::Nul => "text.nul",
            TextError::TooLong { .. } => "text.too-long",
        }
    }
}

impl Block {
    /// Bytes of text that a message holds: 5, 13 or 29.
    pub fn text_bytes(self) -> usize {
        self.message_bytes() - CHECK_BYTES
    }

    /// The shortest block that holds a text.
    ///
    /// # Errors
    /// Where the text is empty, longer than 29 bytes, or has a NUL.
    pub fn for_text(text: &str) -> Result<Block, TextError> {
        let bytes = text.len();
        if text.is_empty() {
            return Err(TextError::Empty);
        }
        if text.contains('\0') {
            return Err(TextError::Nul);
        }
        let holds = |block: &Block| bytes <= block.text_bytes();
        let capacity = Block::Tc512.text_bytes();
        let block = Block::ALL.into_iter().find(holds);
        block.ok_or(TextError::TooLong { bytes, capacity })
    }
}

/// Binds texts to a key.
pub struct TextCheck(Prf);

impl TextCheck {
    /// The check of this key.
    pub fn new(key: &Key) -> TextCheck {
        TextCheck(key.prf("text/check"))
    }

    /// The message that carries a text in a block: its bytes, zeros, and the check bits.
    pub fn message(&self, text: &str, block: Block) -> Result<Vec<u8>, TextError> {
        let (bytes, capacity) = (text.len(), block.text_bytes());
        Block::for_text(text)?;
        if bytes > capacity {
            return Err(TextError::TooLong { bytes, capacity });
        }
        let mut message = text.as_bytes().to_vec();
        message.resize(capacity, 0);
        message.extend(self.check(&message));
        Ok(message)
    }

    /// The text of a message whose check bits hold.
    pub fn text(&self, message: &[u8]) -> Option<String> {
        let (padded, check) = message.split_last_chunk::<CHECK_BYTES>()?;
        if self.check(padded) != *check {
            return None;
        }
        let text = std::str::from_utf8(padded).ok()?.trim_end_matches('\0');
        let is_text = !text.is_empty() && !text.contains('\0');
        is_text.then(|| text.to_owned())
    }

    /// CBC-MAC over a length and words of 8 little-endian bytes, the last filled up with zeros.
    fn check(&self, bytes: &[u8]) -> [u8; CHECK_BYTES] {
        let mut state = self.0.at(bytes.len() as u64).0;
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word.iter_mut()
                .zip(chunk)
                .for_each(|(to, from)| *to = *from);
            state = self.0.at(state ^ u64::from_le_bytes(word)).0;
        }
        let [a, b, c, ..] = state.to_be_bytes();
        [a, b, c]
    }
}

#[cfg(test)]
mod tests {
    use super::TextCheck;
    use crate::key::Key;

    /// Who has the key can give any bytes the check bits that hold: what no text begins as is none.
    #[test]
    fn bytes_that_no_text_gives_are_none() {
        let check = TextCheck::new(&Key::from_bytes(&[1; Key::BYTES]).expect("32 bytes"));
        let read = |bytes: &[u8]| check.text(&[bytes, &check.check(bytes)].concat());
        assert_eq!(read(b"ab\0\0\0").as_deref(), Some("ab"));
        for bytes in [b"\0\0\0\0\0", b"a\0b\0\0", b"a\xFFb\0\0"] {
            assert_eq!(read(bytes), None, "{bytes:?}");
        }
    }
}
