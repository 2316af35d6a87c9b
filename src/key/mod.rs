//! From a passphrase to everything secret: Argon2id -> master key -> HKDF -> the key of a work -> HKDF sub-keys by label -> keyed PRF of
//! addresses.
//!
//! docs/FORMAT.md fixes every parameter here: a change would orphan all marks made before it.

mod seal;

use argon2::{Algorithm, Argon2, Params, Version};
use hkdf::Hkdf;
use sha2::{Digest, Sha256};
use siphasher::sip128::SipHasher24;
use zeroize::{Zeroize, ZeroizeOnDrop, Zeroizing};

/// Argon2id's parameters: OWASP Password Storage Cheat Sheet, the first of its equivalent recommendations for
/// machines that spare memory: 19 MiB, 2 passes, 1 lane.
const MEMORY_KIB: u32 = 19 * 1024;
const PASSES: u32 = 2;
const LANES: u32 = 1;

/// Separates this use of the hash functions, and this format, from every other.
const DOMAIN: &[u8] = b"meshmark/1";

/// Why a key was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum KeyError {
    /// The owner's name has no character that is not white space.
    #[error("the owner's name is empty")]
    EmptyOwner,
    /// The passphrase is empty.
    #[error("the passphrase is empty")]
    EmptyPassphrase,
    /// The title of a work has no character that is not white space.
    #[error("the title of the work is empty")]
    EmptyWork,
    /// A key file of another size.
    #[error("a key file has exactly 32 bytes, this one has {0}")]
    Length(usize),
    /// Argon2id failed, which it does only where 19 MiB of memory cannot be had.
    #[error("the key could not be derived: {0}")]
    Derivation(String),
}

impl KeyError {
    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            KeyError::EmptyOwner => "key.empty-owner",
            KeyError::EmptyPassphrase => "key.empty-passphrase",
            KeyError::EmptyWork => "key.empty-work",
            KeyError::Length(_) => "key.length",
            KeyError::Derivation(_) => "key.derivation",
        }
    }
}

/// An owner's secret, 32 bytes. Wiped from memory when dropped, never shown.
#[derive(Clone, Zeroize, ZeroizeOnDrop)]
pub struct Key([u8; Key::BYTES]);

impl std::fmt::Debug for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Key(..)")
    }
}

impl Key {
    /// Bytes in a key and in a key file.
    pub const BYTES: usize = 32;

