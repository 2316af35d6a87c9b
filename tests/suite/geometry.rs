//! Normals and distortion against what is known exactly.

use crate::portable_test;
use crate::support::fixtures::cuboid;
use glam::{DMat3, DVec3};
use meshmark::internals::geometry::spectral::{self, InverseFilter};
use meshmark::internals::geometry::{
    Distortion, Pose, Quadrature, Sample, diagonal, outward, refined, roughness, vertex_normals,
};
use meshmark::internals::mesh::{Edges, Mesh, shapes};

#[portable_test]
fn geometry_normals_of_a_sphere_are_radial() {
    let mut sphere = shapes::asteroid(60, 90);
    sphere.positions.iter_mut().for_each(|p| *p = p.normalize());
    let normals = vertex_normals(&sphere);
    let worst = normals
        .iter()
        .zip(&sphere.positions)
        .map(|(n, p)| n.dot(*p))
        .fold(1.0, f64::min);
    assert!(worst > 0.998, "{worst}");
}

#[portable_test]
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

#[portable_test]
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
#[portable_test]
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

#[portable_test]
fn geometry_pose_goes_along_with_the_surface() {
    let knot = shapes::torus_knot(60, 12);
    let moved = meshmark::internals::attack::similarity(&knot, 9);
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
    let change = b.aligned_with(&b).axes - b.axes;
    assert!(change.to_cols_array().iter().all(|c| c.abs() < 1e-12));
}

#[portable_test]
fn geometry_surfaces_of_revolution_have_no_distinct_axes() {
    let mut sphere = shapes::asteroid(20, 30);
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

/// A box that is not at the origin.
fn far_box() -> Mesh {
    let mesh = cuboid(DVec3::new(4.0, 2.0, 1.0));
    mesh.with_positions(mesh.positions.iter().map(|p| *p + 7.0).collect())
}

fn volume_pose(mesh: &Mesh) -> Option<Pose> {
    let boundary: Vec<(u32, u32)> = Edges::new(mesh).boundary(&mesh.triangles).collect();
    Pose::of_volume(mesh, &boundary)
}

/// Variances of a solid cuboid are the squared sides over 12.
#[portable_test]
fn geometry_volume_pose_of_a_cuboid_is_exact() {
    let pose = volume_pose(&far_box()).unwrap();
    assert!(pose.centre.distance(DVec3::new(9.0, 8.0, 7.5)) < 1e-12);
    assert!((pose.size * pose.size - 21.0 / 12.0).abs() < 1e-12);
    assert!((pose.spreads * 21.0).distance(DVec3::new(16.0, 4.0, 1.0)) < 1e-9);
}

/// Without its lid a cuboid has the same frame: a cap closes it.
#[portable_test]
fn geometry_volume_pose_closes_holes() {
    let mut open = far_box();
    open.triangles.truncate(10);
    let (open, closed) = (
        volume_pose(&open).unwrap(),
        volume_pose(&far_box()).unwrap(),
    );
    assert!(open.centre.distance(closed.centre) < 1e-9 && (open.size - closed.size).abs() < 1e-9);
    let sheet = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2]],
    };
    assert_eq!(volume_pose(&sheet), None);
}

