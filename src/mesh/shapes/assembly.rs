//! Many parts.

use super::parts::{cuboid, cuboid_face, divided, lathe, mirrored, placed, reversed, sheet};
use super::revolution::{capsule, relief_sphere, torus};
use crate::mesh::Mesh;
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::TAU;

/// Seven separate shapes in a row, 3 apart: sphere, box, cylinder, cone, torus, capsule, hexagonal prism. V = 1 776.
pub fn seven_shapes() -> Mesh {
    let closed = |corners: &[(f64, f64)], sectors| lathe(&divided(corners, 5), sectors);
    let cylinder = closed(&[(0.0, 1.0), (0.8, 1.0), (0.8, -1.0), (0.0, -1.0)], 18);
    let cone = closed(&[(0.0, 1.0), (0.5, 0.0), (1.0, -1.0), (0.0, -1.0)], 18);
    let round = closed(&[(0.0, 0.9), (0.9, 0.9), (0.9, -0.9), (0.0, -0.9)], 18);
    let prism = round.with_positions(round.positions.iter().map(|&p| hexagonal(p)).collect());
    let sphere = relief_sphere(14, 18);
    let smooth = sphere.positions.iter().map(|p| p.normalize()).collect();
    let shapes = [
        sphere.with_positions(smooth),
        cuboid(DVec3::new(1.6, 1.2, 1.9), [6, 6, 7]),
        cylinder,
        cone,
        torus(24, 11),
        capsule(14, 18),
        prism,
    ];
    Mesh::joined((0u32..).zip(&shapes).map(|(number, shape)| {
        let place = DVec3::new(3.0 * f64::from(number), 0.0, 0.0);
        placed(shape, DAffine3::from_translation(place))
    }))
}

/// Draws a cylinder about the z axis in to a hexagonal prism.
fn hexagonal(p: DVec3) -> DVec3 {
    let sixth = TAU / 6.0;
    let azimuth = libm::atan2(p.y, p.x);
    let from_side = azimuth - (libm::floor(azimuth / sixth) + 0.5) * sixth;
    let scale = libm::cos(sixth / 2.0) / libm::cos(from_side);
    DVec3::new(p.x * scale, p.y * scale, p.z)
}

/// A rover as games have it: 56 parts that touch and cross, most of them open where nobody looks, some double-walled, with hard
/// edges; the left half mirrors the right one, but for an antenna, a dish and a spare wheel. Not welded where parts meet.
/// V = 9 901.
pub fn game_asset() -> Mesh {
    let mut parts = body();
    let mut right = vec![
        shell(20, 10, 0.02, |u, v| {
            DVec3::new(1.3 - 2.6 * u, 1.05 + 0.12 * bump(u), 0.15 + 0.4 * v)
        }),
        pipe(
            0.05,
            1.1,
            at(-1.1, 0.55, 0.75, DMat3::from_rotation_y(0.25)),
        ),
        pipe(0.04, 1.6, at(0.1, 0.85, 0.62, DMat3::from_rotation_y(1.45))),
        crate_box(
            DVec3::new(0.5, 0.3, 0.24),
            at(-0.35, 0.8, 0.78, DMat3::IDENTITY),
        ),
        crate_box(
            DVec3::new(0.3, 0.25, 0.2),
            at(0.45, 0.82, 0.74, DMat3::from_rotation_z(0.1)),
        ),
        lamp(at(1.45, 0.6, 0.4, DMat3::from_rotation_y(1.35))),
    ];
    for x in [-1.05, 0.0, 1.05] {
        right.extend(wheel(at(x, 1.1, -0.25, DMat3::from_rotation_x(-TAU / 4.0))));
        right.push(fender(at(x, 1.1, -0.25, DMat3::IDENTITY)));
    }
    parts.extend(right.iter().map(mirrored).collect::<Vec<_>>());
    parts.extend(right);
    // What makes the two halves differ.
    parts.extend(wheel(at(
        -1.5,
        0.25,
        0.45,
        DMat3::from_rotation_y(-TAU / 4.0),
    )));
    parts.push(pipe(
        0.015,
        1.3,
        at(-0.9, -0.45, 1.2, DMat3::from_rotation_y(-0.1)),
    ));
    parts.push(dish(at(-0.6, 0.3, 1.45, DMat3::from_rotation_y(0.6))));
    Mesh::joined(parts)
}

