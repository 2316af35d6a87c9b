//! Normals and distortion against what is known exactly.

use glam::DVec3;
use meshmark::geometry::{Distortion, diagonal, vertex_normals};
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
