//! What each attack of the wild, and each flip of an edge, promises.

use crate::portable_test;
use crate::support::fixtures::asteroid;
use glam::DVec3;
use meshmark::internals::attack::{
    CATALOGUE, bake, bend, convert_units, delaunay, into_scene, mirror, noise, soup, split,
    swap_axes, take_out, weld,
};
use meshmark::internals::geometry::{Surface, diagonal};
use meshmark::internals::mesh::{Edges, Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};

fn volume(mesh: &Mesh) -> f64 {
    let volumes = mesh.triangles.iter().map(|&t| {
        let [a, b, c] = mesh.corners(t);
        a.dot(b.cross(c)) / 6.0
    });
    volumes.sum()
}

/// Triangles by their corners' positions, in an order of their own.
fn triangles(mesh: &Mesh) -> Vec<[[u64; 3]; 3]> {
    let corners = |&t: &[u32; 3]| mesh.corners(t).map(|p| p.to_array().map(f64::to_bits));
    let mut triangles: Vec<_> = mesh.triangles.iter().map(corners).collect();
    triangles.sort_unstable();
    triangles
}

/// Interior edges whose opposite angles sum to more than pi.
fn num_not_delaunay(mesh: &Mesh) -> usize {
    let angle = |face: u32, ends: [u32; 2]| {
        let triangle = mesh.triangles[face as usize];
        let apex = triangle.iter().find(|v| !ends.contains(v)).unwrap();
        let [a, b] = ends.map(|v| mesh.positions[v as usize] - mesh.positions[*apex as usize]);
        libm::atan2(a.cross(b).length(), a.dot(b))
    };
    let edges = Edges::new(mesh);
    let over = edges.pairs().filter(|pair| {
        let [a, b] = pair.faces.map(|face| angle(face, pair.ends));
        a + b > std::f64::consts::PI + 1e-6
    });
    over.count()
}

#[portable_test]
fn attack_delaunay_leaves_none_in_a_plane() {
    // The border stays a square.
    let mut plane = noise(&shapes::terrain(30), 0.02, 1);
    plane.positions.iter_mut().for_each(|p| p.z = 0.0);
    assert!(num_not_delaunay(&plane) > 200);
    let flipped = delaunay(&plane);
    assert_eq!(num_not_delaunay(&flipped), 0);
    assert_eq!(flipped.positions, plane.positions);
    assert!((flipped.area() - 1.0).abs() < 1e-12);
    assert_eq!(flipped, delaunay(&plane), "deterministic");
}

#[portable_test]
fn attack_delaunay_flips_what_is_flat_and_no_crease() {
    for (name, mesh) in [
        ("knot", shapes::torus_knot(160, 24)),
        ("machined part", shapes::cad_part()),
        ("asteroid", asteroid()),
    ] {
        let flipped = delaunay(&mesh);
        let (before, after) = (num_not_delaunay(&mesh), num_not_delaunay(&flipped));
        assert!(5 * after < before, "{name}: {after} of {before}");
        assert_eq!(flipped.positions, mesh.positions, "{name}");
        assert_eq!(flipped.triangles.len(), mesh.triangles.len(), "{name}");
        let edges = Edges::new(&flipped);
        assert_eq!(edges.num_boundary(), Edges::new(&mesh).num_boundary());
        assert!(!edges.winding().flips.contains(&true), "{name}");
        let change = (volume(&flipped) / volume(&mesh) - 1.0).abs();
        assert!(change < 2e-3, "{name}: {change}");
    }
    let cube = shapes::cuboid(DVec3::new(1.0, 2.0, 3.0), [2, 3, 4]);
    assert!((volume(&delaunay(&cube)) - 6.0).abs() < 1e-12);
}

#[portable_test]
fn attack_soup_and_split_keep_every_triangle() {
    let mesh = shapes::torus_knot(60, 20);
    let soup = soup(&mesh);
    assert_eq!(soup.positions.len(), 3 * mesh.triangles.len());
    assert_eq!(triangles(&soup), triangles(&mesh));
    assert_eq!(Edges::new(&soup).num_components(), mesh.triangles.len());

    let parts = split(&mesh, 5);
    assert_eq!(triangles(&parts), triangles(&mesh));
    assert!(Edges::new(&parts).num_components() >= 4);
    assert!(parts.positions.len() > mesh.positions.len());
    assert!(parts.positions.len() < 2 * mesh.positions.len());
}

/// What a soup's reader does first: the vertices are shared again.
#[portable_test]
fn attack_weld_undoes_a_soup() {
    let mesh = shapes::torus_knot(60, 20);
    let welded = weld(&soup(&mesh), 1e-9);
    assert_eq!(welded.positions.len(), mesh.positions.len());
    assert_eq!(triangles(&welded), triangles(&mesh));

    // With a wide reach, no two that are left are near each other.
    let reach = 0.02;
    let merged = weld(&mesh, reach);
    let least = reach * diagonal(&mesh.positions);
    assert!(merged.positions.len() < mesh.positions.len() * 9 / 10);
    for (number, p) in merged.positions.iter().enumerate() {
        let others = &merged.positions[..number];
        assert!(others.iter().all(|q| p.distance(*q) > least));
    }
    assert!(
        merged
            .triangles
            .iter()
            .all(|[a, b, c]| a != b && b != c && c != a)
    );
}

