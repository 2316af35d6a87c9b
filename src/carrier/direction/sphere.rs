//! The sphere of directions, in cells.

use glam::DVec3;
use std::f64::consts::PI;

/// Cells by their centres: unit vectors that cover the sphere evenly, descending along z.
pub struct Sphere(Vec<DVec3>);

impl Sphere {
    /// A number of cells about the points of a Fibonacci spiral.
    pub fn new(count: usize) -> Sphere {
        let turn = PI * (1.0 + 5f64.sqrt());
        let direction = |number: usize| {
            let place = number as f64 + 0.5;
            let z = 1.0 - 2.0 * place / count as f64;
            let (sine, cosine) = libm::sincos(turn * place);
            let radius = (1.0 - z * z).sqrt();
            DVec3::new(radius * cosine, radius * sine, z)
        };
        Sphere((0..count).map(direction).collect())
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The cell of a direction, and how much nearer its centre is than any other, as chords. Centres lie in order of z.
    pub fn cell(&self, direction: DVec3) -> (usize, f64) {
        let centres = &self.0;
        let middle = centres.partition_point(|centre| centre.z > direction.z);
        let (mut best, mut nearest, mut second) = (0, f64::INFINITY, f64::INFINITY);
        let mut visit = |cell: usize| {
            let rise = centres[cell].z - direction.z;
            if rise * rise >= second {
                return false;
            }
            let square = centres[cell].distance_squared(direction);
            if square < nearest {
                (best, nearest, second) = (cell, square, nearest);
            } else {
                second = second.min(square);
            }
            true
        };
        let (mut above, mut below) = (middle, middle);
        let (mut goes_up, mut goes_down) = (true, true);
        while goes_up || goes_down {
            goes_up = goes_up && above > 0 && visit(above - 1);
            above -= usize::from(goes_up);
            goes_down = goes_down && below < centres.len() && visit(below);
            below += usize::from(goes_down);
        }
        (best, second.sqrt() - nearest.sqrt())
    }
}
