//! Places come back: moved, turned, in other triangles, and in a piece that was cut out.

use glam::DVec3;
use meshmark::internals::attack::{crop, midpoint, mirror, remesh, similarity};
use meshmark::internals::geometry::places::{Invariant, Place, SUPPORT, areas, places};
use meshmark::internals::geometry::{diagonal, oriented};
use meshmark::internals::mesh::{Mesh, shapes};
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::LazyLock;

/// The smallest and the largest width, as fractions of the diagonal.
const WIDTHS: [f64; 2] = [0.02, 0.1];

/// The places of a mesh whose width is in a range that is measured in a diagonal.
fn found(mesh: &Mesh, diagonal: f64) -> Vec<Place> {
    let widths = WIDTHS[0] * diagonal..WIDTHS[1] * diagonal;
    let areas = areas(&oriented(mesh).0, &widths);
    places(&areas, &widths)
}

/// A model, and its places that are sharp and whose width is well within the range.
struct Whole {
    name: &'static str,
    mesh: Mesh,
    sharp: Vec<Place>,
}

impl Whole {
    fn new(name: &'static str, mesh: Mesh) -> Whole {
        let diagonal = diagonal(&mesh.positions);
        let mut sharp = found(&mesh, diagonal);
        sharp.retain(|p| p.sharpness > 0.03 && p.width > 1.1 * WIDTHS[0] * diagonal);
        sharp.retain(|p| p.width < 0.9 * WIDTHS[1] * diagonal);
        assert!(sharp.len() > 8, "{} sharp places", sharp.len());
        Whole { name, mesh, sharp }
    }
}

/// Measured once for all tests.
static WHOLES: LazyLock<[Whole; 2]> = LazyLock::new(|| {
    [
        Whole::new("creature", shapes::low_poly()),
        Whole::new("rover", shapes::game_asset()),
    ]
});

/// How far the place of the same kind that is nearest to where one should be is from it, in widths, and how much its own width differs.
fn miss(all: &[Place], kind: (Invariant, bool), point: DVec3, width: f64) -> f64 {
    let same = all.iter().filter(|p| (p.invariant, p.is_high) == kind);
    let misses = same.map(|p| {
        let ln = libm::log(p.width / width).abs();
        (p.point.distance(point) / width).max(ln)
    });
    misses.fold(f64::INFINITY, f64::min)
}

#[test]
fn places_go_where_a_model_goes() {
    hold_moved(0..1);
}

#[test]
#[ignore = "takes twice as long: cargo xtask test --all"]
fn places_go_wherever_a_model_goes() {
    hold_moved(1..3);
}

/// Under similarities of these seeds.
fn hold_moved(seeds: Range<u64>) {
    for Whole { name, mesh, sharp } in &*WHOLES {
        for seed in seeds.clone() {
            let moved = similarity(mesh, seed);
            let vertex = |number: usize| (mesh.positions[number], moved.positions[number]);
            let scale = vertex(0).1.distance(vertex(9).1) / vertex(0).0.distance(vertex(9).0);
            let size = scale * diagonal(&mesh.positions);
            let all = found(&moved, size);
            let affine = Affine::of(mesh, &moved);
            let is_lost = |place: &&Place| {
                let kind = (place.invariant, place.is_high);
                miss(&all, kind, affine.at(place.point), scale * place.width) > 0.03
            };
            // A grid that lies otherwise may step over one where two are near each other.
            let lost = sharp.iter().filter(is_lost).count();
            assert!(
                10 * lost <= sharp.len(),
                "{name}: {lost} of {}",
                sharp.len()
            );
        }
    }
}

/// The affine map between two meshes whose vertices correspond, by four of them.
struct Affine(DVec3, glam::DMat3, DVec3);

impl Affine {
    fn of(from: &Mesh, to: &Mesh) -> Affine {
        let count = from.positions.len();
        let pick = [0, count / 4, count / 2, 3 * count / 4 + 1];
        let edges = |mesh: &Mesh| {
            let [a, b, c, d] = pick.map(|v| mesh.positions[v]);
            glam::DMat3::from_cols(b - a, c - a, d - a)
        };
        let linear = edges(to) * edges(from).inverse();
        Affine(from.positions[0], linear, to.positions[0])
    }