#[portable_test]
fn attack_exports_keep_the_shape() {
    let mesh = asteroid();
    let before = volume(&mesh);
    let ratio = |copy: &Mesh| volume(copy) / before;
    assert!((ratio(&swap_axes(&mesh)) - 1.0).abs() < 1e-6);
    assert!((ratio(&mirror(&mesh)) - 1.0).abs() < 1e-12, "still outward");
    assert_eq!(mirror(&mirror(&mesh)), mesh);
    assert!(ratio(&bake(&mesh, 1)) > 0.0);
    for copy in [
        swap_axes(&mesh),
        bake(&mesh, 1),
        convert_units(&mesh, 1000.0, 1),
    ] {
        assert_eq!(copy.triangles, mesh.triangles);
        let single = |p: &DVec3| p.as_vec3().as_dvec3() == *p;
        assert!(copy.positions.iter().all(single), "f32 values");
    }
    // 1000 diagonals off, the spacing of numbers is that of some 13 bits.
    let far = convert_units(&mesh, 1000.0, 1);
    let inches: Vec<DVec3> = far.positions.iter().map(|p| *p / 0.0254).collect();
    let shift = inches.iter().sum::<DVec3>() - mesh.positions.iter().sum::<DVec3>();
    let shift = shift / inches.len() as f64;
    let size = diagonal(&mesh.positions);
    assert!((shift.length() / size - 1000.0).abs() < 0.1);
    let pairs = mesh.positions.iter().zip(&inches);
    let squares = pairs.map(|(p, q)| (*p + shift).distance_squared(*q));
    let rms = (squares.sum::<f64>() / inches.len() as f64).sqrt() / size;
    assert!((3e-6..6e-5).contains(&rms), "{rms:e}");
}

#[portable_test]
fn attack_take_out_takes_the_largest_but_one() {
    let shapes = shapes::seven_shapes();
    let rest = take_out(&shapes);
    assert_eq!(Edges::new(&rest).num_components(), 6);
    let areas = |mesh: &Mesh| {
        let labels = Edges::new(mesh).components();
        let mut areas = vec![0.0; Edges::new(mesh).num_components()];
        for (&label, &triangle) in labels.iter().zip(&mesh.triangles) {
            let [a, b, c] = mesh.corners(triangle);
            areas[label as usize] += (b - a).cross(c - a).length() / 2.0;
        }
        areas.sort_by(f64::total_cmp);
        areas
    };
    let mut expected = areas(&shapes);
    expected.remove(5);
    let left = areas(&rest);
    assert!(
        left.iter()
            .zip(&expected)
            .all(|(a, b)| (a - b).abs() < 1e-9)
    );
    assert_eq!(take_out(&asteroid()), asteroid());
}

#[portable_test]
fn attack_into_scene_keeps_the_model_as_it_is() {
    let mesh = asteroid();
    for times in [2.0, 5.0] {
        let scene = into_scene(&mesh, times, 2);
        let model = triangles(&mesh);
        let all = triangles(&scene);
        assert!(model.iter().all(|t| all.binary_search(t).is_ok()));
        assert_eq!(Edges::new(&scene).num_components(), 10);
        let size = |mesh: &Mesh| {
            let positions = mesh.positions.iter();
            let (low, high) = positions
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
                    (low.min(*p), high.max(*p))
                });
            (high - low).max_element()
        };
        let ratio = size(&scene) / size(&mesh);
        assert!((times..1.5 * times).contains(&ratio), "{ratio}");
        // Nothing stands in the model.
        let surface = Surface::new(&mesh);
        let others = scene
            .positions
            .iter()
            .filter(|p| !mesh.positions.contains(p));
        let nearest = others.map(|p| surface.nearest(*p).unwrap().distance);
        assert!(nearest.fold(f64::MAX, f64::min) > 0.01);
    }
}

#[portable_test]
fn attack_bend_turns_one_half() {
    let mesh = shapes::capsule(60, 40);
    let size = diagonal(&mesh.positions);
    for degrees in [10.0_f64, 30.0] {
        let bent = bend(&mesh, degrees);
        let turned = libm::cos(degrees.to_radians());
        for (p, q) in mesh.positions.iter().zip(&bent.positions) {
            if p.z < -0.31 {
                assert_eq!(p, q, "the lower bone");
            }
            if p.z > 0.31 {
                assert!((p.length() - q.length()).abs() < 1e-12 * size, "turned");
            }
        }
        let top = (0..mesh.positions.len())
            .max_by(|&a, &b| mesh.positions[a].z.total_cmp(&mesh.positions[b].z))
            .unwrap();
        let (before, after) = (mesh.positions[top], bent.positions[top]);
        let cosine = before.dot(after) / (before.length() * after.length());
        assert!((cosine - turned).abs() < 1e-9);
    }
}

/// Whatever is done, a reader takes what comes of it, and the same seed gives the same.
#[portable_test]
fn attack_catalogue_gives_files_that_can_be_read() {
    let mesh = shapes::asteroid(10, 14);
    for attack in CATALOGUE {
        let level = attack.steps().last().unwrap();
        let attacked = level.apply(&mesh, 1);
        assert_eq!(attacked, level.apply(&mesh, 1), "{level}");
        assert!(attacked.positions.iter().all(|p| p.is_finite()), "{level}");
        let document =
            meshmark::internals::document::Document::read(&to_glb(&attacked), &Default::default());
        let scene = Scene::gather(&document.unwrap()).unwrap();
        assert!(!scene.mesh.triangles.is_empty(), "{level}");
        let nothing = level.apply(&Mesh::default(), 1);
        assert_eq!(nothing, Mesh::default(), "{level}");
    }
}
