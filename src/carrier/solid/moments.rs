//! The moments that define a frame: volume, centre and spread. A displacement that leaves them alone leaves the frame where it is.

use glam::DVec3;

/// One for the volume, three for the centre, six for the spread.
pub const MOMENTS: usize = 10;

pub type PerMoment<T> = [T; MOMENTS];

/// How the moments answer to the corner `y` of a triangle in units of its freedom: the integrals of its hat function times 1, y
/// and y y^T over the triangle, exact.
pub fn answers([a, b, c]: [DVec3; 3], y: DVec3, freedom: f64) -> PerMoment<DVec3> {
    let area = (b - a).cross(c - a) * (0.5 * freedom);
    let sum = a + b + c;
    let first = (sum + y) / 12.0;
    let second = |i: usize, j: usize| {
        let own = y[i] * sum[j] + sum[i] * y[j] + 2.0 * y[i] * y[j];
        (sum[i] * sum[j] + own + a[i] * a[j] + b[i] * b[j] + c[i] * c[j]) / 60.0
    };
    [
        1.0 / 3.0,
        first.x,
        first.y,
        first.z,
        second(0, 0),
        second(0, 1),
        second(0, 2),
        second(1, 1),
        second(1, 2),
        second(2, 2),
    ]
    .map(|value| area * value)
}

/// An orthonormal basis of what has these inner products: the transposed inverse of their Cholesky factor, without what depends
/// on those before it.
pub fn orthonormal(products: &PerMoment<PerMoment<f64>>) -> PerMoment<PerMoment<f64>> {
    let product = |a: &PerMoment<f64>, b: &PerMoment<f64>| -> f64 {
        (0..MOMENTS)
            .map(|i| a[i] * (0..MOMENTS).map(|j| products[i][j] * b[j]).sum::<f64>())
            .sum()
    };
    let mut inverse = [[0.0; MOMENTS]; MOMENTS];
    for k in 0..MOMENTS {
        let mut vector = [0.0; MOMENTS];
        vector[k] = 1.0;
        let whole = product(&vector, &vector);
        for _ in 0..2 {
            for before in &inverse[..k] {
                let part = product(before, &vector);
                vector
                    .iter_mut()
                    .zip(before)
                    .for_each(|(v, b)| *v -= part * b);
            }
        }
        let square = product(&vector, &vector);
        let scale = if square > 1e-12 * whole {
            1.0 / square.sqrt()
        } else {
            0.0
        };
        inverse[k] = vector.map(|v| v * scale);
    }
    inverse
}
