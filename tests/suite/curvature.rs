//! Curvature against what is known exactly.

use crate::portable_test;
use crate::support::fixtures::cuboid;
use glam::DVec3;
use meshmark::internals::geometry::{
    Curvature, collapse_costs, curvature_integrals, dihedrals, face_areas, fitted_curvature,
    normal_deviations, vertex_normals,
};
use meshmark::internals::mesh::{Edges, Mesh, shapes};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// By differential geometry and by quadrics.
fn both(mesh: &Mesh) -> [Curvature; 2] {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let normals = vertex_normals(mesh);
    [
        curvature_integrals(mesh, &rings, &normals).curvature(),
        fitted_curvature(mesh, &rings, &normals),
    ]
}

fn inside(mesh: &Mesh) -> Vec<usize> {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let all = 0..mesh.positions.len();
    // Two rings away from borders: a fit beyond them would look to one side only.
    let closed = |v: usize| rings.is_closed(v);
    all.filter(|&v| closed(v) && rings.neighbours(v).iter().all(|&n| closed(n as usize)))
        .collect()
}

/// RMS errors of Gaussian and mean curvature, of the vertices that have both rings.
fn errors(mesh: &Mesh, curvature: &Curvature, truth: impl Fn(DVec3) -> [f64; 2]) -> [f64; 2] {
    let inside = inside(mesh);
    let mut squares = [0.0; 2];
    for &v in &inside {
        let [gaussian, mean] = truth(mesh.positions[v]);
        squares[0] += square(curvature.gaussian[v] - gaussian);
        squares[1] += square(curvature.mean[v] - mean);
    }
    squares.map(|square| (square / inside.len() as f64).sqrt())
}

fn square(x: f64) -> f64 {
    x * x
}

/// A unit square with hills, bent.
fn bent(cells: u32, at: impl Fn(DVec3) -> DVec3) -> Mesh {
    let mut mesh = shapes::terrain(cells);
    mesh.positions.iter_mut().for_each(|p| *p = at(*p));
    mesh
}

/// z = (x^2 - y^2) / 2 over the unit square.
fn saddle(cells: u32) -> Mesh {
    bent(cells, |p| {
        DVec3::new(p.x, p.y, (p.x * p.x - p.y * p.y) / 2.0)
    })
}

fn saddle_curvature(p: DVec3) -> [f64; 2] {
    let slope = 1.0 + p.x * p.x + p.y * p.y;
    let mean = (p.x * p.x - p.y * p.y) / 2.0 / (slope * slope.sqrt());
    [-1.0 / (slope * slope), mean]
}

/// A half of a cylinder of radius 2, seen from outside.
fn cylinder(cells: u32) -> Mesh {
    bent(cells, |p| {
        let (sin, cos) = libm::sincos(p.x);
        DVec3::new(2.0 * sin, p.y, 2.0 * cos)
    })
}

fn torus_curvature(p: DVec3) -> [f64; 2] {
    // Its radii are 1 and 0.4: principal curvatures 1 / 0.4 and cos / rho.
    let rho = p.truncate().length();
    let (across, along) = (1.0 / 0.4, (rho - 1.0) / 0.4 / rho);
    [across * along, (across + along) / 2.0]
}

/// Errors at three resolutions, each twice as fine as the one before, and the least order at which they fall.
fn order(errors: [f64; 3]) -> f64 {
    libm::log2(errors[0] / errors[1]).min(libm::log2(errors[1] / errors[2]))
}

type Truth = fn(DVec3) -> [f64; 2];

