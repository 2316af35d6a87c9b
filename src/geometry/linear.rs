//! Large sparse systems.

/// Solves `A x = b` from `x = 0` for a symmetric positive definite `A` (Hestenes and Stiefel 1952), until the residual is less
/// than `tolerance` of `b`, in at most `max_steps` steps.
pub fn conjugate_gradients(
    apply: impl Fn(&[f64]) -> Vec<f64>,
    b: Vec<f64>,
    tolerance: f64,
    max_steps: usize,
) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut x = vec![0.0; b.len()];
    let mut residual = b;
    let mut direction = residual.clone();
    let mut square = dot(&residual, &residual);
    let enough = tolerance * tolerance * square;
    for _ in 0..max_steps {
        if square <= enough {
            break;
        }
        let image = apply(&direction);
        let length = square / dot(&direction, &image);
        x.iter_mut()
            .zip(&direction)
            .for_each(|(x, d)| *x += length * d);
        residual
            .iter_mut()
            .zip(&image)
            .for_each(|(r, i)| *r -= length * i);
        let previous = std::mem::replace(&mut square, dot(&residual, &residual));
        direction
            .iter_mut()
            .zip(&residual)
            .for_each(|(d, r)| *d = r + square / previous * *d);
    }
    x
}
