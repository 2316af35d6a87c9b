//! Edges, rings and winding of good and bad meshes.

use crate::portable_test;
use glam::DVec3;
use meshmark::internals::mesh::{Admissible, Edges, Mesh, Orbit, shapes};

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn mesh(num_vertices: u32, triangles: &[[u32; 3]]) -> Mesh {
    let position = |i: u32| DVec3::new(f64::from(i * i % 7), f64::from(i * 3 % 5), f64::from(i));
    Mesh {
        positions: (0..num_vertices).map(position).collect(),
        triangles: triangles.to_vec(),
    }
}

#[portable_test]
fn mesh_closed_surface_has_no_boundary() {
    let tetrahedron = mesh(4, &TETRAHEDRON);
    let edges = Edges::new(&tetrahedron);
    assert_eq!(
        (
            edges.num_boundary(),
            edges.num_non_manifold(),
            edges.num_components()
        ),
        (0, 0, 1)
    );
    let rings = edges.rings(4);
    assert!((0..4).all(|v| rings.is_closed(v) && rings.valence(v) == 3));
    assert_eq!(rings.neighbours(2), [0, 1, 3]);
}

#[portable_test]
fn mesh_hole_opens_its_rings() {
    let open = mesh(4, &TETRAHEDRON[..3]);
    let edges = Edges::new(&open);
    assert_eq!((edges.num_boundary(), edges.num_non_manifold()), (3, 0));
    let rings = edges.rings(4);
    assert_eq!(
        (0..4).map(|v| rings.is_closed(v)).collect::<Vec<_>>(),
        [false, true, false, false]
    );
}

#[portable_test]
fn mesh_third_face_at_an_edge_is_non_manifold() {
    let fin = mesh(5, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 1, 4]]);
    let edges = Edges::new(&fin);
    assert_eq!(
        (
            edges.num_boundary(),
            edges.num_non_manifold(),
            edges.num_components()
        ),
        (2, 1, 1)
    );
    let rings = edges.rings(5);
    assert!(!rings.is_closed(0) && !rings.is_closed(1) && rings.is_closed(2) && rings.is_closed(3));
}

#[portable_test]
fn mesh_components_and_isolated_vertices() {
    let two = mesh(9, &[[0, 1, 2], [2, 1, 3], [4, 5, 6], [5, 7, 6]]);
    let edges = Edges::new(&two);
    assert_eq!(edges.num_components(), 2);
    assert_eq!(edges.rings(9).valence(8), 0);
    assert!(!edges.rings(9).is_closed(8));
}

#[portable_test]
fn mesh_winding_follows_the_majority_of_each_patch() {
    let mut knot = shapes::torus_knot(30, 10);
    let turned: Vec<bool> = (0..knot.triangles.len())
        .map(|face| face % 10 < 3)
        .collect();
    for (triangle, _) in knot
        .triangles
        .iter_mut()
        .zip(&turned)
        .filter(|(_, turned)| **turned)
    {
        triangle.swap(1, 2);
    }
    assert_eq!(Edges::new(&knot).winding().flips, turned);
}

#[portable_test]
fn mesh_one_sided_surface_is_accepted() {
    let strip: Vec<[u32; 3]> = (0..7).map(|i| [i, (i + 1) % 7, (i + 2) % 7]).collect();
    let edges = Edges::new(&mesh(7, &strip));
    assert_eq!(edges.winding().flips.len(), 7);
    assert_eq!(edges.num_components(), 1);
}

#[portable_test]
fn mesh_without_anything_has_nothing() {
    let edges = Edges::new(&Mesh::default());
    assert_eq!(
        (
            edges.num_boundary(),
            edges.num_components(),
            edges.rings(0).len()
        ),
        (0, 0, 0)
    );
}

