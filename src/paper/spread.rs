//! What several draws of one number say.

use serde::Serialize;

/// The mean of draws, and how far they lie from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Spread {
    /// Arithmetic mean; 0 without draws.
    pub mean: f64,
    /// Standard deviation of the draws, not of their mean; 0 with fewer than two.
    pub deviation: f64,
    /// The least.
    pub least: f64,
    /// The greatest.
    pub most: f64,
}

impl Spread {
    /// The spread of draws.
    pub fn of(draws: &[f64]) -> Spread {
        let Some(&first) = draws.first() else {
            return Spread::default();
        };
        let count = draws.len() as f64;
        let mean = draws.iter().sum::<f64>() / count;
        let squares: f64 = draws.iter().map(|draw| (draw - mean) * (draw - mean)).sum();
        Spread {
            mean,
            deviation: (squares / (count - 1.0).max(1.0)).sqrt(),
            least: draws.iter().copied().fold(first, f64::min),
            most: draws.iter().copied().fold(first, f64::max),
        }
    }
}
