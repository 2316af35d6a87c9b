//! Statistics of detection: how surprising an agreement is, and what may be said of it. Knows numbers, not meshes.
//!
//! Null hypothesis: the suspect was made without the key. The dithers of distinct addresses are then independent and
//! uniform whatever the suspect is, so `cos` of a dithered phase has mean 0 and `E exp(l cos) = I0(l) <= exp(l^2/4)`.
//! For weights and signs that do not depend on the dithers, Chernoff's bound gives
//! `P(sum w b cos >= T) <= exp(-T^2 / sum w^2)`: no model of the mesh is needed. All probabilities are natural
//! logarithms, so that they neither underflow nor lose digits.

/// Natural logarithm of the largest false-positive probability at which a mark counts as found: 1e-9.
pub const LN_P_FOUND: f64 = -20.723265836946414;

/// Natural logarithm of the largest false-positive probability at which something counts as a trace of a key: 1e-4.
pub const LN_P_TRACE: f64 = -9.210340371976182;

/// A sum of signed soft values and the energy of its weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistic {
    sum: f64,
    weight: f64,
    energy: f64,
}

impl Statistic {
    /// From pairs of (signed value, weight). The bound needs `0 <= weight` and `|value| <= weight`: it holds here, whatever
    /// is given. A weight below that, or none, counts as 0; a value beyond it counts as the nearest, and one that is no
    /// number as `-weight`.
    pub fn new(terms: impl IntoIterator<Item = (f64, f64)>) -> Statistic {
        terms
            .into_iter()
            .fold(Statistic::default(), |s, (value, weight)| {
                let weight = weight.max(0.0);
                let value = value.max(-weight).min(weight);
                Statistic {
                    sum: s.sum + value,
                    weight: s.weight + weight,
                    energy: s.energy + weight * weight,
                }
            })
    }

    /// The weighted agreement: 1 is perfect, 0 is chance, negative is worse than chance.
    pub fn agreement(&self) -> f64 {
        if self.weight > 0.0 {
            self.sum / self.weight
        } else {
            0.0
        }
    }

    /// `ln P <= -T^2 / sum w^2`, for one test declared in advance; 0 for a sum that is not positive.
    pub fn ln_p(&self) -> f64 {
        // Weights whose squares are too small or too large for a number say nothing.
        if self.sum > 0.0 && self.energy.is_normal() {
            let ratio = self.sum / self.energy.sqrt();
            -ratio * ratio
        } else {
            0.0
        }
    }
}

/// The union bound: the best of several tests, whose number enters as its natural logarithm; never above 0.
pub fn union(ln_p: f64, ln_num_tests: f64) -> f64 {
    (ln_p + ln_num_tests).min(0.0)
}

/// `ln P(sum m e >= T)` for errors e, each uniform from -1/2 to 1/2 and independent of the others, and numbers m that do not depend on them:
/// Chernoff's bound, `min over l of sum ln(sinh(x) / x) - l T` with `x = l m / 2`. From pairs of (m, e); an error beyond its range
/// counts as the nearest in it, and what is no number as none.
pub fn ln_p_of_errors(terms: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let terms = terms
        .filter(|(m, e)| m.is_finite() && e.is_finite())
        .map(|(m, e)| (m, e.clamp(-0.5, 0.5)));
    let (sum, square) = terms.clone().fold((0.0, 0.0), |(sum, square), (m, e)| {
        (sum + m * e, square + m * m)
    });
    if !(sum > 0.0 && square.is_normal()) {
        return 0.0;
    }
    // `ln(sinh(x) / x) <= x^2 / 6` gives a bound in one step, and where to begin.
    let simple = -6.0 * sum * sum / square;
    if simple > -1.0 {
        return simple;
    }
    simple.min(tilted(terms.clone(), best_tilt(terms, sum, square), sum))
}

/// Chernoff's bound at an l: every one gives a bound.
fn tilted(terms: impl Iterator<Item = (f64, f64)>, l: f64, sum: f64) -> f64 {
    let parts = terms.map(|(m, _)| ln_sinhc(0.5 * l * m.abs()));
    parts.sum::<f64>() - l * sum
}

