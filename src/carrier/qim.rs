//! Quantization index modulation (Chen and Wornell 2001): a number holds a bit by which quantizer's points it lies at.

use std::f64::consts::TAU;

/// The point of the quantizer of a bit that is nearest to `x`. The nominal quantizer's points, the multiples of the
/// step, are moved up by a quarter of it for a 1 and down for a 0: Eq. 5 of Vasic 2012.
pub fn quantize(x: f64, bit: bool, step: f64) -> f64 {
    let offset = if bit { 0.25 * step } else { -0.25 * step };
    step * ((x - offset) / step).round() + offset
}

/// The curvature of the parabola that majorises what a symbol loses, the negative cosine of its error in steps: it touches that from
/// above at the error, and has its least value at 0. From 1, without an error, to 0, half a step off.
pub fn curvature(error: f64) -> f64 {
    let angle = TAU * error.abs();
    if angle > 0.0 {
        libm::sin(angle) / angle
    } else {
        1.0
    }
}