/// By quadrics both curvatures converge on every surface, however its quads are split: with the square of the edges where a
/// mesh is alike all over, with the edges where it is not.
#[portable_test]
fn curvature_of_quadrics_converges() {
    let cases: [(&str, [Mesh; 3], Truth, f64); 4] = [
        (
            "sphere",
            [3, 4, 5].map(shapes::icosphere),
            |_| [1.0, 1.0],
            1.95,
        ),
        ("cylinder", [16, 32, 64].map(cylinder), |_| [0.0, 0.25], 1.9),
        ("saddle", [16, 32, 64].map(saddle), saddle_curvature, 0.85),
        (
            "torus",
            [1, 2, 4].map(|n| shapes::torus(60 * n, 24 * n)),
            torus_curvature,
            1.15,
        ),
    ];
    for (name, meshes, truth, least) in cases {
        let errors = meshes.map(|mesh| errors(&mesh, &both(&mesh)[1], truth));
        for which in [0, 1] {
            let order = order(errors.map(|errors| errors[which]));
            assert!(order > least, "{name}: {order} of {errors:?}");
            assert!(errors[2][which] < 0.04, "{name}: {errors:?}");
        }
    }
}

/// By differential geometry curvature converges where rings are regular; elsewhere it stays as near as this, at every resolution
/// (Xu 2006 shows that no such formula converges everywhere).
#[portable_test]
fn curvature_of_differential_geometry_is_near_the_truth() {
    let errors_of = |mesh: Mesh, truth: Truth| errors(&mesh, &both(&mesh)[0], truth);
    let spheres = [3, 4, 5].map(|rounds| errors_of(shapes::icosphere(rounds), |_| [1.0, 1.0]));
    assert!(order(spheres.map(|errors| errors[0])) > 1.95, "{spheres:?}");
    assert!(
        spheres[2][0] < 3.1e-4 && spheres[2][1] < 6e-7,
        "{spheres:?}"
    );
    for cells in [16, 64] {
        let [gaussian, mean] = errors_of(cylinder(cells), |_| [0.0, 0.25]);
        assert!(gaussian < 1e-12 && mean < 6e-6, "{gaussian} {mean}");
        let [gaussian, mean] = errors_of(saddle(cells), saddle_curvature);
        assert!(gaussian < 0.015 && mean < 0.003, "{gaussian} {mean}");
    }
    let [gaussian, mean] = errors_of(shapes::torus(120, 48), torus_curvature);
    assert!(gaussian < 0.01 && mean < 0.007, "{gaussian} {mean}");
}

#[portable_test]
fn curvature_integrals_obey_gauss_and_bonnet() {
    for (name, mesh, characteristic) in [
        ("sphere", shapes::asteroid(30, 40), 2.0),
        ("knot", shapes::torus_knot(60, 20), 0.0),
        ("disc", shapes::terrain(20), 1.0),
        ("vase", shapes::vase(30, 40), 1.0),
    ] {
        let rings = Edges::new(&mesh).rings(mesh.positions.len());
        let integrals = curvature_integrals(&mesh, &rings, &vertex_normals(&mesh));
        let total: f64 = integrals.gaussian.iter().sum();
        assert!(
            (total - TAU * characteristic).abs() < 1e-9,
            "{name}: {total}"
        );
        let area: f64 = integrals.area.iter().sum();
        assert!(
            (area / mesh.area() - 1.0).abs() < 1e-12,
            "{name}: mixed areas share the surface"
        );
        assert!(integrals.area.iter().all(|&area| area > 0.0), "{name}");
    }
}

#[portable_test]
fn curvature_has_principal_directions_of_its_surface() {
    let sphere = shapes::icosphere(4);
    let saddle = saddle(40);
    let centre = inside(&saddle)
        .into_iter()
        .min_by(|&a, &b| {
            saddle.positions[a]
                .length()
                .total_cmp(&saddle.positions[b].length())
        })
        .unwrap();
    let [_, fitted] = both(&saddle);
    let [high, low] = fitted.principal(centre);
    let [gaussian, mean] = saddle_curvature(saddle.positions[centre]);
    assert!((high * low - gaussian).abs() < 0.02 && ((high + low) / 2.0 - mean).abs() < 0.02);
    for curvature in both(&sphere) {
        let [high, low] = curvature.principal(17);
        assert!((high - 1.0).abs() < 0.1 && (low - 1.0).abs() < 0.1 && high >= low);
    }
}

