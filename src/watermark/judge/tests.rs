//! The judge, of readings that are written here: every charge to the last digit, and each verdict on both sides of its limit.

use super::*;
use crate::carrier::Reading;

/// Charged to every hypothesis here, beside what the judge charges.
const LN_WAYS: f64 = 1.5;

/// What the judge charges for its tests: of a blind reading, and where a payload is expected.
fn ln_tests(expected: bool) -> f64 {
    libm::log(if expected { 5.0 } else { 3.0 })
}

fn key() -> Key {
    Key::from_bytes(&[7; Key::BYTES]).expect("32 bytes")
}

fn payload(number: u64) -> Payload {
    Payload::from_number(number).expect("48 bits")
}

/// `num` places of weight 1, spread over pilots and parities as a key spreads them.
fn places(num: usize) -> Vec<SoftSymbol> {
    let prf = key().prf("places");
    let symbols = (0..num as u64).map(|address| Symbol::select(prf.at(address).1));
    let silent = |symbol| SoftSymbol {
        symbol,
        value: 0.0,
        weight: 1.0,
    };
    symbols.map(silent).collect()
}

/// The same, where pilots agree by `pilots` and parities of a payload by `parities`: 1 is all of them whole.
fn marked(num: usize, carried: Payload, pilots: f64, parities: f64) -> Vec<SoftSymbol> {
    let codeword = Codeword::new(Checked::new(&key()).message(carried));
    let mut symbols = places(num);
    for soft in &mut symbols {
        let share = if soft.symbol == Symbol::Pilot {
            pilots
        } else {
            parities
        };
        soft.value = share * codeword.sign(soft.symbol);
    }
    symbols
}

fn way(symbols: Vec<SoftSymbol>) -> Hypothesis {
    Hypothesis {
        symbols,
        ln_num_tests: LN_WAYS,
        piece: 0,
    }
}

fn reading(ways: Vec<Vec<SoftSymbol>>, num_addresses: usize) -> Reading {
    Reading {
        hypotheses: ways.into_iter().map(way).collect(),
        num_addresses,
    }
}

/// What RING alone reads in one way, of so many addresses.
fn ring(symbols: Vec<SoftSymbol>, num_addresses: usize) -> Readings {
    [Reading::default(), reading(vec![symbols], num_addresses)]
}

fn judge(expected: Option<Payload>) -> Judge {
    Judge::new(&key(), expected, Input::Model)
}

fn near(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-9, "{value}, not {expected}");
}

/// The exponent of symbols of weight 1, all of which agree by `share`.
fn exponent(num: usize, share: f64) -> f64 {
    share * share * num as f64
}

#[test]
fn a_blind_payload_is_charged_its_guess_its_tests_and_its_carriers() {
    let found = judge(None).conclude(&ring(marked(200, payload(5), 1.0, 1.0), 800));
    assert_eq!((found.verdict, found.number), (Verdict::Found, Some(5)));
    assert_eq!(found.reason, None);
    near(found.details.agreement, 1.0);
    let own = -exponent(200, 1.0) + 48.0 * LN_2 + LN_WAYS + ln_tests(false);
    near(found.details.carriers[1].ln_p, own);
    near(found.details.ln_p, own + LN_CARRIERS);
    assert_eq!(found.details.carriers[1].owned_addresses, 200);
    assert_eq!(found.details.carriers[0].owned_addresses, 0);
    assert_eq!(found.details.carriers[1].addresses, 800);
}

#[test]
fn an_expected_payload_is_charged_five_tests_and_no_guess() {
    let found = judge(Some(payload(5))).conclude(&ring(marked(200, payload(5), 1.0, 1.0), 800));
    assert_eq!((found.verdict, found.number), (Verdict::Found, Some(5)));
    near(
        found.details.ln_p,
        -exponent(200, 1.0) + LN_WAYS + ln_tests(true) + LN_CARRIERS,
    );
}

#[test]
fn many_keys_are_charged_each() {
    let of = |judge: Judge| {
        judge
            .conclude(&ring(marked(200, payload(5), 1.0, 1.0), 800))
            .details
            .ln_p
    };
    near(
        of(judge(None).one_of(1000)) - of(judge(None)),
        libm::log(1000.0),
    );
}