#[portable_test]
fn mesh_shapes_are_what_they_say() {
    let knot = shapes::torus_knot(40, 12);
    assert_eq!((knot.positions.len(), knot.triangles.len()), (480, 960));
    let asteroid = shapes::asteroid(10, 16);
    assert_eq!(
        (asteroid.positions.len(), asteroid.triangles.len()),
        (162, 320)
    );
    for closed in [&knot, &asteroid] {
        let edges = Edges::new(closed);
        assert_eq!(
            (
                edges.num_boundary(),
                edges.num_non_manifold(),
                edges.num_components()
            ),
            (0, 0, 1)
        );
        assert!(!edges.winding().flips.contains(&true));
        let volume: f64 = closed
            .triangles
            .iter()
            .map(|&t| {
                let [a, b, c] = closed.corners(t);
                a.dot(b.cross(c))
            })
            .sum();
        assert!(volume > 0.0, "triangles face outwards");
    }
    assert_eq!(Edges::new(&shapes::terrain(8)).num_boundary(), 32);
}

/// V, components, boundary edges, Euler's characteristic.
fn kind(mesh: &Mesh) -> (usize, usize, usize, i64) {
    let edges = Edges::new(mesh);
    assert_eq!(edges.num_non_manifold(), 0);
    assert!(!edges.winding().flips.contains(&true), "wound alike");
    let sides = 3 * mesh.triangles.len() + edges.num_boundary();
    let euler = mesh.positions.len() as i64 - sides as i64 / 2 + mesh.triangles.len() as i64;
    (
        mesh.positions.len(),
        edges.num_components(),
        edges.num_boundary(),
        euler,
    )
}

#[portable_test]
fn mesh_shapes_without_axes_are_what_they_say() {
    assert_eq!(kind(&shapes::torus(30, 12)), (360, 1, 0, 0));
    assert_eq!(kind(&shapes::vase(40, 20)), (801, 1, 20, 1));
    assert_eq!(kind(&shapes::relief_sphere(20, 30)), (602, 1, 0, 2));
    assert_eq!(kind(&shapes::capsule(20, 30)), (602, 1, 0, 2));
    assert_eq!(kind(&shapes::leaf(20, 30)), (602, 1, 0, 2));
    assert_eq!(kind(&shapes::icosphere(3)), (642, 1, 0, 2));
    let radii = shapes::icosphere(3)
        .positions
        .into_iter()
        .map(DVec3::length);
    assert!(radii.into_iter().all(|radius| (radius - 1.0).abs() < 1e-12));
    let capsule = shapes::capsule(20, 30).positions;
    let distance = |p: &DVec3| (*p - DVec3::Z * p.z.clamp(-0.5, 0.5)).length();
    assert!(capsule.iter().all(|p| (distance(p) - 0.5).abs() < 1e-12));
}

#[portable_test]
fn mesh_machined_part_is_what_it_says() {
    // Genus 6: 2 - 2 * 6.
    assert_eq!(kind(&shapes::cad_part()), (5526, 1, 0, -10));
}

#[portable_test]
fn mesh_game_shapes_are_what_they_say() {
    assert_eq!(kind(&shapes::low_poly()), (602, 1, 0, 2));
    // Six spheres by topology and a torus.
    assert_eq!(kind(&shapes::seven_shapes()), (1776, 7, 0, 12));
    let (vertices, components, boundary, _) = kind(&shapes::game_asset());
    assert_eq!((vertices, components), (9901, 56));
    assert!(boundary > 1000, "most of it is open: {boundary}");
}

#[portable_test]
fn mesh_admissible_displacements_are_a_projection() {
    let turn = glam::DMat3::from_rotation_z(1.0) * 2.0;
    let admissible = Admissible {
        orbits: vec![Orbit {
            members: vec![(0, glam::DMat3::IDENTITY), (2, turn)],
        }],
        fixed: vec![1],
    };
    let mut displacement = vec![
        DVec3::new(1.0, 2.0, 3.0),
        DVec3::ONE,
        DVec3::new(-1.0, 0.5, 2.0),
        DVec3::X,
    ];
    admissible.project(&mut displacement);
    assert!(displacement[2].distance(turn * displacement[0]) < 1e-12);
    assert_eq!((displacement[1], displacement[3]), (DVec3::ZERO, DVec3::X));
    let once = displacement.clone();
    admissible.project(&mut displacement);
    assert!(
        once.iter()
            .zip(&displacement)
            .all(|(a, b)| a.distance(*b) < 1e-12)
    );
}