#[portable_test]
fn geometry_outward_turns_whole_patches() {
    let mut inside_out = far_box();
    inside_out
        .triangles
        .iter_mut()
        .for_each(|triangle| triangle.swap(1, 2));
    inside_out.triangles[3].swap(1, 2);
    let turned = Mesh {
        triangles: outward(&inside_out),
        ..inside_out
    };
    let volume: f64 = turned
        .triangles
        .iter()
        .map(|&t| {
            let [a, b, c] = turned.corners(t);
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    assert!((volume - 8.0).abs() < 1e-9, "{volume}");
}

fn samples(mesh: &Mesh, max_edge: f64) -> Vec<Sample> {
    let quadrature = Quadrature::new(max_edge);
    let triangles = mesh.triangles.iter();
    triangles
        .flat_map(|&triangle| quadrature.samples(mesh.corners(triangle)))
        .collect()
}

#[portable_test]
fn geometry_samples_are_exact_to_the_first_order() {
    let mesh = far_box();
    for max_edge in [100.0, 1.0, 0.3] {
        let samples = samples(&mesh, max_edge);
        let area: f64 = samples.iter().map(|sample| sample.area.length()).sum();
        let moment: DVec3 = samples
            .iter()
            .map(|sample| sample.point * sample.area.length())
            .sum();
        let flux: f64 = samples
            .iter()
            .map(|sample| sample.point.dot(sample.area))
            .sum();
        assert!((area - 28.0).abs() < 1e-9);
        assert!((moment / area).distance(DVec3::new(9.0, 8.0, 7.5)) < 1e-9);
        assert!((flux / 3.0 - 8.0).abs() < 1e-9, "the divergence theorem");
        assert!(
            samples
                .iter()
                .all(|sample| (sample.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12)
        );
    }
    assert_eq!(samples(&mesh, 100.0).len(), 12);
}

#[portable_test]
fn geometry_long_triangles_have_few_samples() {
    let num_samples = |length: f64, width: f64| {
        let corners = [
            DVec3::ZERO,
            DVec3::new(length, -width, 0.0),
            DVec3::new(length, width, 0.0),
        ];
        Quadrature::new(1.0).samples(corners).count()
    };
    assert_eq!(num_samples(10.0, 0.25), 11);
    // Squares that cover it, and some at the apex.
    assert_eq!(num_samples(10.0, 5.0), 70);
}

#[portable_test]
fn geometry_inverse_filter_undoes_smoothing() {
    let knot = shapes::torus_knot(80, 16);
    let smoothed = meshmark::internals::attack::smooth(&knot, 0.1, 10);
    let filter = InverseFilter {
        steps: 10.0,
        step: spectral::laplacian,
        gain: 1e4,
    };
    let rings = Edges::new(&knot).rings(knot.positions.len());
    let moves = vec![true; knot.positions.len()];
    let restored = &spectral::filtered(&smoothed.positions, &rings, &[filter], &moves)[0];
    let away = |positions: &[DVec3]| Distortion::between(&knot.positions, positions).rms_rel;
    assert!(
        away(restored) < 1e-3 * away(&smoothed.positions),
        "{} of {}",
        away(restored),
        away(&smoothed.positions)
    );
}

#[portable_test]
fn geometry_roughness_tells_flat_from_rough() {
    let mut half_rough = shapes::terrain(40);
    half_rough
        .positions
        .iter_mut()
        .filter(|p| p.x < 0.5)
        .for_each(|p| p.z = 0.0);
    let rough = meshmark::internals::attack::noise(&half_rough, 0.02, 3);
    half_rough
        .positions
        .iter_mut()
        .zip(&rough.positions)
        .filter(|(p, _)| p.x >= 0.5)
        .for_each(|(p, q)| *p = *q);
    let roughness = roughness(&half_rough, &Edges::new(&half_rough));
    let mean = |side: fn(f64) -> bool| {
        let values: Vec<f64> = half_rough
            .positions
            .iter()
            .zip(&roughness)
            .filter(|(p, _)| side(p.x))
            .map(|(_, r)| *r)
            .collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    assert!(mean(|x| x < 0.4) < 0.4 * mean(|x| x > 0.6));
    assert!(roughness.iter().all(|r| (0.0..=2.0).contains(r)));
}

/// A crease is no roughness, and what is beyond it does not count.
#[portable_test]
fn geometry_roughness_ends_at_creases() {
    let mut block = shapes::cuboid(DVec3::new(1.0, 1.0, 1.0), [12, 12, 12]);
    let rough = meshmark::internals::attack::noise(&block, 0.01, 3);
    for (p, q) in block.positions.iter_mut().zip(&rough.positions) {
        if p.z > 0.49 && p.x.abs().max(p.y.abs()) < 0.49 {
            *p = *q;
        }
    }
    let roughness = roughness(&block, &Edges::new(&block));
    let of = |side: fn(&DVec3) -> bool| {
        let found = block.positions.iter().zip(&roughness);
        let values = found.filter(move |(p, _)| side(p)).map(|(_, r)| *r);
        values.fold((f64::INFINITY, 0.0), |(low, high), r| {
            (r.min(low), r.max(high))
        })
    };
    assert!(of(|p| p.z < 0.49).1 < 1e-6, "flat sides and their edges");
    assert!(of(|p| p.z > 0.49 && p.x.abs().max(p.y.abs()) < 0.4).0 > 0.01);
}

/// A coarse sphere's chords are too short; arcs half as high as the normals say bring back about half of what is missing.
#[portable_test]
fn geometry_refined_mesh_is_nearer_to_the_sphere() {
    let coarse = shapes::asteroid(12, 24);
    let refined = refined(&coarse);
    let volume = |mesh: &Mesh| -> f64 {
        let parts = mesh.triangles.iter().map(|&triangle| {
            let [a, b, c] = mesh.corners(triangle);
            a.dot(b.cross(c)) / 6.0
        });
        parts.sum()
    };
    let fine = volume(&shapes::asteroid(120, 240));
    let (before, after) = (fine - volume(&coarse), fine - volume(&refined));
    assert_eq!(refined.triangles.len(), 4 * coarse.triangles.len());
    assert!(
        0.2 * before < after && after < 0.8 * before,
        "{before} {after}"
    );
}
