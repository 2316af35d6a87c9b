//! What shapes are made of.

use crate::mesh::Mesh;
use crate::random::Random;
use glam::{DAffine3, DVec3};
use std::f64::consts::TAU;

/// A grid of `rows` times `columns` quads over the unit square, V = `(rows + 1) (columns + 1)`. Faces the way of the cross
/// product of the derivatives by the first and the second coordinate.
pub(super) fn sheet(rows: u32, columns: u32, position: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let places = (0..=rows).flat_map(|i| (0..=columns).map(move |j| (i, j)));
    let positions = places.map(|(i, j)| {
        position(
            f64::from(i) / f64::from(rows),
            f64::from(j) / f64::from(columns),
        )
    });
    Mesh {
        positions: positions.collect(),
        triangles: irregular_quads(rows, columns, |i, j| i * (columns + 1) + j),
    }
}

/// A surface over the unit sphere, V = `rings * sectors + 2`: a vertex in each direction of a grid of polar and azimuthal
/// angles, and at the poles.
pub(super) fn globe(rings: u32, sectors: u32, position: impl Fn(DVec3) -> DVec3) -> Mesh {
    let direction = |i: u32, j: u32| {
        let polar = TAU / 2.0 * f64::from(i + 1) / f64::from(rings + 1);
        let azimuth = TAU * f64::from(j) / f64::from(sectors);
        let (sin, cos) = (libm::sin(polar), libm::cos(polar));
        DVec3::new(sin * libm::cos(azimuth), sin * libm::sin(azimuth), cos)
    };
    let mut directions: Vec<DVec3> = (0..rings)
        .flat_map(|i| (0..sectors).map(move |j| direction(i, j)))
        .collect();
    directions.extend([DVec3::Z, DVec3::NEG_Z]);
    let (north, south) = (rings * sectors, rings * sectors + 1);
    let mut triangles = irregular_quads(rings - 1, sectors, |i, j| i * sectors + j % sectors);
    for j in 0..sectors {
        let next = (j + 1) % sectors;
        let last = (rings - 1) * sectors;
        triangles.extend([[north, j, next], [south, last + next, last + j]]);
    }
    Mesh {
        positions: directions.into_iter().map(position).collect(),
        triangles,
    }
}

/// A grid of `rows` times `columns` quads whose last column joins the first, V = `(rows + 1) columns`. Faces as a sheet does.
pub(super) fn band(rows: u32, columns: u32, position: impl Fn(u32, u32) -> DVec3) -> Mesh {
    let places = (0..=rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    Mesh {
        positions: places.map(|(i, j)| position(i, j)).collect(),
        triangles: irregular_quads(rows, columns, |i, j| i * columns + j % columns),
    }
}

/// The surface that a profile of radii and heights sweeps about the z axis; faces outwards where the profile goes down. An end
/// of radius 0 is a pole, any other end a border.
pub(super) fn lathe(profile: &[(f64, f64)], sectors: u32) -> Mesh {
    band(profile.len() as u32 - 1, sectors, |i, j| {
        let (radius, height) = profile[i as usize];
        let azimuth = TAU * f64::from(j) / f64::from(sectors);
        DVec3::new(
            radius * libm::cos(azimuth),
            radius * libm::sin(azimuth),
            height,
        )
    })
    .welded()
}

/// A profile with each of its pieces divided into `steps`.
pub(super) fn divided(corners: &[(f64, f64)], steps: u32) -> Vec<(f64, f64)> {
    let mut profile = vec![corners[0]];
    for pair in corners.windows(2) {
        let ((r0, z0), (r1, z1)) = (pair[0], pair[1]);
        profile.extend((1..steps).map(|step| {
            let t = f64::from(step) / f64::from(steps);
            (r0 + t * (r1 - r0), z0 + t * (z1 - z0))
        }));
        profile.push(pair[1]);
    }
    profile
}

/// The surface of a box about the origin, of a size along x, y and z, V = `2 (ab + bc + ca) + 2` for `cells` of a, b and c.
pub fn cuboid(size: DVec3, cells: [u32; 3]) -> Mesh {
    let faces = (0..6).map(|face| cuboid_face(size, cells, face));
    Mesh::joined(faces).welded()
}

/// A face of a box: 0 to 2 look to -x, -y, -z, 3 to 5 to +x, +y, +z.
pub(super) fn cuboid_face(size: DVec3, cells: [u32; 3], face: usize) -> Mesh {
    let (axis, is_high) = (face % 3, face >= 3);
    let (mut first, mut second) = ((axis + 1) % 3, (axis + 2) % 3);
    if !is_high {
        std::mem::swap(&mut first, &mut second);
    }
    sheet(cells[first], cells[second], |u, v| {
        let mut unit = DVec3::ZERO;
        unit[axis] = if is_high { 1.0 } else { 0.0 };
        unit[first] = u;
        unit[second] = v;
        (unit - 0.5) * size
    })
}

/// The mesh elsewhere.
pub(super) fn placed(mesh: &Mesh, place: DAffine3) -> Mesh {
    let positions = mesh.positions.iter();
    mesh.with_positions(positions.map(|&p| place.transform_point3(p)).collect())
}

/// The same surface seen from the other side.
pub(super) fn reversed(mesh: &Mesh) -> Mesh {
    Mesh {
        positions: mesh.positions.clone(),
        triangles: mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    }
}

/// The mirror image in the plane y = 0.
pub(super) fn mirrored(mesh: &Mesh) -> Mesh {
    let flip = DAffine3::from_scale(DVec3::new(1.0, -1.0, 1.0));
    reversed(&placed(mesh, flip))
}

/// The quads of a grid, each split along one of its diagonals at random; `vertex` names the corner of a row and a column.
pub(super) fn irregular_quads(
    rows: u32,
    columns: u32,
    vertex: impl Fn(u32, u32) -> u32,
) -> Vec<[u32; 3]> {
    let mut random = Random::new(1);
    let quads = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    quads
        .flat_map(|(i, j)| {
            split(
                [
                    vertex(i, j),
                    vertex(i + 1, j),
                    vertex(i + 1, j + 1),
                    vertex(i, j + 1),
                ],
                &mut random,
            )
        })
        .collect()
}

/// A quad as two triangles, along one of its diagonals.
fn split([a, b, c, d]: [u32; 4], random: &mut Random) -> [[u32; 3]; 2] {
    if random.bits() >> 63 == 0 {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    }
}