/// Of the ways of a carrier the loudest speaks, whatever their order, and what owns most addresses is counted.
#[test]
fn the_loudest_way_speaks() {
    let ways = [
        marked(150, payload(5), 1.0, 0.9),
        marked(120, payload(5), 1.0, 1.0),
        places(180),
    ];
    for turn in 0..3 {
        let mut ways = ways.to_vec();
        ways.rotate_left(turn);
        let found = judge(None).conclude(&[Reading::default(), reading(ways, 800)]);
        assert_eq!((found.verdict, found.number), (Verdict::Found, Some(5)));
        let of_first = marked(150, payload(5), 1.0, 0.9);
        let of_first = against(&of_first, |symbol| {
            Codeword::new(Checked::new(&key()).message(payload(5))).sign(symbol)
        });
        near(
            found.details.ln_p,
            of_first.ln_p() + 48.0 * LN_2 + LN_WAYS + ln_tests(false) + LN_CARRIERS,
        );
        assert_eq!(found.details.carriers[1].owned_addresses, 180);
    }
}

/// Pilots speak for the key alone: however loud, no payload is found.
#[test]
fn pilots_alone_say_that_a_mark_is_there() {
    let partly = judge(None).conclude(&ring(marked(300, payload(5), 1.0, 0.0), 1200));
    assert_eq!((partly.verdict, partly.number), (Verdict::Present, None));
    assert_eq!(partly.reason, None);
    assert!(partly.shows_details);
    let num_pilots = places(300)
        .iter()
        .filter(|soft| soft.symbol == Symbol::Pilot)
        .count();
    near(
        partly.details.ln_p,
        -exponent(num_pilots, 1.0) + LN_WAYS + ln_tests(false) + LN_CARRIERS,
    );
    near(partly.details.agreement, 0.0);
}

/// A mark without a payload is heard in all its symbols, blind and where a payload is expected; the limit, from both sides.
#[test]
fn a_mark_without_a_payload_is_present() {
    for expected in [None, Some(payload(5))] {
        let charge = LN_WAYS + ln_tests(expected.is_some()) + LN_CARRIERS;
        let least = ((-LN_P_FOUND + charge) / 300.0).sqrt();
        for (share, verdict) in [
            (least - 1e-9, Verdict::Partial),
            (least + 1e-9, Verdict::Present),
        ] {
            let mut symbols = places(300);
            for soft in &mut symbols {
                soft.value = share * Codeword::Presence.sign(soft.symbol);
            }
            let read = judge(expected).conclude(&ring(symbols, 1200));
            assert_eq!((read.verdict, read.number), (verdict, None), "{share}");
            near(read.details.ln_p, -exponent(300, share) + charge);
        }
    }
}

/// However loud it is, no payload is read in it: no message says -1 at every parity.
#[test]
fn a_mark_without_a_payload_names_none() {
    let mut symbols = places(2000);
    for soft in &mut symbols {
        soft.value = Codeword::Presence.sign(soft.symbol);
    }
    let read = judge(None).conclude(&ring(symbols, 8000));
    assert_eq!((read.verdict, read.number), (Verdict::Present, None));
}

/// The limit of a trace, from both sides: pilots that agree a little less and a little more.
#[test]
fn a_trace_begins_at_one_in_ten_thousand() {
    let num_pilots = places(300)
        .iter()
        .filter(|soft| soft.symbol == Symbol::Pilot)
        .count();
    let least =
        ((-LN_P_TRACE + LN_WAYS + ln_tests(false) + LN_CARRIERS) / num_pilots as f64).sqrt();
    for (share, verdict) in [
        (least - 1e-9, Verdict::None),
        (least + 1e-9, Verdict::Partial),
    ] {
        let read = judge(None).conclude(&ring(marked(300, payload(5), share, 0.0), 1200));
        assert_eq!(read.verdict, verdict, "{share}");
    }
}

/// The limit of what is found, from both sides, and that a payload is named on one alone.
#[test]
fn a_payload_is_found_at_one_in_a_billion() {
    let charge = LN_WAYS + ln_tests(false) + LN_CARRIERS + LN_PAYLOADS;
    let least = ((-LN_P_FOUND + charge) / 300.0).sqrt();
    for (share, verdict) in [
        (least - 1e-9, Verdict::Partial),
        (least + 1e-9, Verdict::Found),
    ] {
        let read = judge(None).conclude(&ring(marked(300, payload(5), share, share), 1200));
        assert_eq!(read.verdict, verdict, "{share}");
        let named = (verdict == Verdict::Found).then_some(5);
        assert_eq!(
            (read.number, read.details.carriers[1].number),
            (named, named)
        );
        assert_eq!(read.tag, payload(5).tag().filter(|_| named.is_some()));
    }
}