    /// A key from a key file's bytes: exactly 32, taken as they are.
    ///
    /// # Errors
    /// [`KeyError::Length`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Key, KeyError> {
        bytes
            .try_into()
            .map(Key)
            .map_err(|_| KeyError::Length(bytes.len()))
    }

    /// A key from what a person can remember: Argon2id (RFC 9106) over the passphrase, salted with the owner's name.
    ///
    /// Both are brought to Unicode NFKC first, and white space around the name is dropped, so that the same words typed
    /// on another keyboard give the same key. Upper and lower case are different. Takes tenths of a second, by design.
    ///
    /// # Errors
    /// Where the name or the passphrase is empty, or 19 MiB of memory cannot be had.
    #[cfg(feature = "nfkc")]
    pub fn from_passphrase(owner: &str, passphrase: &str) -> Result<Key, KeyError> {
        use unicode_normalization::UnicodeNormalization;
        let nfkc = |text: &str| Zeroizing::new(text.nfkc().collect::<String>());
        Key::from_normalized(&nfkc(owner), &nfkc(passphrase))
    }

    /// The same for a name and a passphrase that are in Unicode NFKC already. Of others it makes other keys: it is for callers who
    /// have a normalizer of their own, as JavaScript has.
    ///
    /// # Errors
    /// As [`from_passphrase`](Self::from_passphrase).
    pub fn from_normalized(owner: &str, passphrase: &str) -> Result<Key, KeyError> {
        if owner.trim().is_empty() {
            return Err(KeyError::EmptyOwner);
        }
        if passphrase.is_empty() {
            return Err(KeyError::EmptyPassphrase);
        }
        let salt = Sha256::new()
            .chain_update(DOMAIN)
            .chain_update(b"/owner/")
            .chain_update(owner.trim())
            .finalize();
        let derivation = |error: argon2::Error| KeyError::Derivation(error.to_string());
        let params =
            Params::new(MEMORY_KIB, PASSES, LANES, Some(Key::BYTES)).map_err(derivation)?;
        let mut key = Key([0; Key::BYTES]);
        Argon2::new(Algorithm::Argon2id, Version::V0x13, params)
            .hash_password_into(passphrase.as_bytes(), &salt, &mut key.0)
            .map_err(derivation)?;
        Ok(key)
    }

    /// The key of one work of this owner: HKDF-SHA256 (RFC 5869) of this key, with the work's title.
    ///
    /// Marks of one key have their dithers in common, and whoever has several models with it can compare them, or carry one's RING mark
    /// over to another. Works with keys of their own have nothing in common. A title is no secret. It is brought to Unicode NFKC,
    /// and white space around it is dropped.
    ///
    /// # Errors
    /// [`KeyError::EmptyWork`].
    #[cfg(feature = "nfkc")]
    pub fn for_work(&self, title: &str) -> Result<Key, KeyError> {
        use unicode_normalization::UnicodeNormalization;
        self.for_normalized_work(&title.nfkc().collect::<String>())
    }

    /// The same for a title that is in Unicode NFKC already.
    ///
    /// # Errors
    /// As [`for_work`](Self::for_work).
    pub fn for_normalized_work(&self, title: &str) -> Result<Key, KeyError> {
        if title.trim().is_empty() {
            return Err(KeyError::EmptyWork);
        }
        let mut key = Key([0; Key::BYTES]);
        Hkdf::<Sha256>::new(Some(DOMAIN), &self.0)
            .expand_multi_info(&[b"work/", title.trim().as_bytes()], &mut key.0)
            .expect("32 bytes are fewer than HKDF's limit of 255 hashes");
        Ok(key)
    }

    /// What a key can be held to later: 32 hexadecimal digits that follow it, and say nothing of it to who cannot guess it. Who can guess the
    /// passphrase can test the guess with them, at the cost of one derivation each.
    pub fn commitment(&self) -> String {
        let (high, low) = self.prf("commitment").at(0);
        format!("{high:016x}{low:016x}")
    }

    /// The 32 bytes, for a key file. The caller answers for what becomes of them.
    pub fn to_bytes(&self) -> Zeroizing<[u8; Key::BYTES]> {
        Zeroizing::new(self.0)
    }

    /// The pseudo-random function of this key for one purpose: its own 16-byte sub-key by HKDF-SHA256 (RFC 5869),
    /// so that what one purpose reveals says nothing of another.
    #[doc(hidden)]
    pub fn prf(&self, label: &str) -> Prf {
        let mut sub_key = Zeroizing::new([0; 16]);
        Hkdf::<Sha256>::new(Some(DOMAIN), &self.0)
            .expand(label.as_bytes(), &mut *sub_key)
            .expect("16 bytes are fewer than HKDF's limit of 255 hashes");
        Prf(sub_key)
    }
}

/// A keyed pseudo-random function from a 64-bit address to 128 bits: SipHash-2-4-128 (Aumasson and Bernstein 2012).
#[derive(Clone)]
pub struct Prf(Zeroizing<[u8; 16]>);

impl Prf {
    /// The 128 bits that belong to an address (hashed as 8 little-endian bytes): (high, low).
    pub fn at(&self, address: u64) -> (u64, u64) {
        let hash = SipHasher24::new_with_key(&self.0).hash(&address.to_le_bytes());
        (hash.h1, hash.h2)
    }
}

/// A word of a [`Prf`] as a number from 0 to below 1: its highest 53 bits, divided by 2^53.
pub fn unit(word: u64) -> f64 {
    (word >> 11) as f64 / (1u64 << 53) as f64
}
