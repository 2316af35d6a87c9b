//! Codes of texts: blocks and check bits.

use crate::portable_test;
use crate::support::fixtures::{key, random};
use meshmark::internals::code::{Block, TextCheck, TextError};

#[portable_test]
fn ldpc_corrects_noise_and_erasures() {
    for block in Block::ALL {
        let message: Vec<u8> = (0..block.message_bytes() as u8)
            .map(|i| i.wrapping_mul(37))
            .collect();
        let word = block.encode(&message);
        assert_eq!(word.len(), block.code_bits());
        // Signs with a fifth erased, and noise of 0.6 of the signal.
        let received: Vec<f64> = (0u64..)
            .zip(&word)
            .map(|(place, &bit)| {
                let noise = (0..12).map(|i| random(1000 * place + i)).sum::<f64>() - 6.0;
                let signal = if bit { -1.0 } else { 1.0 };
                if place % 5 == 0 {
                    0.0
                } else {
                    signal + 0.6 * noise
                }
            })
            .collect();
        let decoded = block.decode(&received);
        assert!(decoded.is_codeword);
        assert_eq!(decoded.message, message, "{block:?}");
        let inverted: Vec<f64> = received.iter().map(|value| -value).collect();
        let complement: Vec<u8> = message.iter().map(|byte| !byte).collect();
        let decoded = block.decode(&inverted);
        assert!(decoded.is_codeword, "the complement of a codeword is one");
        assert_eq!(decoded.message, complement);
    }
}

#[portable_test]
fn ldpc_says_when_it_found_nothing() {
    let found = |seed: u64| {
        let noise = |place| 2.0 * random(500 * seed + place) - 1.0;
        let received: Vec<f64> = (0..256).map(noise).collect();
        Block::Tc256.decode(&received).is_codeword
    };
    assert_eq!((0..20).filter(|&seed| found(seed)).count(), 0);
    let decoded = Block::Tc128.decode(&[f64::NAN, f64::INFINITY]);
    assert_eq!(decoded.message.len(), 8);
}

#[portable_test]
fn text_check_knows_its_key_and_its_text() {
    let check = TextCheck::new(&key(1));
    for text in ["a", "Grüße", "© Ada Lovelace 1843, London"] {
        let block = Block::for_text(text).unwrap();
        let message = check.message(text, block).unwrap();
        assert_eq!(message.len(), block.message_bytes());
        assert_eq!(check.text(&message).as_deref(), Some(text));
        assert_eq!(TextCheck::new(&key(2)).text(&message), None);
        for bit in 0..8 * message.len() {
            let mut other = message.clone();
            other[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(check.text(&other), None, "bit {bit} of {text}");
        }
        let complement: Vec<u8> = message.iter().map(|byte| !byte).collect();
        assert_eq!(check.text(&complement), None);
    }
    assert_eq!(Block::for_text("12345"), Ok(Block::Tc128));
    assert_eq!(Block::for_text("123456"), Ok(Block::Tc256));
    assert_eq!(Block::for_text("12345678901234"), Ok(Block::Tc512));
    assert_eq!(check.text(&[]), None);
}

#[portable_test]
fn text_that_does_not_fit_is_refused() {
    let check = TextCheck::new(&key(1));
    assert_eq!(Block::for_text(""), Err(TextError::Empty));
    assert_eq!(Block::for_text("a\0b"), Err(TextError::Nul));
    let error = Block::for_text(&"x".repeat(30)).unwrap_err();
    assert_eq!(error.code(), "text.too-long");
    let error = check.message("123456", Block::Tc128).unwrap_err();
    let (bytes, capacity) = (6, 5);
    assert_eq!(error, TextError::TooLong { bytes, capacity });
    assert!(check.message("12345", Block::Tc128).is_ok());
}
