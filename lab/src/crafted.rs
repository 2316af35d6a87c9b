//! Suspects that somebody makes to break the bound: many terms, few dithers.

use glam::DVec3;
use meshmark::Evidence;
use meshmark::internals::attack::mirror;
use meshmark::internals::carrier::{Measurement, ring, solid};
use meshmark::internals::mesh::{Mesh, shapes};

/// Each by its name.
pub fn suspects() -> Vec<(String, Evidence)> {
    let of_meshes = [
        ("a box of regular squares", regular_box()),
        ("identical boxes", identical_boxes()),
        ("a mirrored pair", mirrored_pair()),
    ];
    let of_rings = [
        ("cells of one address", cells_of_one_address()),
        ("neighbourhoods many times", repeated_neighbourhoods()),
        ("cells mirrored", mirrored_cells()),
    ];
    let meshes = of_meshes.map(|(name, mesh)| {
        let evidence = Evidence::from_iter([
            Measurement::Ring(ring::Measurement::new(&mesh)),
            Measurement::Solid(solid::Surfaces::new(&mesh).plain().collect()),
        ]);
        (format!("{name}, unmarked"), evidence)
    });
    let rings = of_rings.map(|(name, bytes)| {
        let evidence = Evidence::from_iter([Measurement::Ring(
            ring::Measurement::from_bytes(&bytes).expect("rings as they are stored"),
        )]);
        (format!("{name}, unmarked"), evidence)
    });
    meshes.into_iter().chain(rings).collect()
}

fn regular_box() -> Mesh {
    shapes::cuboid(DVec3::new(2.0, 1.6, 1.2), [16; 3])
}

fn identical_boxes() -> Mesh {
    let part = shapes::cuboid(DVec3::new(0.1, 0.08, 0.06), [2; 3]);
    let place = |i: i32| DVec3::new((i % 4).into(), (i / 4 % 4).into(), (i / 16).into());
    Mesh::joined((0..64).map(|i| {
        let by = place(i) * DVec3::new(0.2, 0.16, 0.12);
        part.with_positions(part.positions.iter().map(|p| *p + by).collect())
    }))
}

fn mirrored_pair() -> Mesh {
    let half = shapes::asteroid(20, 30);
    let other = mirror(&half);
    let beside = other.positions.iter().map(|p| *p + DVec3::X * 3.0);
    let other = other.with_positions(beside.collect());
    Mesh::joined([half, other])
}

/// The two columns of cells differ in their first two numbers, whose hashes differ by 229; the third number is added.
fn cells_of_one_address() -> Vec<u8> {
    let pair = |z: i16| {
        let (own, offset) = (u64::from(z.unsigned_abs()), 0.04 * f32::from(z) / 37.0);
        [
            stored(own, [1825, 4489, z + 229], offset),
            stored(own, [-3170, -4529, z], offset),
        ]
        .concat()
    };
    (0..100).flat_map(pair).collect()
}

fn repeated_neighbourhoods() -> Vec<u8> {
    let copies = |i: i16| {
        (0..12).flat_map(move |copy| {
            let offset = 0.001 * f32::from(copy % 7);
            stored(i.unsigned_abs().into(), [i, copy % 3, 0], offset)
        })
    };
    (0..60).flat_map(copies).collect()
}

/// A cell as each turn of the frame sees it.
fn mirrored_cells() -> Vec<u8> {
    let seen = |i: i16| {
        (0..8).flat_map(move |side| {
            let cell = [i % 5, i / 5 % 5, i / 25];
            let cell = [0, 1, 2].map(|axis| match side >> axis & 1 {
                0 => cell[axis],
                _ => !cell[axis],
            });
            stored(i.unsigned_abs().into(), cell, 0.003 * f32::from(i))
        })
    };
    (0..30).flat_map(seen).collect()
}

/// A ring as evidence has it (docs/FORMAT.md).
fn stored(own: u64, cell: [i16; 3], offset: f32) -> Vec<u8> {
    let cell = cell.map(i16::to_le_bytes).concat();
    let own = own.to_le_bytes();
    [&own[..], &own, &cell, &offset.to_le_bytes()].concat()
}
