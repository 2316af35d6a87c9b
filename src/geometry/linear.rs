//! Large sparse systems.

/// Takes `x` towards the solution of `A x = b` for a symmetric positive definite `A` (Hestenes and Stiefel 1952), until the residual
/// is not more than `tolerance` of `b`, in at most `max_steps` steps. `apply` is `A`; `precondition` is a rough inverse of it,
/// symmetric and positive definite too, [`unconditioned`] if there is none.
pub fn conjugate_gradients(
    apply: impl Fn(&[f64]) -> Vec<f64>,
    precondition: impl Fn(&[f64]) -> Vec<f64>,
    b: &[f64],
    x: &mut [f64],
    tolerance: f64,
    max_steps: usize,
) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut residual: Vec<f64> = b.iter().zip(apply(x)).map(|(b, y)| b - y).collect();
    let enough = tolerance * tolerance * dot(b, b);
    let mut scaled = precondition(&residual);
    let mut direction = scaled.clone();
    let mut square = dot(&residual, &scaled);
    for _ in 0..max_steps {
        if dot(&residual, &residual) <= enough {
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
        scaled = precondition(&residual);
        let previous = std::mem::replace(&mut square, dot(&residual, &scaled));
        direction
            .iter_mut()
            .zip(&scaled)
            .for_each(|(d, s)| *d = s + square / previous * *d);
    }
}

/// No preconditioner.
pub fn unconditioned(residual: &[f64]) -> Vec<f64> {
    residual.to_vec()
}
