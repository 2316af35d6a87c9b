//! How far a mark has moved a mesh.

use glam::DVec3;

/// The diagonal of the axis-parallel bounding box, in the units of the positions; 0 without positions.
pub fn diagonal(positions: &[DVec3]) -> f64 {
    let Some(&first) = positions.first() else {
        return 0.0;
    };
    let (low, high) = positions
        .iter()
        .fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
    (high - low).length()
}

/// Displacement over all vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distortion {
    /// Vertices that moved.
    pub num_moved: usize,
    /// Root mean square, as a fraction of the host's diagonal.
    pub rms_rel: f64,
    /// Maximum, as a fraction of the host's diagonal.
    pub max_rel: f64,
}

impl Distortion {
    /// Compares V positions before and after, vertex by vertex.
    pub fn between(before: &[DVec3], after: &[DVec3]) -> Distortion {
        let squares = || {
            before
                .iter()
                .zip(after)
                .map(|(a, b)| a.distance_squared(*b))
        };
        let diagonal = diagonal(before);
        if diagonal == 0.0 {
            return Distortion::default();
        }
        Distortion {
            num_moved: squares().filter(|&square| square > 0.0).count(),
            rms_rel: (squares().sum::<f64>() / before.len() as f64).sqrt() / diagonal,
            max_rel: squares().fold(0.0, f64::max).sqrt() / diagonal,
        }
    }
}
