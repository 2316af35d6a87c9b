//! Keys: published vectors of every primitive, and the laws of this format's own derivation.

use argon2::{Algorithm, Argon2, AssociatedData, ParamsBuilder, Version};
use hkdf::Hkdf;
use meshmark::Key;
use sha2::{Digest, Sha256};
use siphasher::sip128::SipHasher24;
use wasm_bindgen_test::wasm_bindgen_test;

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn key_argon2id_as_in_rfc_9106_section_5_3() {
    let mut builder = ParamsBuilder::new();
    builder
        .m_cost(32)
        .t_cost(3)
        .p_cost(4)
        .data(AssociatedData::new(&[4; 12]).unwrap());
    let argon2 = Argon2::new_with_secret(
        &[3; 8],
        Algorithm::Argon2id,
        Version::V0x13,
        builder.build().unwrap(),
    )
    .unwrap();
    let mut tag = [0; 32];
    argon2
        .hash_password_into(&[1; 32], &[2; 16], &mut tag)
        .unwrap();
    assert_eq!(
        hex(&tag),
        "0d640df58d78766c08c037a34a8b53c9d01ef0452d75b65eb52520e96b01e659"
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn key_hkdf_sha256_as_in_rfc_5869_case_1() {
    let salt: Vec<u8> = (0..=0x0c).collect();
    let info: Vec<u8> = (0xf0..=0xf9).collect();
    let mut okm = [0; 42];
    Hkdf::<Sha256>::new(Some(&salt), &[0x0b; 22])
        .expand(&info, &mut okm)
        .unwrap();
    assert_eq!(
        hex(&okm),
        "3cb25f25faacd57a90434f64d0362f2a2d2d0a90cf1a5a4c5db02d56ecc4c5bf34007208d5b887185865"
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn key_sha256_as_in_fips_180_4() {
    assert_eq!(
        hex(&Sha256::digest(b"abc")),
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn key_siphash_2_4_128_as_in_its_reference_code() {
    let key: [u8; 16] = std::array::from_fn(|i| i as u8);
    let hash = |input: &[u8]| hex(&SipHasher24::new_with_key(&key).hash(input).as_bytes());
    assert_eq!(hash(&[]), "a3817f04ba25a8e66df67214c7550293");
    assert_eq!(hash(&[0]), "da87c1d86b99af44347659119b22fc45");
}

/// In wasm it is the JavaScript engine that normalizes, on the way in: the package's tests hold it to the same.
#[cfg(not(target_arch = "wasm32"))]
#[test]
fn key_is_the_same_however_the_words_are_typed() {
    let composed = Key::from_passphrase("Zo\u{eb}", "caf\u{e9} \u{ff11}").unwrap();
    let decomposed = Key::from_passphrase(" Zoe\u{308} ", "cafe\u{301} 1").unwrap();
    assert_eq!(composed.to_bytes(), decomposed.to_bytes());
    let other_case = Key::from_passphrase("zo\u{eb}", "caf\u{e9} 1").unwrap();
    assert_ne!(composed.to_bytes(), other_case.to_bytes());
}

/// What docs/FORMAT.md promises: a change here orphans every mark that was ever made.
#[wasm_bindgen_test(unsupported = test)]
fn key_derivation_never_changes() {
    let key = Key::from_passphrase("Ada", "correct horse battery staple").unwrap();
    assert_eq!(
        hex(&*key.to_bytes()),
        "1e880652b5b6d7b3009828ff54ee8de813fb064b83b8b4311e9721e4505dd825"
    );
    assert_eq!(
        key.prf("ring").at(1),
        (0xcc83cd55b306151a, 0x8a89a23c5c1c991d)
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn key_sub_keys_differ_by_label_and_by_key() {
    let [a, b] = [[1; 32], [2; 32]].map(|bytes| Key::from_bytes(&bytes).unwrap());
    assert_ne!(a.prf("x").at(0), a.prf("y").at(0));
    assert_ne!(a.prf("x").at(0), b.prf("x").at(0));
    assert_eq!(a.prf("x").at(0), a.clone().prf("x").at(0));
}

#[wasm_bindgen_test(unsupported = test)]
fn key_refuses_what_is_no_secret() {
    assert_eq!(
        Key::from_passphrase(" \t", "p").unwrap_err().code(),
        "key.empty-owner"
    );
    assert_eq!(
        Key::from_passphrase("o", "").unwrap_err().code(),
        "key.empty-passphrase"
    );
    assert_eq!(Key::from_bytes(&[0; 31]).unwrap_err().code(), "key.length");
}

#[wasm_bindgen_test(unsupported = test)]
fn key_is_never_shown() {
    assert_eq!(
        format!("{:?}", Key::from_bytes(&[7; 32]).unwrap()),
        "Key(..)"
    );
}
