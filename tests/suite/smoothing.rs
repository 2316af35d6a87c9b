//! The smoothing methods of the seed paper, by its equations and counts.

use crate::portable_test;
use crate::support::fixtures::asteroid;
use glam::DVec3;
use meshmark::internals::attack::{
    bilaplacian, catmull_clark, mean_curvature_flow, mean_filter, noise, optimize, simplify_to,
    smooth, taubin,
};
use meshmark::internals::geometry::{Quadrature, dihedrals, face_areas};
use meshmark::internals::mesh::{Edges, Mesh, shapes};

/// A spindle of valence 6 whose rim is neither flat nor regular: its tip alone may move.
fn tent() -> Mesh {
    let heights = [0.05, -0.1, 0.07, 0.0, -0.05, 0.1];
    let rim = heights.iter().zip(0..).map(|(&height, i)| {
        let (sin, cos) = libm::sincos(f64::from(i) * 1.02 + 0.1 * f64::from(i % 2));
        DVec3::new((1.0 + 0.1 * f64::from(i % 3)) * cos, sin, height)
    });
    Mesh {
        positions: [DVec3::new(0.1, -0.2, 0.9)]
            .into_iter()
            .chain(rim)
            .collect(),
        triangles: (0..6).map(|i| [0, 1 + i, 1 + (i + 1) % 6]).collect(),
    }
}

/// Equation 3 about the tent's tip, with areas as they were; equation 2's average is over all triangles, which have it in common.
fn fit_error(tent: &Mesh, tip: DVec3) -> f64 {
    let before = face_areas(tent);
    let average = before.iter().sum::<DVec3>().normalize();
    let mut moved = tent.clone();
    moved.positions[0] = tip;
    let pairs = face_areas(&moved).into_iter().zip(before);
    let terms = pairs.map(|(area, before)| {
        let difference = area / before.length() - average;
        before.length() * difference.length_squared()
    });
    terms.sum()
}

#[portable_test]
fn smoothing_mean_filter_solves_equation_4() {
    let tent = tent();
    let filtered = mean_filter(&tent, 1);
    assert_eq!(filtered.positions[1..], tent.positions[1..], "borders stay");
    let tip = filtered.positions[0];
    let least = fit_error(&tent, tip);
    assert!(least < 0.5 * fit_error(&tent, tent.positions[0]));
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        for step in [-0.1, -0.001, 0.001, 0.1] {
            let elsewhere = fit_error(&tent, tip + axis * step);
            assert!(elsewhere > least, "{axis} {step}: {elsewhere} {least}");
        }
    }
}

#[portable_test]
fn smoothing_mean_filter_keeps_what_is_flat() {
    let mut plane = shapes::terrain(12);
    plane
        .positions
        .iter_mut()
        .for_each(|p| p.z = 0.3 * p.x - 0.2 * p.y);
    let filtered = mean_filter(&plane, 3);
    let moved = plane.positions.iter().zip(&filtered.positions);
    assert!(moved.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max) < 1e-12);
}

/// RMS of the angles across edges, radians.
fn unevenness(mesh: &Mesh) -> f64 {
    let angles = dihedrals(mesh, &Edges::new(mesh), &face_areas(mesh));
    let squares: f64 = angles
        .iter()
        .map(|dihedral| dihedral.angle * dihedral.angle)
        .sum();
    (squares / angles.len() as f64).sqrt()
}

fn volume(mesh: &Mesh) -> f64 {
    let parts = mesh.triangles.iter().map(|&triangle| {
        let [a, b, c] = mesh.corners(triangle);
        a.dot(b.cross(c)) / 6.0
    });
    parts.sum()
}

#[portable_test]
fn smoothing_methods_smooth() {
    let clean = asteroid();
    let noisy = noise(&clean, 0.004, 2);
    let (before, aim) = (unevenness(&noisy), unevenness(&clean));
    let methods: [(&str, Mesh); 5] = [
        ("laplacian", smooth(&noisy, 0.5, 5)),
        ("bilaplacian", bilaplacian(&noisy, 0.5, 5)),
        ("mean curvature flow", mean_curvature_flow(&noisy, 1.0, 1)),
        ("taubin", taubin(&noisy, 0.5, -0.53, 5)),
        ("mean filter", mean_filter(&noisy, 5)),
    ];
    for (name, smoothed) in &methods {
        let after = unevenness(smoothed);
        assert!(
            after < aim + 0.3 * (before - aim),
            "{name}: {after} of {before}"
        );
        assert!(
            (volume(smoothed) / volume(&clean) - 1.0).abs() < 0.05,
            "{name}"
        );
        assert_eq!(smoothed.triangles, clean.triangles, "{name}");
    }
    let lost = |smoothed: &Mesh| (1.0 - volume(smoothed) / volume(&noisy)).abs();
    assert!(
        lost(&methods[1].1) < 0.5 * lost(&methods[0].1),
        "the bilaplacian shrinks less"
    );
}

#[portable_test]
fn smoothing_holds_borders_and_accepts_anything() {
    let terrain = shapes::terrain(16);
    let methods: [fn(&Mesh) -> Mesh; 3] = [
        |mesh| bilaplacian(mesh, 0.5, 3),
        |mesh| mean_curvature_flow(mesh, 1.0, 3),
        |mesh| mean_filter(mesh, 3),
    ];
    let needle = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::X, DVec3::ONE],
        triangles: vec![[0, 1, 2], [0, 2, 1]],
    };
    for method in methods {
        let smoothed = method(&terrain);
        for (vertex, _) in Edges::new(&terrain).boundary(&terrain.triangles) {
            let vertex = vertex as usize;
            assert_eq!(smoothed.positions[vertex], terrain.positions[vertex]);
        }
        assert_ne!(smoothed, terrain);
        assert_eq!(method(&Mesh::default()), Mesh::default());
        assert!(method(&needle).positions.iter().all(|p| p.is_finite()));
    }
}

