//! The convolutional code, its decoder and the check bits.

use crate::portable_test;
use crate::support::fixtures::key;
use meshmark::Payload;
use meshmark::internals::code::{
    CHECK_BITS, Checked, Codeword, MESSAGE_BITS, SoftSymbol, Symbol, complete, decode,
};

const MESSAGE: u64 = 0x0a5_c3f0_1234_5678;

/// Bit `step` of a message, the highest first; zero before and after.
fn bit(message: u64, step: i32) -> bool {
    (0..MESSAGE_BITS as i32).contains(&step) && message >> (MESSAGE_BITS as i32 - 1 - step) & 1 == 1
}

/// Symbols of random addresses, `value = sign * amplitude + noise` with uniform noise.
fn received(message: u64, count: u64, noise: f64) -> Vec<SoftSymbol> {
    let (codeword, random) = (Codeword::new(message), key(1).prf("test"));
    (0..count)
        .map(|address| {
            let (choice, uniform) = random.at(address);
            let symbol = Symbol::select(choice);
            let noise = noise * (2.0 * (uniform as f64 / u64::MAX as f64) - 1.0);
            SoftSymbol {
                symbol,
                value: codeword.sign(symbol) + noise,
                weight: 1.0,
            }
        })
        .collect()
}

#[portable_test]
fn code_symbol_is_the_parity_of_the_tapped_bits() {
    let codeword = Codeword::new(MESSAGE);
    for random in 0..20_000 {
        match Symbol::select(random) {
            Symbol::Pilot => assert_eq!(codeword.sign(Symbol::Pilot), 1.0),
            symbol @ Symbol::Parity { step, taps } => {
                let tapped = (0..9)
                    .filter(|j| taps >> j & 1 == 1 && bit(MESSAGE, i32::from(step) - 8 + j))
                    .count();
                assert_eq!(
                    codeword.sign(symbol),
                    if tapped % 2 == 0 { 1.0 } else { -1.0 }
                );
                assert_eq!(taps & 0x101, 0x101, "the first and the last tap are set");
            }
        }
    }
}

#[portable_test]
fn code_a_third_of_the_symbols_are_pilots() {
    let random = key(2).prf("test");
    let pilots = (0..9000)
        .filter(|&i| Symbol::select(random.at(i).0) == Symbol::Pilot)
        .count();
    assert!((2800..3200).contains(&pilots), "{pilots}");
}

#[portable_test]
fn code_decodes_what_it_encoded() {
    for message in [
        0,
        1,
        MESSAGE,
        (1 << MESSAGE_BITS) - 1,
        1 << (MESSAGE_BITS - 1),
    ] {
        assert_eq!(decode(&received(message, 600, 0.0), 1), [message]);
    }
}

#[portable_test]
fn code_decodes_through_noise_of_three_times_the_signal() {
    assert_eq!(decode(&received(MESSAGE, 900, 3.0), 1), [MESSAGE]);
}

#[portable_test]
fn code_lists_distinct_messages_in_order_of_likelihood() {
    let symbols = received(MESSAGE, 400, 4.0);
    let list = decode(&symbols, 16);
    let agreement = |message: u64| {
        let codeword = Codeword::new(message);
        let codes = symbols.iter().filter(|soft| soft.symbol != Symbol::Pilot);
        codes
            .map(|soft| soft.value * codeword.sign(soft.symbol))
            .sum::<f64>()
    };
    assert_eq!(list.len(), 16);
    assert!(
        list.windows(2)
            .all(|pair| agreement(pair[0]) >= agreement(pair[1]) - 1e-9)
    );
    let mut distinct = list.clone();
    distinct.sort_unstable();
    distinct.dedup();
    assert_eq!(distinct.len(), 16);
    assert!(
        agreement(list[0]) >= agreement(MESSAGE),
        "nothing is likelier than the first"
    );
}

#[portable_test]
fn code_completes_what_is_known_of_a_message() {
    let symbols = received(MESSAGE, 900, 1.0);
    for num_known in [0, 1, 48, MESSAGE_BITS] {
        let known = MESSAGE >> (MESSAGE_BITS - num_known);
        assert_eq!(complete(&symbols, known, num_known), MESSAGE, "{num_known}");
    }
    // What is known is kept, however much speaks against it.
    let other = !(MESSAGE >> (MESSAGE_BITS - 48)) & ((1 << 48) - 1);
    assert_eq!(complete(&symbols, other, 48) >> (MESSAGE_BITS - 48), other);
}

#[portable_test]
fn code_decodes_nothing_at_all_without_failing() {
    assert_eq!(decode(&[], 4).len(), 4);
}

#[portable_test]
fn code_check_bits_hold_for_their_key_and_payload_only() {
    let (mine, other) = (Checked::new(&key(1)), Checked::new(&key(2)));
    let payload = Payload::from_tag("CHECK").unwrap();
    let message = mine.message(payload);
    assert_eq!(mine.payload(message), Some(payload));
    assert_eq!(message >> CHECK_BITS, payload.number());
    let passed = (0..MESSAGE_BITS)
        .filter(|flip| mine.payload(message ^ 1 << flip).is_some())
        .count();
    assert_eq!(passed, 0, "no single error passes this one");
    let accepted = (0..4096)
        .filter(|i| {
            other
                .payload(*i * 0x9E37_79B9 % (1 << MESSAGE_BITS))
                .is_some()
        })
        .count();
    assert!(
        accepted < 10,
        "{accepted} of 4096 random messages pass 12 bits"
    );
}
