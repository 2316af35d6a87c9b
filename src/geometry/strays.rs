//! What is strewn: a few small parts far from the model, which converters leave. They say nothing of how large the model is.

use crate::mesh::{Mesh, Sets};
use crate::order::order_by;
use glam::DVec3;

/// A part of so many triangles could be a model.
const FEW: usize = 100;

/// What strays have of the area and of the triangles, at most, all together.
const SHARE: f64 = 0.01;

/// No vertex is stray where none is farther from the area's centroid than this, in units of the spread about it: a stray lies a diagonal away
/// from the rest, which is two spreads or more, less what it has in the spread itself.
const NEAR: f64 = 1.8;

/// Says of each triangle whether it is no stray. A stray is a part, by vertices, of fewer than 100 triangles that lies farther from the box
/// of all larger parts than that is long; all together have a hundredth of the area and of the triangles at most. `None` where there are none.
/// O(F) for what keeps together, else O(F + P log P), P the number of parts.
pub fn without_strays(mesh: &Mesh) -> Option<Vec<bool>> {
    if !reaches_far(mesh) {
        return None;
    }
    let mut sets = Sets::new(mesh.positions.len());
    for &[a, b, c] in &mesh.triangles {
        sets.join(a, b);
        sets.join(b, c);
    }
    // Parts by number, in the order of their first triangles.
    let mut numbers = vec![u32::MAX; mesh.positions.len()];
    let mut next = 0;
    let mut number_of = |triangle: &[u32; 3]| {
        let number = &mut numbers[sets.find(triangle[0]) as usize];
        if *number == u32::MAX {
            *number = next;
            next += 1;
        }
        *number
    };
    let names: Vec<u32> = mesh.triangles.iter().map(&mut number_of).collect();
    if next == 1 {
        return None;
    }
    let mut parts = vec![Part::default(); next as usize];
    for (&triangle, &name) in mesh.triangles.iter().zip(&names) {
        parts[name as usize].add(mesh.corners(triangle));
    }
    let by_area = order_by(parts.iter().map(|part| !part.area.to_bits()));
    let mut model = parts[by_area.first()?.1 as usize].clone();
    let mut strays = Part::default();
    let mut stray: Vec<u32> = Vec::new();
    for (_, name) in by_area {
        let part = &parts[name as usize];
        if part.num_triangles < FEW && part.is_away_from(&model) {
            strays.area += part.area;
            strays.num_triangles += part.num_triangles;
            stray.push(name);
        } else {
            model.low = model.low.min(part.low);
            model.high = model.high.max(part.high);
        }
    }
    let total: f64 = parts.iter().map(|part| part.area).sum();
    let is_little = strays.area <= SHARE * total
        && strays.num_triangles as f64 <= SHARE * mesh.triangles.len() as f64;
    if stray.is_empty() || !is_little {
        return None;
    }
    let mut is_kept = vec![true; parts.len()];
    for name in stray {
        is_kept[name as usize] = false;
    }
    Some(names.iter().map(|&name| is_kept[name as usize]).collect())
}

/// Whether a vertex is far from all the others.
fn reaches_far(mesh: &Mesh) -> bool {
    let areas = || {
        mesh.triangles.iter().map(|&triangle| {
            let [a, b, c] = mesh.corners(triangle);
            ((b - a).cross(c - a).length(), (a + b + c) / 3.0)
        })
    };
    let (total, first) = areas().fold((0.0, DVec3::ZERO), |(total, first), (area, centre)| {
        (total + area, first + centre * area)
    });
    let centre = first / total;
    let square = areas()
        .map(|(area, middle)| area * middle.distance_squared(centre))
        .sum::<f64>();
    let spread = square / total;
    let far = |triangle: &[u32; 3]| {
        let distances = mesh.corners(*triangle).map(|p| p.distance_squared(centre));
        distances.iter().any(|d| *d > NEAR * NEAR * spread)
    };
    total > 0.0 && mesh.triangles.iter().any(far)
}

#[derive(Clone)]
struct Part {
    area: f64,
    num_triangles: usize,
    low: DVec3,
    high: DVec3,
}

impl Default for Part {
    fn default() -> Part {
        Part {
            area: 0.0,
            num_triangles: 0,
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
        }
    }
}

impl Part {
    fn add(&mut self, [a, b, c]: [DVec3; 3]) {
        self.area += (b - a).cross(c - a).length();
        self.num_triangles += 1;
        self.low = self.low.min(a).min(b).min(c);
        self.high = self.high.max(a).max(b).max(c);
    }

    /// Whether the boxes are farther from each other than the other one's diagonal.
    fn is_away_from(&self, other: &Part) -> bool {
        let gap = (self.low - other.high).max(other.low - self.high);
        gap.max(DVec3::ZERO).length() > other.low.distance(other.high)
    }
}