/// Both carriers read the same suspect: the louder one's payload is the model's.
#[test]
fn the_louder_carrier_names_the_payload() {
    for quiet in [0, 1] {
        let mut readings = [
            reading(vec![marked(200, payload(5), 1.0, 1.0)], 800),
            reading(vec![marked(200, payload(5), 1.0, 1.0)], 800),
        ];
        readings[quiet] = reading(vec![marked(150, payload(6), 1.0, 1.0)], 800);
        let found = judge(None).conclude(&readings);
        assert_eq!((found.verdict, found.number), (Verdict::Found, Some(5)));
        assert_eq!(found.details.carriers[quiet].number, None);
        assert_eq!(found.details.carriers[quiet].name, Carrier::STANDARD[quiet]);
    }
}

#[test]
fn another_payload_is_partly_and_named_where_chance_is_excluded() {
    let charge = LN_WAYS + ln_tests(true) + LN_CARRIERS + LN_PAYLOADS;
    let least = |ln_p: f64| ((-ln_p + charge) / 300.0).sqrt();
    let [trace, found] = [LN_P_TRACE, LN_P_FOUND].map(least);
    for (share, names) in [
        (trace + 1e-9, false),
        (found - 1e-9, false),
        (found + 1e-9, true),
    ] {
        let read =
            judge(Some(payload(6))).conclude(&ring(marked(300, payload(5), share, share), 1200));
        assert_eq!(
            (read.verdict, read.number),
            (Verdict::Partial, None),
            "{share}"
        );
        let reason = read.reason.unwrap_or_default();
        assert!(
            reason.starts_with("The model carries a mark of this key"),
            "{reason}"
        );
        let tag = payload(5).tag().unwrap_or_default();
        assert_eq!(
            reason.ends_with(&format!(" It is {tag}.")),
            names,
            "{share}: {reason}"
        );
    }
}

/// A payload that has no tag is named by its number.
#[test]
fn another_payload_without_a_tag_is_named_by_its_number() {
    let other = payload((1 << 48) - 1);
    assert_eq!(other.tag(), None);
    let read = judge(Some(payload(6))).conclude(&ring(marked(300, other, 1.0, 1.0), 1200));
    let named = format!(" It is {}.", other.number());
    assert!(read.reason.is_some_and(|reason| reason.ends_with(&named)));
}

/// Too weak to be decoded blind, an expected payload is held against the symbols that are no pilots.
#[test]
fn an_expected_payload_is_fitted_where_none_is_decoded() {
    let share = 0.36; // of 300: exponent 39 in all, 26 without pilots, where a blind reading asks for 45
    let symbols = || marked(300, payload(5), 0.0, share);
    let num_parities = places(300)
        .iter()
        .filter(|soft| soft.symbol != Symbol::Pilot)
        .count();
    let found = judge(Some(payload(5))).conclude(&ring(symbols(), 1200));
    assert_eq!((found.verdict, found.number), (Verdict::Found, Some(5)));
    near(
        found.details.ln_p,
        -exponent(num_parities, share) + LN_WAYS + ln_tests(true) + LN_CARRIERS,
    );
    near(found.details.agreement, share * num_parities as f64 / 300.0);
    // Its neighbours share most parities, and do not have the check bits that fit best.
    for bit in 0..48 {
        let read = judge(Some(payload(5 ^ 1 << bit))).conclude(&ring(symbols(), 1200));
        assert_ne!(read.verdict, Verdict::Found, "bit {bit}");
    }
    let blind = judge(None).conclude(&ring(symbols(), 1200));
    assert_ne!(blind.verdict, Verdict::Found);
}

/// Of the ways of reading, that in which the expected payload fits best is the one whose check bits count.
#[test]
fn an_expected_payload_is_fitted_in_its_best_way() {
    let ways = || vec![places(300), marked(300, payload(5), 0.0, 0.36), places(120)];
    let found = judge(Some(payload(5))).conclude(&[Reading::default(), reading(ways(), 1200)]);
    assert_eq!((found.verdict, found.number), (Verdict::Found, Some(5)));
}

/// Where one carrier decodes a payload, the other is not asked whether the expected one fits it.
#[test]
fn nothing_is_fitted_beside_a_decoded_payload() {
    let readings = [
        reading(vec![marked(200, payload(6), 1.0, 1.0)], 800),
        reading(vec![marked(300, payload(5), 0.0, 0.36)], 1200),
    ];
    let read = judge(Some(payload(5))).conclude(&readings);
    assert_eq!((read.verdict, read.number), (Verdict::Partial, None));
}

