//! The bound: what it is, that it holds, and that it survives extreme numbers.

use crate::portable_test;
use crate::support::fixtures::key;
use meshmark::internals::detection::{
    LN_P_FOUND, LN_P_TRACE, Statistic, exponents_of_errors, ln_p_of_errors, union,
};
use std::f64::consts::TAU;

#[portable_test]
fn detection_bound_is_the_squared_sum_over_the_energy() {
    let statistic = Statistic::new([(3.0, 4.0), (-1.0, 2.0), (2.0, 2.0)]);
    assert!((statistic.ln_p() + 16.0 / 24.0).abs() < 1e-12);
    assert_eq!(statistic.agreement(), 0.5);
}

#[portable_test]
fn detection_nothing_and_disagreement_prove_nothing() {
    assert_eq!(Statistic::new([]).ln_p(), 0.0);
    assert_eq!(Statistic::new([]).agreement(), 0.0);
    assert_eq!(Statistic::new([(-5.0, 5.0)]).ln_p(), 0.0);
    assert_eq!(Statistic::new([(0.0, 0.0)]).ln_p(), 0.0);
}

#[portable_test]
fn detection_neither_underflows_nor_overflows() {
    for scale in [1e-150, 1.0, 1e150] {
        let statistic = Statistic::new((0..2_000).map(|_| (scale, scale)));
        assert!(
            (statistic.ln_p() + 2_000.0).abs() < 1e-6,
            "{scale}: {}",
            statistic.ln_p()
        );
    }
}

/// Whatever a carrier gives, no term says more than its weight allows.
#[portable_test]
fn detection_no_value_exceeds_its_weight() {
    let perfect = Statistic::new([(1.0, 1.0); 4]);
    for beyond in [1.0 + 1e-9, 3.0, 1e300, f64::INFINITY] {
        assert_eq!(Statistic::new([(beyond, 1.0); 4]), perfect, "{beyond}");
    }
    for (value, weight) in [
        (f64::NAN, 1.0),
        (1.0, f64::NAN),
        (1.0, -1.0),
        (1.0, f64::INFINITY),
        (1e-200, 1e-200),
    ] {
        assert_eq!(
            Statistic::new([(value, weight)]).ln_p(),
            0.0,
            "{value} of {weight}"
        );
    }
}

#[portable_test]
fn detection_unions_add_logarithms_and_end_at_certainty() {
    assert_eq!(union(-10.0, libm::log(4.0)), -10.0 + libm::log(4.0));
    assert_eq!(union(-1.0, 5.0), 0.0);
}

#[portable_test]
fn detection_thresholds_are_what_they_say() {
    assert!((LN_P_FOUND - libm::log(1e-9)).abs() < 1e-12);
    assert!((LN_P_TRACE - libm::log(1e-4)).abs() < 1e-12);
}

/// Random dithers on weights of every size: each tail of the statistic stays below its bound.
#[portable_test]
fn detection_bound_holds_for_random_dithers() {
    const TRIALS: u64 = 4_000;
    let random = key(3).prf("dither");
    let ln_p = |trial: u64| {
        Statistic::new((0..40).map(|i| {
            let weight = 1.0 + (i % 7) as f64;
            let uniform = random.at(trial * 40 + i).0 as f64 / u64::MAX as f64;
            (weight * libm::cos(TAU * uniform), weight)
        }))
        .ln_p()
    };
    let values: Vec<f64> = (0..TRIALS).map(ln_p).collect();
    for threshold in [1.0, 2.0, 3.0, 4.0, 6.0] {
        let seen = values.iter().filter(|&&ln_p| ln_p <= -threshold).count() as f64;
        let allowed = TRIALS as f64 * libm::exp(-threshold);
        assert!(
            seen <= allowed + 4.0 * allowed.sqrt(),
            "ln p <= -{threshold}: {seen} of {TRIALS}, bound {allowed}"
        );
    }
    assert!(
        values.iter().any(|&ln_p| ln_p < -2.0),
        "the bound is of the right order, not idle"
    );
}

/// Responses of very different sizes, and errors as the dithers of a key that marked nothing give them.
#[portable_test]
fn detection_bound_of_errors_holds_for_random_dithers() {
    let prf = key(9).prf("errors");
    let uniform = |address: u64| (prf.at(address).0 >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
    let responses: Vec<f64> = (0..60).map(|i| libm::exp(-0.1 * f64::from(i))).collect();
    let (trials, mut reached) = (20_000u64, [0u32; 4]);
    for trial in 0..trials {
        let errors = (0..60).map(|i| uniform(trial << 8 | i));
        let terms: Vec<(f64, f64)> = responses.iter().copied().zip(errors).collect();
        let ln_p = ln_p_of_errors(terms.iter().copied());
        for (count, most) in reached.iter_mut().zip([-1.0, -2.0, -4.0, -6.0]) {
            *count += u32::from(ln_p <= most);
        }
    }
    for (count, most) in reached.into_iter().zip([-1.0f64, -2.0, -4.0, -6.0]) {
        let expected = libm::exp(most) * trials as f64;
        assert!(
            f64::from(count) <= expected,
            "{count} of {trials} at {most}"
        );
        assert!(count > 0 || expected < 60.0, "nothing at {most}: no bound");
    }
}

#[portable_test]
fn detection_errors_that_are_none_say_nothing() {
    let none: [(f64, f64); 0] = [];
    assert_eq!(ln_p_of_errors(none.into_iter()), 0.0);
    let odd = [(f64::NAN, 0.5), (1.0, f64::NAN), (f64::INFINITY, 0.5)];
    assert_eq!(ln_p_of_errors(odd.into_iter()), 0.0);
    let held = ln_p_of_errors([(1.0, 9.0); 8].into_iter());
    assert_eq!(held, ln_p_of_errors([(1.0, 0.5); 8].into_iter()));
    assert!(ln_p_of_errors([(1.0, -0.4); 8].into_iter()) == 0.0);
    let sure = ln_p_of_errors([(1.0, 0.49); 100].into_iter());
    assert!(sure < -200.0, "{sure}");
}

#[portable_test]
fn detection_exponents_of_errors_add_up_to_the_bound() {
    let unit = |i: u32| f64::from(i * 37 % 101) / 101.0;
    let terms: Vec<(f64, f64)> = (0..400)
        .map(|i| (unit(i) - 0.2, unit(i)))
        .map(|(m, other)| (m, 0.3 * m + 0.2 * (other - 0.5)))
        .collect();
    let exponents = exponents_of_errors(&terms);
    let ln_p = ln_p_of_errors(terms.iter().copied());
    assert!(ln_p < -5.0, "{ln_p}");
    assert!((exponents.iter().sum::<f64>() + ln_p).abs() < 1e-9);
    assert_eq!(
        exponents_of_errors(&[(1.0, -0.5), (f64::NAN, 0.5)]),
        [0.0, 0.0]
    );
}
