//! The method that papers compare with: mean modification of vertex norms (Cho, Prost and Jung 2007, method I).
//!
//! Vertex norms about the vertices' mean, from the least to the largest, are divided into as many bins of equal width as there are bits.
//! Norms in a bin are brought to 0 to 1 and raised to a power, so that their mean is above 1/2 by the strength for a 1, below it for a 0.
//! Reading needs no key and no original: the mean of each bin against 1/2.

use glam::DVec3;
use meshmark::internals::geometry::Distortion;
use meshmark::internals::mesh::Mesh;

/// Halvings that find the strength, and each bin's power.
const HALVINGS: u32 = 40;
/// Powers are sought from its inverse up to this.
const STRONGEST: f64 = 64.0;

/// Embeds bits, one a bin, with the strength at which the RMS displacement, as a fraction of the bounding box's diagonal, is
/// `rms_rel`; or nearest to it, where no strength gives as much. Returns the RMS displacement that there is.
pub fn embed(mesh: &Mesh, bits: &[bool], rms_rel: f64) -> (Mesh, f64) {
    let rms = |copy: &Mesh| Distortion::between(&mesh.positions, &copy.positions).rms_rel;
    let (mut weak, mut strong) = (0.0, 0.5);
    for _ in 0..HALVINGS {
        let middle = (weak + strong) / 2.0;
        if rms(&embed_at(mesh, bits, middle)) < rms_rel {
            weak = middle;
        } else {
            strong = middle;
        }
    }
    let copy = embed_at(mesh, bits, weak);
    let achieved = rms(&copy);
    (copy, achieved)
}

/// Reads bits; those of empty bins are 0.
pub fn extract(mesh: &Mesh, num_bits: usize) -> Vec<bool> {
    let bins = Norms::of(mesh).bins(num_bits);
    let mean = |bin: &Vec<(usize, f64)>| mean(bin.iter().map(|(_, part)| *part));
    bins.iter().map(|bin| mean(bin) > 0.5).collect()
}

fn embed_at(mesh: &Mesh, bits: &[bool], strength: f64) -> Mesh {
    let norms = Norms::of(mesh);
    let mut copy = mesh.clone();
    for ((number, bin), &bit) in norms.bins(bits.len()).iter().enumerate().zip(bits) {
        let power = power(bin, bit, strength);
        for &(vertex, part) in bin {
            let offset = mesh.positions[vertex] - norms.centre;
            let norm = norms.norm(number as f64 + libm::pow(part, power), bits.len());
            copy.positions[vertex] = norms.centre + offset.normalize_or_zero() * norm;
        }
    }
    copy
}

/// The power that brings a bin's mean to 1/2 and the strength above, or below; 1 where it is there already.
fn power(bin: &[(usize, f64)], bit: bool, strength: f64) -> f64 {
    let is_done = |power: f64| {
        let mean = mean(bin.iter().map(|(_, part)| libm::pow(*part, power)));
        if bit {
            mean >= 0.5 + strength
        } else {
            mean <= 0.5 - strength
        }
    };
    if bin.is_empty() || is_done(1.0) {
        return 1.0;
    }
    // Geometric: powers below 1 raise the mean, above it they lower it.
    let exponent = |x: f64| libm::pow(STRONGEST, if bit { -x } else { x });
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if is_done(exponent(middle)) {
            high = middle;
        } else {
            low = middle;
        }
    }
    exponent(high)
}

/// 1/2 of nothing, so that it says neither.
fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len();
    if count == 0 {
        0.5
    } else {
        values.sum::<f64>() / count as f64
    }
}

/// Distances of the vertices from their mean.
struct Norms {
    centre: DVec3,
    values: Vec<f64>,
    least: f64,
    largest: f64,
}

impl Norms {
    fn of(mesh: &Mesh) -> Norms {
        let count = mesh.positions.len().max(1) as f64;
        let centre = mesh.positions.iter().sum::<DVec3>() / count;
        let values: Vec<f64> = mesh.positions.iter().map(|p| p.distance(centre)).collect();
        Norms {
            least: values.iter().copied().fold(f64::INFINITY, f64::min),
            largest: values.iter().copied().fold(0.0, f64::max),
            centre,
            values,
        }
    }

    /// The vertices of each bin, with their places in it, 0 to 1. The least and the largest norm are in none: they are what bins are
    /// found again by.
    fn bins(&self, count: usize) -> Vec<Vec<(usize, f64)>> {
        let mut bins = vec![Vec::new(); count];
        let width = (self.largest - self.least) / count as f64;
        for (vertex, &norm) in self.values.iter().enumerate() {
            let place = (norm - self.least) / width;
            if norm > self.least && norm < self.largest {
                let bin = (place as usize).min(count - 1);
                bins[bin].push((vertex, place - bin as f64));
            }
        }
        bins
    }

    /// The norm of a place, in bins from the least.
    fn norm(&self, place: f64, count: usize) -> f64 {
        self.least + place * (self.largest - self.least) / count as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use meshmark::internals::attack::{noise, reorder, similarity, smooth};
    use meshmark::internals::mesh::shapes;

    fn bits() -> Vec<bool> {
        (0..64).map(|i| i * i % 7 < 3).collect()
    }

    #[test]
    fn a_mark_is_read_again_wherever_the_model_is() {
        let mesh = shapes::asteroid(80, 120);
        let (marked, achieved) = embed(&mesh, &bits(), 5e-4);
        assert!((achieved / 5e-4 - 1.0).abs() < 0.05, "{achieved}");
        for copy in [marked.clone(), reorder(&marked, 1), similarity(&marked, 2)] {
            assert_eq!(extract(&copy, 64), bits());
        }
        let wrong = |mesh: &Mesh| {
            let read = extract(mesh, 64);
            read.iter().zip(bits()).filter(|(a, b)| **a != *b).count()
        };
        assert!(wrong(&mesh) > 10, "not there before: {}", wrong(&mesh));
        let little = wrong(&noise(&marked, 0.0005, 3));
        let much = wrong(&smooth(&marked, 0.1, 200));
        assert!(little < 8 && little <= much, "{little} {much}");
    }

    #[test]
    fn a_weaker_mark_moves_less() {
        let mesh = shapes::asteroid(80, 120);
        let [weak, strong] = [2e-4, 8e-4].map(|rms| embed(&mesh, &bits(), rms).1);
        assert!(weak < strong && weak <= 2e-4 && strong <= 8e-4);
    }
}
