//! The vector areas of a surface, in cells of several sizes: all that the occupancy's smoothed derivatives depend on.

use crate::geometry::{Quadrature, Sample};
use crate::mesh::Mesh;
use crate::order::order_by;
use glam::DVec3;

/// Triangles are split until their parts are no longer or wider than this, in cells.
const EDGE: f64 = 0.5;
/// Parts that a surface is split into, at most, unless it has more triangles.
const MOST_PARTS: u64 = 1 << 21;

/// The surface in one cell that faces into one octant: two sides of a plate that is thinner than a cell do not cancel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Piece {
    /// Area-weighted centroid.
    pub point: DVec3,
    /// Sum of area vectors, outwards.
    pub area: DVec3,
    /// Sum of `(part - point) . area`.
    pub moment: f64,
    /// Sum of areas.
    pub weight: f64,
}

/// The surface in cells of one size.
#[derive(Clone, Debug)]
pub struct Level {
    /// Side of a cell, in scene units.
    pub cell: f64,
    /// In increasing order of cells.
    pub pieces: Vec<Piece>,
}

/// A surface in cells of several sizes, each twice the one before.
#[derive(Clone, Debug)]
pub struct Areas(Vec<Level>);

impl Areas {
    /// The areas of a mesh whose triangles face outwards, in so many sizes of cells.
    pub fn new(mesh: &Mesh, finest: f64, num_levels: usize) -> Areas {
        let corners = || mesh.triangles.iter().map(|&t| mesh.corners(t));
        let quadrature = Quadrature::new(EDGE * finest).at_most(MOST_PARTS, corners());
        let samples = corners().flat_map(|triangle| quadrature.samples(triangle));
        let part = |sample: Sample| Piece {
            point: sample.point,
            area: sample.area,
            weight: sample.area.length(),
            moment: 0.0,
        };
        let parts: Vec<Piece> = samples.map(part).collect();
        let mut levels = vec![gathered(&parts, finest)];
        while levels.len() < num_levels {
            let last = &levels[levels.len() - 1];
            levels.push(gathered(&last.pieces, 2.0 * last.cell));
        }
        Areas(levels)
    }

    /// What is left where all beyond a plane is cut off: whose distance along a direction is more than so much.
    pub fn cut(&self, direction: DVec3, distance: f64) -> Areas {
        let is_kept = |piece: &&Piece| piece.point.dot(direction) <= distance;
        let level = |level: &Level| Level {
            cell: level.cell,
            pieces: level.pieces.iter().filter(is_kept).copied().collect(),
        };
        Areas(self.0.iter().map(level).collect())
    }

    /// The levels, the finest first.
    pub fn levels(&self) -> &[Level] {
        &self.0
    }

    /// The level with the largest cells that are no larger than so much; the finest where none are.
    pub fn level(&self, largest: f64) -> &Level {
        let number = self.0.partition_point(|level| level.cell <= largest);
        &self.0[number.saturating_sub(1)]
    }
}

/// Pieces in cells of a size and by octants, counted from the corner of the pieces' own box: what is moved is in the same cells.
fn gathered(parts: &[Piece], cell: f64) -> Level {
    let low = parts
        .iter()
        .fold(DVec3::INFINITY, |low, part| low.min(part.point));
    let number = |part: &Piece| {
        let [i, j, k] = ((part.point - low) / cell).to_array();
        let cell = (i as u64) << 40 | (j as u64 & 0xf_ffff) << 20 | (k as u64 & 0xf_ffff);
        let [x, y, z] = part.area.to_array().map(|a| u64::from(a > 0.0));
        cell << 3 | x << 2 | y << 1 | z
    };
    let order = order_by(parts.iter().map(number));
    let pieces = order.chunk_by(|a, b| a.0 == b.0).filter_map(|run| {
        let mut sum = Piece::default();
        for &(_, index) in run {
            let part = &parts[index as usize];
            let offset = part.point - low;
            sum.point += offset * part.weight;
            sum.area += part.area;
            sum.moment += part.moment + offset.dot(part.area);
            sum.weight += part.weight;
        }
        let centre = sum.point / sum.weight;
        sum.point = low + centre;
        sum.moment -= centre.dot(sum.area);
        (sum.weight > 0.0).then_some(sum)
    });
    Level {
        cell,
        pieces: pieces.collect(),
    }
}