    fn at(&self, point: DVec3) -> DVec3 {
        self.1 * (point - self.0) + self.2
    }
}

#[test]
fn places_do_not_depend_on_triangles() {
    for Whole { name, mesh, sharp } in &*WHOLES {
        let size = diagonal(&mesh.positions);
        for (attack, mesh, most) in [
            ("split", midpoint(mesh), 0.02),
            ("remeshed", remesh(mesh, 0.01), 0.2),
        ] {
            let all = found(&mesh, size);
            let misses = sharp.iter().map(|place| {
                let kind = (place.invariant, place.is_high);
                miss(&all, kind, place.point, place.width)
            });
            let lost = misses.clone().filter(|miss| *miss > most).count();
            assert!(
                10 * lost <= sharp.len(),
                "{name} {attack}: {lost} of {} lost",
                sharp.len()
            );
        }
    }
}

#[test]
fn places_of_a_piece_are_those_of_the_whole() {
    let mut num_inside = 0;
    for Whole { name, mesh, sharp } in &*WHOLES {
        let size = diagonal(&mesh.positions);
        for seed in 0..2 {
            let piece = crop(mesh, 0.5, seed);
            let all = found(&piece, size);
            let bits = |p: &DVec3| p.to_array().map(f64::to_bits);
            let kept: BTreeSet<[u64; 3]> = piece.positions.iter().map(bits).collect();
            let positions = mesh.positions.iter();
            let lost: Vec<&DVec3> = positions.filter(|p| !kept.contains(&bits(p))).collect();
            for place in sharp {
                // A vertex that was lost took its triangles along, which reach as far as their sides.
                let support = SUPPORT * 1.12 * place.width + 0.06 * size;
                let is_inside = |p: &&DVec3| p.distance(place.point) > support;
                if lost.iter().all(is_inside) {
                    num_inside += 1;
                    let kind = (place.invariant, place.is_high);
                    let miss = miss(&all, kind, place.point, place.width);
                    assert!(miss < 0.03, "{name}, {place:?} misses by {miss}");
                }
            }
        }
    }
    assert!(num_inside > 10, "{num_inside} places were inside");
}

#[test]
fn places_of_a_mirrored_copy_are_mirrored() {
    let Whole { mesh, sharp, .. } = &WHOLES[0];
    let mirrored = mirror(mesh);
    let all = found(&mirrored, diagonal(&mesh.positions));
    let affine = Affine::of(mesh, &mirrored);
    for place in sharp {
        let kind = (place.invariant, place.is_high);
        let miss = miss(&all, kind, affine.at(place.point), place.width);
        assert!(miss < 0.03, "{place:?} misses by {miss}");
    }
}

#[test]
fn places_turn_with_their_model() {
    let Whole { mesh, sharp, .. } = &WHOLES[0];
    let moved = similarity(mesh, 7);
    let affine = Affine::of(mesh, &moved);
    let scale = affine.1.x_axis.length();
    let size = diagonal(&mesh.positions) * scale;
    let all = found(&moved, size);
    let mut num_compared = 0;
    for place in sharp {
        let at = affine.at(place.point);
        let same = all.iter().find(|p| {
            p.invariant == place.invariant
                && p.is_high == place.is_high
                && p.point.distance(at) < 0.05 * p.width
        });
        for (before, after) in place.frames.iter().zip(same.expect("it is there").frames) {
            if before.gap < 0.05 {
                continue;
            }
            num_compared += 1;
            let turned = affine.1 * before.axes * (1.0 / scale);
            let between = turned.transpose() * after.axes;
            for axis in 0..3 {
                let cosine = between.col(axis)[axis].abs();
                assert!(cosine > 0.9995, "{place:?}: axis {axis}, {cosine}");
            }
        }
    }
    assert!(num_compared > 8, "{num_compared} frames");
}
