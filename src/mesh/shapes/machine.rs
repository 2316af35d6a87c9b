//! A machined part.

use super::parts::{band, reversed, sheet};
use crate::mesh::Mesh;
use glam::DVec3;
use std::f64::consts::TAU;

/// Quads on a tile's side.
const CELLS: u32 = 8;
/// Quads around a tile.
const AROUND: u32 = 4 * CELLS;
/// Quads between a hole and its tile's border, and from a floor's edge to its middle.
const ACROSS: u32 = 4;
/// Quads down a wall.
const DOWN: u32 = 6;
/// Half the plate's thickness.
const HALF: f64 = 0.3;
/// Radius of the fillet between its top and its sides.
const FILLET: f64 = 0.2;
/// Tiles of side 1 along x and y.
const TILES: [u32; 2] = [4, 3];

/// What is done to a tile: nothing, a hole of a radius, or a round pocket of a radius and a depth: a boss, where that is
/// negative.
#[derive(Clone, Copy)]
enum Feature {
    Plain,
    Through(f64),
    Pocket(f64, f64),
}

/// A plate with a fillet around its upper edge, six holes, a pocket and a boss: flat sides, hard edges and cylinders. Closed,
/// of genus 6, V = 5 526.
pub fn cad_part() -> Mesh {
    use Feature::{Plain, Pocket, Through};
    let features = [
        [Through(0.3), Plain, Through(0.2), Through(0.2)],
        [Pocket(0.35, 0.25), Plain, Pocket(0.3, -0.5), Plain],
        [Through(0.3), Through(0.25), Plain, Through(0.15)],
    ];
    let mut parts = vec![rim()];
    for (row, features) in (0..).zip(features) {
        for (column, feature) in (0..).zip(features) {
            let tile = Tile { column, row };
            match feature {
                Plain => parts.extend([tile.flat(HALF), reversed(&tile.flat(-HALF))]),
                Through(radius) => parts.extend([
                    tile.ring(radius, HALF),
                    tile.wall(radius, -HALF),
                    reversed(&tile.ring(radius, -HALF)),
                ]),
                Pocket(radius, depth) => parts.extend([
                    tile.ring(radius, HALF),
                    tile.wall(radius, HALF - depth),
                    tile.floor(radius, HALF - depth),
                    reversed(&tile.flat(-HALF)),
                ]),
            }
        }
    }
    Mesh::joined(parts).welded()
}

/// A square of side 1 of the plate. What lies on the same height of two tiles' common side is equal to the bit: its
/// coordinates are eighths.
struct Tile {
    column: u32,
    row: u32,
}

impl Tile {
    fn at(&self, x: f64, y: f64, height: f64) -> DVec3 {
        DVec3::new(f64::from(self.column) + x, f64::from(self.row) + y, height)
    }

    /// The whole square, seen from above.
    fn flat(&self, height: f64) -> Mesh {
        sheet(CELLS, CELLS, |x, y| self.at(x, y, height))
    }

    /// A point on the border, counter-clockwise.
    fn border(&self, around: u32, height: f64) -> DVec3 {
        let [x, y] = perimeter([CELLS, CELLS], around).map(|n| f64::from(n) / f64::from(CELLS));
        self.at(x, y, height)
    }

    /// A point on a circle, in the direction of a point on the border.
    fn circle(&self, around: u32, radius: f64, height: f64) -> DVec3 {
        let centre = self.at(0.5, 0.5, height);
        centre + (self.border(around, height) - centre).normalize() * radius
    }

    /// The square without a circle, seen from above.
    fn ring(&self, radius: f64, height: f64) -> Mesh {
        band(ACROSS, AROUND, |i, j| {
            let outwards = f64::from(i) / f64::from(ACROSS);
            self.circle(j, radius, height)
                .lerp(self.border(j, height), outwards)
        })
    }

    /// A cylinder from the top to a height, seen from within if it goes down, from without if it goes up.
    fn wall(&self, radius: f64, to: f64) -> Mesh {
        reversed(&band(DOWN, AROUND, |i, j| {
            let down = f64::from(i) / f64::from(DOWN);
            self.circle(j, radius, HALF * (1.0 - down) + to * down)
        }))
    }

    /// A disc, seen from above.
    fn floor(&self, radius: f64, height: f64) -> Mesh {
        reversed(&band(ACROSS, AROUND, |i, j| {
            let outwards = 1.0 - f64::from(i) / f64::from(ACROSS);
            self.circle(j, radius * outwards, height)
        }))
    }
}

/// The side all around: the fillet, down, and inwards to the bottom's tiles.
fn rim() -> Mesh {
    let mut profile: Vec<(f64, f64)> = (0..=ACROSS)
        .map(|i| TAU / 4.0 * f64::from(i) / f64::from(ACROSS))
        .map(|turn| {
            (
                FILLET * libm::sin(turn),
                HALF - FILLET * (1.0 - libm::cos(turn)),
            )
        })
        .collect();
    profile.extend((1..DOWN).map(|i| {
        let down = f64::from(i) / f64::from(DOWN);
        (FILLET, (HALF - FILLET) * (1.0 - down) - HALF * down)
    }));
    profile.extend([(FILLET, -HALF), (FILLET / 2.0, -HALF), (0.0, -HALF)]);
    let cells = TILES.map(|tiles| tiles * CELLS);
    band(
        profile.len() as u32 - 1,
        2 * (cells[0] + cells[1]),
        |i, j| {
            let (out, height) = profile[i as usize];
            let corner = perimeter(cells, j);
            let [x, y] = [0, 1].map(|axis| {
                let place = f64::from(corner[axis]) / f64::from(CELLS);
                match corner[axis] {
                    0 => place - out,
                    end if end == cells[axis] => place + out,
                    _ => place,
                }
            });
            DVec3::new(x, y, height)
        },
    )
}

/// The points with whole coordinates on the border of a rectangle, counter-clockwise from its lower left corner.
fn perimeter([width, height]: [u32; 2], around: u32) -> [u32; 2] {
    if around < width {
        [around, 0]
    } else if around < width + height {
        [width, around - width]
    } else if around < 2 * width + height {
        [2 * width + height - around, height]
    } else {
        [0, 2 * (width + height) - around]
    }
}
