//! Sealing bytes under a key: AES-256-GCM-SIV (RFC 8452), which nobody opens or changes without it.

use super::{DOMAIN, Key};
use aes_gcm_siv::aead::{Aead, KeyInit, Payload};
use aes_gcm_siv::{Aes256GcmSiv, Nonce};
use hkdf::Hkdf;
use sha2::{Digest, Sha256};
use zeroize::Zeroizing;

/// Bytes before what is sealed: the nonce.
const NONCE: usize = 12;

impl Key {
    /// Seals bytes, and binds others to them that stay in clear: the nonce, then the sealed bytes and their tag of 16. The same of the same.
    ///
    /// The nonce comes from what is sealed, by SHA-256 under a sub-key, so that equal input gives equal output and no other input does.
    #[doc(hidden)]
    pub fn seal(&self, plain: &[u8], clear: &[u8]) -> Vec<u8> {
        let own = self.expanded::<32>(b"record/nonce");
        let hash = Sha256::new()
            .chain_update(*own)
            .chain_update((clear.len() as u64).to_le_bytes())
            .chain_update(clear)
            .chain_update(plain)
            .finalize();
        let mut nonce = [0; NONCE];
        nonce.copy_from_slice(&hash[..NONCE]);
        let payload = Payload {
            msg: plain,
            aad: clear,
        };
        let sealed = self
            .cipher()
            .encrypt(&Nonce::from(nonce), payload)
            .expect("what is sealed is far shorter than the cipher's limit of 64 GiB");
        [&nonce[..], &sealed].concat()
    }

    /// What was sealed with the same bytes in clear; `None` for anything else.
    #[doc(hidden)]
    pub fn unseal(&self, sealed: &[u8], clear: &[u8]) -> Option<Vec<u8>> {
        let (nonce, sealed) = sealed.split_first_chunk::<NONCE>()?;
        let payload = Payload {
            msg: sealed,
            aad: clear,
        };
        self.cipher().decrypt(&Nonce::from(*nonce), payload).ok()
    }

    fn cipher(&self) -> Aes256GcmSiv {
        let own = self.expanded::<32>(b"record/seal");
        Aes256GcmSiv::new(&(*own).into())
    }

    fn expanded<const N: usize>(&self, label: &[u8]) -> Zeroizing<[u8; N]> {
        let mut own = Zeroizing::new([0; N]);
        Hkdf::<Sha256>::new(Some(DOMAIN), &self.0)
            .expand(label, &mut *own)
            .expect("a few bytes are fewer than HKDF's limit of 255 hashes");
        own
    }
}
