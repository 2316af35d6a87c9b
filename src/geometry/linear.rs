//! Linear systems: large sparse ones, and the axes of small symmetric matrices.

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

/// Eigenvalues of a symmetric matrix, in no order, and their orthonormal eigenvectors, by Jacobi's cyclic rotations (Golub and Van
/// Loan, Matrix Computations, 8.5).
pub fn symmetric_eigen<const N: usize>(mut a: [[f64; N]; N]) -> ([f64; N], [[f64; N]; N]) {
    let mut v = [[0.0; N]; N];
    v.iter_mut().enumerate().for_each(|(i, row)| row[i] = 1.0);
    for _ in 0..12 {
        for p in 0..N {
            for q in p + 1..N {
                if a[p][q] == 0.0 {
                    continue;
                }
                let tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = tau.signum() / (tau.abs() + (1.0 + tau * tau).sqrt());
                let c = 1.0 / (1.0 + t * t).sqrt();
                let s = t * c;
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                for k in 0..N {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                    (v[p][k], v[q][k]) = (c * v[p][k] - s * v[q][k], s * v[p][k] + c * v[q][k]);
                }
            }
        }
    }
    (std::array::from_fn(|i| a[i][i]), v)
}
