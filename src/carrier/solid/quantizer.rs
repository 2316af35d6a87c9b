//! The quantizer: how a window's flux holds a symbol, and how near to it a flux is.

use std::f64::consts::TAU;

/// Steps of the quantizer: the displacement of a surface, in units of the frame, that takes a window of about a squared pitch
/// of it from one symbol to the same symbol again. Each is smaller than the one before by a factor of sqrt 2.
pub const STEPS: [f64; 6] = [0.035, 0.0247, 0.0175, 0.0124, 0.00875, 0.0062];

/// The steps for a strength, the largest first: 0.035 at 0.08 % of the diagonal, in proportion. Large steps stand more noise;
/// smaller ones ask less of meshes with few vertices.
pub fn steps_for(rms_rel: f64) -> &'static [f64] {
    let ideal = STEPS[0] * rms_rel / 0.0008;
    let first = STEPS.partition_point(|step| *step > 1.19 * ideal);
    &STEPS[first.min(STEPS.len() - 1)..]
}

/// The phase, in turns, of a flux in steps of the quantizer under a dither. Whole steps are dropped first: a suspect may offer a
/// flux of any size, and added to a large one the dither would be rounded away.
pub fn phase(steps: f64, dither: f64) -> f64 {
    fraction(steps) + dither
}

/// What is left of a number when the nearest whole one is taken off, -1/2 to 1/2, without any rounding.
fn fraction(number: f64) -> f64 {
    /// Adding and subtracting it rounds to the nearest whole number, for numbers up to a third of it.
    const ROUND: f64 = 1.5 / f64::EPSILON;
    /// Numbers beyond 2^50 count as this one, and so does what is no number: their fractions say nothing.
    const MOST: f64 = 0.25 / f64::EPSILON;
    let number = held(number, MOST);
    number - (number + ROUND - ROUND)
}

/// A number, or the nearest in `-most..=most`. What is none becomes `-most`, where `clamp` would leave it: nothing that follows has
/// to ask.
pub fn held(number: f64, most: f64) -> f64 {
    number.max(-most).min(most)
}

/// The cosine of an angle in turns, to within 1e-11, from additions and products alone: a detector takes millions of them.
pub fn cosine(turns: f64) -> f64 {
    let [cosine] = cosines([turns]);
    cosine
}

/// The cosines of some angles in turns: a processor takes two of them in the time of one.
pub fn cosines<const N: usize>(turns: [f64; N]) -> [f64; N] {
    /// Of the sine of an angle in turns: `(-1)^n tau^(2n+1) / (2n+1)!`.
    const SERIES: [f64; 8] = {
        let mut series = [TAU; 8];
        let mut n = 1;
        while n < 8 {
            series[n] = -series[n - 1] * TAU * TAU / ((2 * n) as f64 * (2 * n + 1) as f64);
            n += 1;
        }
        series
    };
    let quarters = turns.map(|turns| 0.25 - fraction(turns).abs());
    let mut sums = [0.0; N];
    for c in SERIES.iter().rev() {
        for (sum, quarter) in sums.iter_mut().zip(quarters) {
            *sum = *sum * (quarter * quarter) + c;
        }
    }
    for (sum, quarter) in sums.iter_mut().zip(quarters) {
        *sum *= quarter;
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::{cosine, phase};

    const STEPS: [f64; 9] = [
        0.0,
        -0.3,
        1e6 + 0.25,
        4e15,
        -1e17,
        1e300,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];

    #[test]
    fn no_flux_swallows_a_dither() {
        for steps in STEPS {
            let [none, some] = [0.0, 0.3].map(|dither| phase(steps, dither));
            assert!((some - none - 0.3).abs() < 1e-15, "{steps}");
            assert!((-0.5..=0.5).contains(&none), "{steps}");
        }
        assert_eq!(phase(1e6 + 0.25, 0.5), 0.75);
    }

    #[test]
    fn cosines_stay_within_one() {
        for turns in STEPS {
            assert!(cosine(turns).abs() <= 1.0 + 1e-11, "{turns}");
        }
        assert!((cosine(7.125) - 0.5f64.sqrt()).abs() < 1e-11);
    }
}
