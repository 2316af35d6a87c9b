//! Normals and distortion against what is known exactly.

use glam::{DMat3, DVec3};
use meshmark::geometry::{Distortion, Pose, diagonal, vertex_normals};
use meshmark::mesh::{Mesh, shapes};
use wasm_bindgen_test::wasm_bindgen_test;

#[wasm_bindgen_test(unsupported = test)]
fn geometry_normals_of_a_sphere_are_radial() {
    let mut sphere = shapes::planet(60, 90);
    sphere.positions.iter_mut().for_each(|p| *p = p.normalize());
    let normals = vertex_normals(&sphere);
    let worst = normals
        .iter()
        .zip(&sphere.positions)
        .map(|(n, p)| n.dot(*p))
        .fold(1.0, f64::min);
    assert!(worst > 0.998, "{worst}");
}

#[wasm_bindgen_test(unsupported = test)]
fn geometry_isolated_vertices_have_no_normal() {
    let mesh = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
        triangles: vec![[0, 1, 2]],
    };
    assert_eq!(
        vertex_normals(&mesh),
        [DVec3::Z, DVec3::Z, DVec3::Z, DVec3::ZERO]
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn geometry_distortion_is_relative_to_the_diagonal() {
    let before = [DVec3::ZERO, DVec3::new(3.0, 4.0, 0.0), DVec3::X, DVec3::Y];
    let mut after = before;
    after[1] += DVec3::Z * 0.5;
    let distortion = Distortion::between(&before, &after);
    assert_eq!(
        distortion,
        Distortion {
            num_moved: 1,
            rms_rel: 0.05,
            max_rel: 0.1
        }
    );
    assert_eq!(diagonal(&before), 5.0);
    assert_eq!(diagonal(&[]), 0.0);
    assert_eq!(
        Distortion::between(&[DVec3::X], &[DVec3::Y]),
        Distortion::default()
    );
}

/// A flat rectangle of 4 by 2: variances 16/12 and 4/12 along its sides, none across.
#[wasm_bindgen_test(unsupported = test)]
fn geometry_pose_of_a_rectangle_is_exact() {
    let turn = DMat3::from_rotation_z(0.4) * DMat3::from_rotation_x(1.1);
    let corner = |x: f64, y: f64| turn * DVec3::new(x, y, 0.0) + DVec3::new(5.0, 6.0, 7.0);
    let positions = vec![
        corner(-2.0, -1.0),
        corner(2.0, -1.0),
        corner(2.0, 1.0),
        corner(-2.0, 1.0),
    ];
    let pose = Pose::of(&Mesh {
        positions,
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    })
    .unwrap();
    assert!(pose.centre.distance(DVec3::new(5.0, 6.0, 7.0)) < 1e-12);
    assert!((pose.size * pose.size - 20.0 / 12.0).abs() < 1e-12);
    assert!(pose.spreads.distance(DVec3::new(0.8, 0.2, 0.0)) < 1e-12);
    assert!((pose.axes.x_axis.dot(turn.x_axis).abs() - 1.0).abs() < 1e-12);
    assert!((pose.axes.determinant() - 1.0).abs() < 1e-12);
    assert!((pose.distinctness() - 0.6).abs() < 1e-12);
    assert!((pose.canonical(corner(2.0, 0.0)).x.abs() - 2.0 / pose.size).abs() < 1e-12);
}

#[wasm_bindgen_test(unsupported = test)]
fn geometry_pose_goes_along_with_the_surface() {
    let knot = shapes::torus_knot(60, 12);
    let moved = meshmark::attack::similarity(&knot, 9);
    let (a, b) = (Pose::of(&knot).unwrap(), Pose::of(&moved).unwrap());
    assert!(a.spreads.distance(b.spreads) < 1e-12);
    let signs: Vec<DVec3> = (0..9)
        .map(|v| a.canonical(knot.positions[v]) / b.canonical(moved.positions[v]))
        .collect();
    assert!(
        signs
            .iter()
            .all(|sign| sign.distance(signs[0].round()) < 1e-6),
        "equal but for the axes' signs: {signs:?}"
    );
    assert_eq!(b.aligned_with(&b), b);
}

#[wasm_bindgen_test(unsupported = test)]
fn geometry_surfaces_of_revolution_have_no_distinct_axes() {
    let mut sphere = shapes::planet(20, 30);
    sphere.positions.iter_mut().for_each(|p| *p = p.normalize());
    assert!(Pose::of(&sphere).unwrap().distinctness() < 0.01);
    assert_eq!(
        Pose::of(&Mesh {
            positions: vec![DVec3::ONE; 3],
            triangles: vec![[0, 1, 2]]
        }),
        None
    );
    assert_eq!(Pose::of(&Mesh::default()), None);
}