/// Fewer points than unknowns, or all of them on one line: still finite, and flat where they are.
#[portable_test]
fn curvature_of_poor_neighbourhoods_is_finite() {
    let triangle = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
        triangles: vec![[0, 1, 2]],
    };
    let needle = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::new(2.0, 1e-12, 0.0)],
        triangles: vec![[0, 1, 2]],
    };
    let point = Mesh {
        positions: vec![DVec3::ONE; 3],
        triangles: vec![[0, 1, 2]],
    };
    let tetrahedron = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    };
    for mesh in [&triangle, &needle, &point, &tetrahedron, &Mesh::default()] {
        for curvature in both(mesh) {
            let values = curvature.gaussian.iter().chain(&curvature.mean);
            assert!(values.clone().all(|value| value.is_finite()));
            assert_eq!(values.count(), 2 * mesh.positions.len());
        }
    }
    assert_eq!(both(&triangle)[1].gaussian, [0.0; 4]);
    assert!(both(&tetrahedron)[1].mean.iter().all(|&mean| mean > 0.0));
}

#[portable_test]
fn curvature_follows_scale() {
    let mesh = shapes::asteroid(20, 30);
    let large = mesh.with_positions(mesh.positions.iter().map(|p| *p * 1e3 + 1e5).collect());
    for (small, large) in both(&mesh).iter().zip(both(&large)) {
        for v in 0..mesh.positions.len() {
            let (gaussian, mean) = (small.gaussian[v], small.mean[v]);
            assert!((large.gaussian[v] * 1e6 - gaussian).abs() < 1e-4 * (1.0 + gaussian.abs()));
            assert!((large.mean[v] * 1e3 - mean).abs() < 1e-4 * (1.0 + mean.abs()));
        }
    }
}

/// A box: right angles at its edges, nothing across its diagonals; outside in, furrows.
#[portable_test]
fn curvature_dihedral_angles_of_a_box() {
    let mut mesh = cuboid(DVec3::ONE);
    for sign in [1.0, -1.0] {
        let angles = dihedrals(&mesh, &Edges::new(&mesh), &face_areas(&mesh));
        assert_eq!(angles.len(), 18);
        let right = angles
            .iter()
            .filter(|d| (d.angle - sign * FRAC_PI_2).abs() < 1e-12)
            .count();
        let flat = angles.iter().filter(|d| d.angle.abs() < 1e-12).count();
        assert_eq!((right, flat), (12, 6));
        mesh.triangles
            .iter_mut()
            .for_each(|triangle| triangle.swap(1, 2));
    }
    // The angle between a corner's normal and its faces': the diagonal of a cube for corners where all three count alike.
    let deviations = normal_deviations(&mesh, &face_areas(&mesh), &vertex_normals(&mesh));
    let least = libm::acos(1.0 / 3.0f64.sqrt());
    assert!(
        deviations
            .iter()
            .all(|&angle| angle > least - 1e-9 && angle < PI / 2.0)
    );
}

/// A pyramid's tip, by hand: four faces of slope 45 degrees, moved to a corner of the base each costs the square of its distance
/// from the planes of the two faces that do not have that corner.
#[portable_test]
fn curvature_collapse_cost_of_a_pyramid() {
    let mesh = Mesh {
        positions: vec![
            DVec3::Z,
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::new(-1.0, 1.0, 0.0),
            DVec3::new(-1.0, -1.0, 0.0),
            DVec3::new(1.0, -1.0, 0.0),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]],
    };
    let rings = Edges::new(&mesh).rings(5);
    let costs = collapse_costs(&mesh, &rings);
    // Areas of sqrt(2); distances of 2 / sqrt(2) from the planes y + z = 1 and the like.
    assert!(
        (costs[0] - 2.0 * 2.0f64.sqrt() * 2.0).abs() < 1e-12,
        "{costs:?}"
    );
    // A corner can go to the tip, which lies in the planes of all faces.
    assert!(
        costs[1..].iter().all(|cost| cost.abs() < 1e-12),
        "{costs:?}"
    );
    let far = mesh.with_positions(mesh.positions.iter().map(|p| *p + 1e6).collect());
    let moved = collapse_costs(&far, &rings);
    assert!(costs.iter().zip(moved).all(|(a, b)| (a - b).abs() < 1e-8));
}