/// The coordinates of a unit sphere are eigenfunctions of its Laplacian, with the eigenvalue 2.
#[portable_test]
fn smoothing_mean_curvature_flow_shrinks_a_sphere_as_it_must() {
    let sphere = shapes::icosphere(4);
    let edge = sphere.mean_edge();
    for time in [1.0, 30.0] {
        let smoothed = mean_curvature_flow(&sphere, time, 1);
        let radius = 1.0 / (1.0 + 2.0 * time * edge * edge);
        for position in &smoothed.positions {
            assert!(
                (position.length() / radius - 1.0).abs() < 0.005,
                "{time} {position}"
            );
        }
    }
}

/// An octahedron, by hand: face points at thirds, edge points at (1 + 1 + 2/3) / 4, vertices at (F + 2 R + (n - 3) P) / n.
#[portable_test]
fn smoothing_mesh_smooth_is_catmull_and_clark() {
    let octahedron = Mesh {
        positions: [DVec3::X, DVec3::Y, DVec3::Z]
            .iter()
            .flat_map(|&axis| [axis, -axis])
            .collect(),
        triangles: vec![
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 4],
            [3, 0, 4],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ],
    };
    let smoothed = catmull_clark(&octahedron, 1);
    let near = |p: DVec3, q: DVec3| p.abs().distance(q) < 1e-15;
    for (v, position) in octahedron.positions.iter().enumerate() {
        assert!(
            smoothed.positions[v].distance(*position * (7.0 / 12.0)) < 1e-15,
            "named as before"
        );
    }
    for (edge, position) in smoothed.positions[6..18].iter().enumerate() {
        let sum = position.abs().element_sum();
        assert!(
            (sum - 5.0 / 6.0).abs() < 1e-15 && position.min_element().abs() < 0.5,
            "{edge}"
        );
    }
    assert!(
        smoothed.positions[18..]
            .iter()
            .all(|&p| near(p, DVec3::splat(1.0 / 3.0)))
    );
    // The second round is of quads, not of their halves: 26 vertices, 48 edges and 24 quads.
    assert_eq!(catmull_clark(&octahedron, 2).positions.len(), 26 + 48 + 24);
}

/// Two closed surfaces of 66922 faces, brought to the paper's 11732 and smoothed twice: 5870, 35200 and 140788 vertices.
#[portable_test]
fn smoothing_has_the_counts_of_the_paper() {
    let mut whole = shapes::asteroid(150, 150);
    let moon = shapes::asteroid(97, 113);
    let first = whole.positions.len() as u32;
    whole
        .positions
        .extend(moon.positions.iter().map(|p| *p * 0.4 + DVec3::X * 3.0));
    whole
        .triangles
        .extend(moon.triangles.iter().map(|t| t.map(|v| v + first)));
    assert_eq!(whole.triangles.len(), 66922);
    let simple = simplify_to(&whole, 11732);
    assert_eq!(Edges::new(&simple).num_components(), 2);
    assert_eq!(
        (simple.positions.len(), simple.triangles.len()),
        (5870, 11732)
    );
    assert_eq!(catmull_clark(&simple, 1).positions.len(), 35200);
    assert_eq!(catmull_clark(&simple, 2).positions.len(), 140788);
}

/// The integral of the squared distance from the unit sphere.
fn sphere_error(mesh: &Mesh) -> f64 {
    let quadrature = Quadrature::new(0.02);
    let triangles = mesh.triangles.iter();
    let samples = triangles.flat_map(|&triangle| quadrature.samples(mesh.corners(triangle)));
    let terms = samples.map(|sample| {
        let distance = sample.point.length() - 1.0;
        distance * distance * sample.area.length()
    });
    terms.sum()
}

/// An icosphere is close to the best that so many triangles can do with their corners on the sphere; simplification, which may
/// lift them off it, comes to a third of its error.
#[portable_test]
fn smoothing_simplification_places_its_faces_well() {
    let simple = simplify_to(&shapes::icosphere(5), 1280);
    assert_eq!(simple.triangles.len(), 1280);
    let (error, inscribed) = (sphere_error(&simple), sphere_error(&shapes::icosphere(3)));
    assert!(error < 0.4 * inscribed, "{error} {inscribed}");
}

#[portable_test]
fn smoothing_optimization_merges_what_is_flat_first() {
    let mut plane = shapes::terrain(20);
    plane.positions.iter_mut().for_each(|p| p.z = 0.0);
    let merged = optimize(&plane, 0);
    let border = Edges::new(&plane).num_boundary();
    assert_eq!(Edges::new(&merged).num_boundary(), border, "borders stay");
    assert!(
        merged.positions.len() < border + 8,
        "hardly a vertex is left inside"
    );
    assert!((merged.area() - 1.0).abs() < 1e-12);
    let mesh = asteroid();
    let optimized = optimize(&mesh, 3000);
    assert_eq!(optimized.triangles.len(), 3000);
    assert_eq!(Edges::new(&optimized).num_boundary(), 0);
    assert!(!Edges::new(&optimized).winding().flips.contains(&true));
    let is_kept = |p: &DVec3| mesh.positions.contains(p);
    assert!(
        optimized.positions.iter().all(is_kept),
        "vertices go, and none moves"
    );
    assert_eq!(optimize(&Mesh::default(), 0), Mesh::default());
}
