//! Triangles by their shape: which of them have a direction that is seen.

use glam::DVec3;

/// A triangle whose lowest altitude is a smaller part of its longest side than this is a sliver: little of its own normal is seen.
const SLIVER: f64 = 0.05;

/// A triangle whose lowest altitude is a smaller fraction of its part's diagonal than this has no direction: it is a line to the eye.
const FLAT: f64 = 1e-6;

/// What a triangle is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facet {
    /// Its normal is seen.
    Plain,
    /// A sliver: it may turn, but not over.
    Sliver,
    /// It has no normal to speak of.
    Flat,
}

impl Facet {
    /// Of corners, in a part of a diagonal.
    pub fn of([a, b, c]: [DVec3; 3], diagonal: f64) -> Facet {
        let twice_area = (b - a).cross(c - a).length();
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        if twice_area <= FLAT * diagonal * longest {
            Facet::Flat
        } else if twice_area < SLIVER * longest * longest {
            Facet::Sliver
        } else {
            Facet::Plain
        }
    }
}

/// Twice the area vector of a triangle.
pub fn twice_area([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}