/// A message whose check bits do not hold is no payload, however loud it is.
#[test]
fn check_bits_have_to_hold() {
    let message = Checked::new(&key()).message(payload(5)) ^ 1;
    let codeword = Codeword::new(message);
    let mut symbols = places(300);
    for soft in &mut symbols {
        soft.value = codeword.sign(soft.symbol);
    }
    let read = judge(None).conclude(&ring(symbols, 1200));
    assert_eq!((read.verdict, read.number), (Verdict::Present, None));
}

/// RING's limit of what can be told: places by which a mark could reach 1e-9 at best.
#[test]
fn too_few_places_cannot_be_checked() {
    for expected in [None, Some(payload(5))] {
        let most = |num| Carrier::Ring.most_exponent(num);
        let needed = -LN_P_FOUND + ln_tests(expected.is_some()) + LN_WAYS + LN_CARRIERS;
        let enough = (0..)
            .find(|&num| most(num) >= needed)
            .expect("there is one");
        for (num, verdict) in [(enough - 1, Verdict::CannotCheck), (enough, Verdict::None)] {
            let read = judge(expected).conclude(&ring(places(40), num));
            assert_eq!(read.verdict, verdict, "{num} places");
        }
    }
}

#[test]
fn nothing_to_read_cannot_be_checked() {
    let read = judge(None).conclude(&Readings::default());
    assert_eq!((read.verdict, read.number), (Verdict::CannotCheck, None));
    assert_eq!((read.details.ln_p, read.details.agreement), (0.0, 0.0));
}

/// The shares of all carriers are one probability, and what the judge charges follows them.
#[test]
fn the_shares_of_carriers_add_up_to_one() {
    let shares: f64 = Carrier::ALL.into_iter().map(Carrier::share).sum();
    near(shares, 1.0);
    for carrier in Carrier::STANDARD {
        near(ln_carriers(carrier), LN_CARRIERS);
    }
    near(ln_carriers(Carrier::Local), libm::log(16.0));
}

/// What LOCAL reads in balls that agree by `share`, each set one ball more.
fn local(num: usize, share: f64) -> Option<(Carrier, Reading)> {
    let ball = |_| {
        let mut symbols = places(num);
        symbols.retain(|soft| soft.symbol != Symbol::Pilot);
        for soft in &mut symbols {
            soft.value = share * Codeword::Presence.sign(soft.symbol);
        }
        symbols
    };
    let sets = (1..=2).map(|count| (0..count).flat_map(ball).collect());
    Some((Carrier::Local, reading(sets.collect(), num)))
}

/// LOCAL says whose a model is: one test of each way, and a sixteenth of the probability. Its places are named.
#[test]
fn local_alone_is_present() {
    for expected in [None, Some(payload(5))] {
        let found = judge(expected).conclude_with(&Readings::default(), local(60, 1.0));
        assert_eq!((found.verdict, found.number), (Verdict::Present, None));
        let reason = found.reason.as_deref().unwrap_or_default();
        assert!(reason.contains("LOCAL, in 2 places"), "{reason}");
        assert_eq!(found.caution, None);
        let own = &found.details.carriers[2];
        assert_eq!((own.name, own.number), (Carrier::Local, None));
        near(own.ln_p, -exponent(own.owned_addresses, 1.0) + LN_WAYS);
        near(found.details.ln_p, own.ln_p + libm::log(16.0));
    }
}

/// Parities that all say -1 are no payload of LOCAL's, and a payload that another carrier reads stays the answer.
#[test]
fn local_takes_no_payload_away() {
    let readings = ring(marked(200, payload(5), 1.0, 1.0), 800);
    let found = judge(None).conclude_with(&readings, local(400, 1.0));
    assert_eq!((found.verdict, found.number), (Verdict::Found, Some(5)));
    assert_eq!(found.reason, None);
}

/// Where LOCAL was read and says nothing, the answer is the same as without.
#[test]
fn local_that_is_not_there_changes_nothing() {
    for readings in [
        Readings::default(),
        ring(places(40), 800),
        ring(marked(200, payload(5), 1.0, 1.0), 800),
    ] {
        let [without, mut with] =
            [None, local(60, 0.0)].map(|local| judge(None).conclude_with(&readings, local));
        with.details.carriers.pop();
        assert_eq!(with, without);
    }
}
