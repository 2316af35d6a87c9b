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
