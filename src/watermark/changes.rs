//! What somebody did to a copy, as far as a comparison with the original shows it: in words, for a statement.

use super::report::{Comparison, Shape};
use crate::geometry::Motion;
use glam::{DMat3, DVec3};

/// Smaller changes of scale and stretches are not told: a registration is exact to some thousandths.
const LEAST_FACTOR: f64 = 0.01;
/// Nor are turns by less, in degrees.
const LEAST_TURN: f64 = 0.5;
/// Nor is a cut that leaves more than this: the border of every piece is uncertain.
const WHOLE: f64 = 0.97;
/// Nor are numbers of triangles that differ by less.
const LEAST_TRIANGLES: f64 = 0.02;

/// Each change in words. `triangles`: how many the suspect has where it lies on the original, as a share of what the original has there.
/// Nothing for another shape.
pub(super) fn changes(comparison: &Comparison, triangles: Option<f64>) -> Vec<String> {
    let mut changes = Vec::new();
    let (Shape::Same, Some([x, y, z, _])) = (comparison.shape, comparison.motion) else {
        return changes;
    };
    if comparison.covered < WHOLE {
        let left = 100.0 * comparison.covered;
        changes.push(format!(
            "cut: {left:.0} % of the original\u{2019}s surface is left"
        ));
    }
    if comparison.is_mirrored {
        changes.push("mirrored".to_owned());
    }
    if comparison.num_parts > 1 {
        let parts = comparison.num_parts;
        changes.push(format!(
            "taken apart: {parts} parts lie on the original, each moved by itself"
        ));
    }
    if comparison.is_bent {
        changes.push("bent into another pose".to_owned());
    }
    let linear = DMat3::from_cols(
        DVec3::from_array(x),
        DVec3::from_array(y),
        DVec3::from_array(z),
    );
    let onto_the_original = Motion {
        linear,
        ..Motion::IDENTITY
    };
    if let Some((factors, turn)) = onto_the_original.stretch_and_turn() {
        changes.extend(size(factors));
        let degrees = turn.to_degrees();
        if degrees >= LEAST_TURN {
            changes.push(format!("turned by {degrees:.0} degrees"));
        }
    }
    if let Some(share) = triangles.filter(|share| (share - 1.0).abs() >= LEAST_TRIANGLES) {
        let percent = 100.0 * share;
        changes.push(format!(
            "other triangles: {percent:.0} % of the number that the original has there"
        ));
    }
    changes
}

/// How the suspect's size differs. `factors`: what brings it back, along three axes.
fn size(factors: [f64; 3]) -> Option<String> {
    let [a, b, c] = factors.map(|factor| 1.0 / factor);
    let even = libm::cbrt(a * b * c);
    if c / a > 1.0 + LEAST_FACTOR {
        return Some(format!(
            "scaled by {c:.3}, {b:.3} and {a:.3} along three axes"
        ));
    }
    ((even - 1.0).abs() >= LEAST_FACTOR).then(|| format!("scaled by {even:.3}"))
}

#[cfg(test)]
mod tests {
    use super::super::report::Verdict;
    use super::{Comparison, Shape, changes};

    fn compared(scale: [f64; 3], covered: f64) -> Comparison {
        let [x, y, z] = scale;
        Comparison {
            verdict: Verdict::None,
            shape: Shape::Same,
            sentence: "",
            tag: None,
            number: None,
            witness: None,
            near: 1.0,
            covered,
            is_mirrored: false,
            num_parts: 1,
            is_bent: false,
            motion: Some([
                [0.0, x, 0.0],
                [-y, 0.0, 0.0],
                [0.0, 0.0, z],
                [5.0, 0.0, 0.0],
            ]),
            ln_p: 0.0,
            shows_ln_p: false,
        }
    }

    #[test]
    fn changes_are_told_of_the_copy_and_small_ones_are_not() {
        let halved = changes(&compared([0.5, 0.5, 0.5], 0.34), Some(0.51));
        let expected = [
            "cut: 34 % of the original\u{2019}s surface is left",
            "scaled by 2.000",
            "turned by 90 degrees",
            "other triangles: 51 % of the number that the original has there",
        ];
        assert_eq!(halved, expected);
        let stretched = changes(&compared([1.0, 0.5, 1.0], 0.99), None);
        assert_eq!(
            stretched[0],
            "scaled by 2.000, 1.000 and 1.000 along three axes"
        );
        assert_eq!(
            changes(&compared([1.001; 3], 0.98), Some(1.01)),
            ["turned by 90 degrees"]
        );
        let other = Comparison {
            shape: Shape::Other,
            ..compared([0.5; 3], 0.1)
        };
        assert!(changes(&other, Some(0.5)).is_empty());
    }
}
