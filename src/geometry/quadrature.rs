//! Integrals over a surface: as many sample points as a given resolution needs.

use glam::DVec3;

/// One part of a triangle, seen from its centroid.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Weights of the triangle's corners at the part's centroid.
    pub weights: [f64; 3],
    /// The centroid, in scene units.
    pub point: DVec3,
    /// The part's area times the triangle's normal.
    pub area: DVec3,
}

/// Triangles that are no longer than so many limits stay whole: those of usual meshes are short, and many.
const WHOLE: f64 = 2.0;

/// A triangle has so many slices at most, and a slice so many parts.
const MOST: f64 = 64.0;

/// Limits are doubled so many times at most: then each triangle is one part.
const COARSEST: u32 = 6;

/// Splits triangles into parts that are no longer than a limit, by lines from a corner and lines across them: long triangles have few.
pub struct Quadrature {
    max_edge: f64,
    /// How many times the limit was doubled.
    coarseness: u32,
}

/// How a triangle is split: into slices between its apex and the side across from it, equally thick, and each slice into parts of equal
/// areas.
struct Split {
    /// The corner across from the shortest side.
    apex: usize,
    num_slices: u32,
    /// The shortest side, in limits.
    base: f64,
}

impl Split {
    /// How many parts a slice has, those at the apex first.
    fn columns(&self, slice: u32) -> u32 {
        let far = f64::from(slice + 1) / f64::from(self.num_slices);
        ((far * self.base).ceil() as u32).max(1)
    }
}

impl Quadrature {
    /// A quadrature of parts up to `max_edge` long and wide, in scene units; of a triangle that is up to twice as long, one part.
    pub fn new(max_edge: f64) -> Quadrature {
        Quadrature {
            max_edge,
            coarseness: 0,
        }
    }

    /// The same for triangles that are to be no more parts than a number, or than they are: the limit is doubled until they are. Without
    /// that, a few kilobytes of needles cost as much as a scanned statue.
    pub fn at_most(
        self,
        num_parts: u64,
        triangles: impl Iterator<Item = [DVec3; 3]> + Clone,
    ) -> Quadrature {
        let with = |coarseness| Quadrature { coarseness, ..self };
        let are_few = |coarseness: &u32| {
            let quadrature = with(*coarseness);
            let parts = triangles.clone().map(|corners| {
                let split = quadrature.split(corners);
                let columns = (0..split.num_slices).map(|slice| split.columns(slice));
                u64::from(columns.sum::<u32>())
            });
            parts.sum::<u64>() <= num_parts
        };
        with((0..COARSEST).find(are_few).unwrap_or(COARSEST))
    }

    fn split(&self, [a, b, c]: [DVec3; 3]) -> Split {
        let sides = [b.distance(c), c.distance(a), a.distance(b)];
        let longest = sides.into_iter().fold(0.0, f64::max);
        if longest <= WHOLE * self.max_edge {
            return Split {
                apex: 0,
                num_slices: 1,
                base: 1.0,
            };
        }
        let in_limits =
            |side: f64| (side / self.max_edge).min(MOST) / f64::from(1u32 << self.coarseness);
        let apex = [1, 2].into_iter().fold(0, |apex, other| {
            if sides[other] < sides[apex] {
                other
            } else {
                apex
            }
        });
        Split {
            apex,
            num_slices: (in_limits(longest).ceil() as u32).max(1),
            base: in_limits(sides[apex]),
        }
    }

    /// The samples of a triangle, one for each part. Moments of the first order are exact in every part.
    pub fn samples(&self, corners: [DVec3; 3]) -> impl Iterator<Item = Sample> + use<> {
        let [a, b, c] = corners;
        let whole = (b - a).cross(c - a) * 0.5;
        let split = self.split(corners);
        let num_slices = f64::from(split.num_slices);
        (0..split.num_slices).flat_map(move |slice| {
            let columns = split.columns(slice);
            let i = f64::from(slice);
            // Of a slice from t0 to t1, of the way from the apex: its share of the area is t1^2 - t0^2, and its centroid lies at
            // 2/3 (t1^3 - t0^3) / (t1^2 - t0^2).
            let thickness = 2.0 * i + 1.0;
            let area = whole * (thickness / (num_slices * num_slices * f64::from(columns)));
            let depth = 2.0 / 3.0 * (3.0 * i * (i + 1.0) + 1.0) / (thickness * num_slices);
            let apex = split.apex;
            (0..columns).map(move |column| {
                let across = (f64::from(column) + 0.5) / f64::from(columns);
                let mut weights = [0.0; 3];
                weights[apex] = 1.0 - depth;
                weights[(apex + 1) % 3] = depth * (1.0 - across);
                weights[(apex + 2) % 3] = depth * across;
                Sample {
                    weights,
                    point: a * weights[0] + b * weights[1] + c * weights[2],
                    area,
                }
            })
        })
    }
}