/// Hull, deck, cabin with its window frames, seat and mast.
fn body() -> Vec<Mesh> {
    let hull_size = DVec3::new(3.0, 1.7, 0.6);
    let tapered = |p: DVec3| {
        let nose = 1.0 - 0.25 * (p.x / 1.5).max(0.0) * (p.z / 0.3).max(0.0);
        DVec3::new(p.x, p.y * nose, p.z + 0.1)
    };
    // Open below.
    let hull = Mesh::joined([0, 1, 3, 4, 5].map(|face| cuboid_face(hull_size, [24, 14, 6], face)));
    let hull = hull.welded();
    let cabin = shell(24, 12, 0.03, |u, v| {
        let azimuth = TAU * (0.06 + 0.88 * u);
        let radius = 0.62 - 0.25 * v * v;
        DVec3::new(
            0.35 + radius * libm::cos(azimuth),
            radius * libm::sin(azimuth) * 1.1,
            0.4 + 0.7 * v,
        )
    });
    let roof = lathe(&divided(&[(0.0, 1.14), (0.3, 1.13), (0.42, 1.08)], 4), 24);
    let seat = crate_box(
        DVec3::new(0.4, 0.5, 0.35),
        at(0.2, 0.0, 0.6, DMat3::IDENTITY),
    );
    vec![
        hull.with_positions(hull.positions.iter().map(|&p| tapered(p)).collect()),
        cabin,
        placed(
            &roof,
            DAffine3::from_translation(DVec3::new(0.35, 0.0, 0.0)),
        ),
        seat,
        pipe(0.06, 0.8, at(-0.6, 0.3, 1.0, DMat3::IDENTITY)),
    ]
}

/// Rises and falls again from 0 to 1.
fn bump(u: f64) -> f64 {
    libm::sin(TAU / 2.0 * u)
}

fn at(x: f64, y: f64, z: f64, turn: DMat3) -> DAffine3 {
    DAffine3::from_mat3_translation(turn, DVec3::new(x, y, z))
}

/// A sheet and, `thickness` behind it, the same seen from the other side: two walls without rims.
fn shell(rows: u32, columns: u32, thickness: f64, position: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let normal = |u: f64, v: f64| {
        let step = 1e-3;
        let by_u = position(u + step, v) - position(u - step, v);
        let by_v = position(u, v + step) - position(u, v - step);
        by_u.cross(by_v).normalize_or_zero()
    };
    let inner = sheet(rows, columns, |u, v| {
        position(u, v) - thickness * normal(u, v)
    });
    Mesh::joined([sheet(rows, columns, &position), reversed(&inner)])
}

/// A tube, open at both ends.
fn pipe(radius: f64, length: f64, place: DAffine3) -> Mesh {
    let half = length / 2.0;
    placed(
        &lathe(&divided(&[(radius, half), (radius, -half)], 10), 10),
        place,
    )
}

/// A box without a floor.
fn crate_box(size: DVec3, place: DAffine3) -> Mesh {
    let faces = [0, 1, 3, 4, 5].map(|face| cuboid_face(size, [5, 4, 3], face));
    placed(&Mesh::joined(faces).welded(), place)
}

fn lamp(place: DAffine3) -> Mesh {
    let profile = [(0.0, 0.1), (0.12, 0.08), (0.14, 0.0), (0.06, -0.12)];
    placed(&lathe(&divided(&profile, 3), 14), place)
}

/// A bowl with a wall on each side.
fn dish(place: DAffine3) -> Mesh {
    let bowl = |t: f64| (0.4 * t, 0.25 * t * t);
    let profile: Vec<_> = (0..=10).map(|i| bowl(f64::from(10 - i) / 10.0)).collect();
    let outer = lathe(&profile, 24);
    let inner = placed(
        &outer,
        DAffine3::from_translation(DVec3::new(0.0, 0.0, 0.02)),
    );
    placed(&Mesh::joined([outer, reversed(&inner)]), place)
}

/// A tyre, a rim that is open behind, and a hub; about the z axis, 0.8 wide.
fn wheel(place: DAffine3) -> [Mesh; 3] {
    let tyre = torus(28, 12);
    let tyre = placed(&tyre, DAffine3::from_scale(DVec3::new(0.286, 0.286, 0.3)));
    let rim = lathe(
        &divided(&[(0.1, 0.04), (0.16, 0.02), (0.2, 0.1), (0.2, -0.1)], 3),
        20,
    );
    let hub = lathe(&divided(&[(0.0, 0.12), (0.07, 0.11), (0.09, 0.0)], 3), 12);
    [tyre, rim, hub].map(|part| placed(&part, place))
}

/// A double-walled arc above a wheel.
fn fender(place: DAffine3) -> Mesh {
    let arc = shell(16, 5, 0.015, |u, v| {
        let angle = TAU * (0.06 + 0.38 * u);
        DVec3::new(
            0.5 * libm::cos(angle),
            0.3 * v - 0.15,
            0.5 * libm::sin(angle),
        )
    });
    placed(&arc, place)
}