/// The l that gives about the least bound, which is convex in it: Newton's method. Its slope is concave, so it comes nearer from below, and never passes.
fn best_tilt(terms: impl Iterator<Item = (f64, f64)> + Clone, sum: f64, square: f64) -> f64 {
    /// Beyond so many times where it begins, the bound is below what numbers of 64 bits are sure of.
    const FARTHEST: f64 = 100.0;
    /// More steps than strong marks take, and the relative change after which no more are made: the bound then changes by its square.
    const ROUNDS: usize = 12;
    const LEAST_CHANGE: f64 = 1e-4;
    let mut l = 12.0 * sum / square;
    let last = FARTHEST * l;
    for _ in 0..ROUNDS {
        let (mut slope, mut bend) = (-sum, 0.0);
        for (m, _) in terms.clone() {
            let half = 0.5 * m.abs();
            let [first, second] = langevin(l * half);
            slope += half * first;
            bend += half * half * second;
        }
        let before = l;
        // What is no number changes nothing.
        l = (l - slope / bend).max(l).min(last);
        if l - before <= LEAST_CHANGE * l {
            break;
        }
    }
    l
}

/// Below this, where most windows are, series stand for logarithms and exponentials: they take a fifth of the time.
const SMALL: f64 = 1.0;

/// The first two derivatives of `ln(sinh(x) / x)`, for x that is not negative: Langevin's function, `coth(x) - 1 / x`, and its own. To one part in
/// 10^4 at least: a tilt that is off by that changes a bound by its square.
fn langevin(x: f64) -> [f64; 2] {
    if x < SMALL {
        let s = x * x;
        let first = 1.0 / 3.0
            - s * (1.0 / 45.0 - s * (2.0 / 945.0 - s * (1.0 / 4725.0 - s * (2.0 / 93_555.0))));
        let second = 1.0 / 3.0
            - s * (1.0 / 15.0 - s * (2.0 / 189.0 - s * (1.0 / 675.0 - s * (2.0 / 10_395.0))));
        return [x * first, second];
    }
    let e = libm::exp(-2.0 * x);
    let coth = (1.0 + e) / (1.0 - e);
    [coth - 1.0 / x, 1.0 / (x * x) - (coth * coth - 1.0)]
}

/// What each pair adds to the exponent of [`ln_p_of_errors`], before charges: above 0 where it speaks for the errors' being no chance.
/// Nothing where the pairs together say nothing.
pub fn exponents_of_errors(terms: &[(f64, f64)]) -> Vec<f64> {
    let usable = |&(m, e): &(f64, f64)| match m.is_finite() && e.is_finite() {
        true => (m, e.clamp(-0.5, 0.5)),
        false => (0.0, 0.0),
    };
    let terms = terms.iter().map(usable);
    let sum: f64 = terms.clone().map(|(m, e)| m * e).sum();
    let square: f64 = terms.clone().map(|(m, _)| m * m).sum();
    if !(sum > 0.0 && square.is_normal()) {
        return vec![0.0; terms.len()];
    }
    let l = best_tilt(terms.clone(), sum, square);
    let exponent = |(m, e): (f64, f64)| l * m * e - ln_sinhc(0.5 * l * m.abs());
    terms.map(exponent).collect()
}

/// `ln(sinh(x) / x)` for x that is not negative. Its series has terms of either sign by turns, each smaller than the one before; it ends after one that
/// adds, so that it is never below.
fn ln_sinhc(x: f64) -> f64 {
    if x < SMALL {
        let s = x * x;
        s * (1.0 / 6.0
            - s * (1.0 / 180.0 - s * (1.0 / 2835.0 - s * (1.0 / 37_800.0 - s * (1.0 / 467_775.0)))))
    } else {
        x + libm::log1p(-libm::exp(-2.0 * x)) - libm::log(2.0 * x)
    }
}
