//! What each attack promises.

use crate::portable_test;
use crate::support::fixtures::{asteroid, cuboid};
use glam::DVec3;
use meshmark::internals::attack::{
    CATALOGUE, average, catmull_clark, crop, loop_scheme, midpoint, noise, quantize, remesh,
    reorder, resample, similarity, simplify, simplify_volume, smooth, smooth_inside, sqrt3, step,
    taubin, warp,
};
use meshmark::internals::geometry::{Distortion, Surface, diagonal};
use meshmark::internals::mesh::{Edges, Mesh, shapes};

fn volume(mesh: &Mesh) -> f64 {
    let volumes = mesh.triangles.iter().map(|&t| {
        let [a, b, c] = mesh.corners(t);
        a.dot(b.cross(c)) / 6.0
    });
    volumes.sum()
}

fn areas(mesh: &Mesh) -> impl Iterator<Item = f64> + '_ {
    mesh.triangles.iter().map(|&t| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length() / 2.0
    })
}

/// V, E, F and boundary edges.
fn counts(mesh: &Mesh) -> [usize; 4] {
    let mut edges: Vec<[u32; 2]> = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    [
        mesh.positions.len(),
        edges.len(),
        mesh.triangles.len(),
        Edges::new(mesh).num_boundary(),
    ]
}

/// The largest distance of one mesh's vertices from the other's surface, both ways, as a fraction of the diagonal.
fn hausdorff(a: &Mesh, b: &Mesh) -> f64 {
    let farthest = |from: &Mesh, to: &Mesh| {
        let surface = Surface::new(to);
        let distances = from
            .positions
            .iter()
            .map(|&p| surface.nearest(p).unwrap().distance);
        distances.fold(0.0, f64::max)
    };
    farthest(a, b).max(farthest(b, a)) / diagonal(&a.positions)
}

/// No edge of more than two faces, none run twice in one direction, no face without area, no vertex without a face.
fn assert_sound(name: &str, mesh: &Mesh) {
    let edges = Edges::new(mesh);
    assert_eq!(edges.num_non_manifold(), 0, "{name}");
    assert!(!edges.winding().flips.contains(&true), "{name}");
    assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name}");
    let mean = areas(mesh).sum::<f64>() / mesh.triangles.len() as f64;
    assert!(areas(mesh).all(|area| area > 1e-9 * mean), "{name}");
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles
        .iter()
        .flatten()
        .for_each(|&v| used[v as usize] = true);
    assert!(!used.contains(&false), "{name}");
}

/// The vertices on boundaries, in an order of their own.
fn border(mesh: &Mesh) -> Vec<[u64; 3]> {
    let vertices = Edges::new(mesh)
        .boundary(&mesh.triangles)
        .map(|(from, _)| from)
        .collect::<Vec<_>>();
    let mut places: Vec<[u64; 3]> = vertices
        .into_iter()
        .map(|v| mesh.positions[v as usize].to_array().map(f64::to_bits))
        .collect();
    places.sort_unstable();
    places
}

/// The benchmark's unit of length.
fn mean_radius(mesh: &Mesh) -> f64 {
    let count = mesh.positions.len() as f64;
    let mean = mesh.positions.iter().sum::<DVec3>() / count;
    mesh.positions.iter().map(|p| p.distance(mean)).sum::<f64>() / count
}

#[portable_test]
fn attack_noise_keeps_to_its_amplitude() {
    let mesh = asteroid();
    for amplitude in [0.0005, 0.001, 0.003, 0.005] {
        let noisy = noise(&mesh, amplitude, 1);
        let pairs = mesh.positions.iter().zip(&noisy.positions);
        let components: Vec<f64> = pairs
            .flat_map(|(a, b)| (*b - *a).to_array())
            .map(|component| component / (amplitude * mean_radius(&mesh)))
            .collect();
        let largest = components.iter().fold(0.0, |max: f64, c| max.max(c.abs()));
        assert!((0.999..=1.0 + 1e-9).contains(&largest), "{largest}");
        // Uniform: the variance is a third.
        let square = components.iter().map(|c| c * c).sum::<f64>() / components.len() as f64;
        assert!((square - 1.0 / 3.0).abs() < 0.02, "{square}");
    }
    let terrain = shapes::terrain(20);
    assert_eq!(border(&noise(&terrain, 0.01, 1)), border(&terrain));
}

#[portable_test]
fn attack_quantize_leaves_so_many_values() {
    let mesh = asteroid();
    for bits in [7, 9] {
        let quantized = quantize(&mesh, bits);
        for axis in 0..3 {
            let values = |mesh: &Mesh| -> Vec<f64> {
                let mut values: Vec<f64> = mesh.positions.iter().map(|p| p[axis]).collect();
                values.sort_by(f64::total_cmp);
                values
            };
            let (before, mut after) = (values(&mesh), values(&quantized));
            let step = (before[before.len() - 1] - before[0]) / f64::from(1 << bits);
            assert_eq!(after[0], before[0]);
            for value in &after {
                let steps = (value - before[0]) / step;
                assert!((steps - steps.round()).abs() < 1e-9);
            }
            after.dedup();
            assert!(after.len() <= (1 << bits) + 1, "{}", after.len());
        }
        let largest = mesh.positions.iter().zip(&quantized.positions);
        let largest = largest.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        let half_a_cell = 0.5 * diagonal(&mesh.positions) / f64::from(1 << bits);
        assert!((0.8 * half_a_cell..=half_a_cell).contains(&largest));
    }
}

#[portable_test]
fn attack_similarity_keeps_the_shape() {
    let mesh = asteroid();
    for seed in 0..20 {
        let moved = similarity(&mesh, seed);
        let scale = mean_radius(&moved) / mean_radius(&mesh);
        assert!((0.1..=10.0).contains(&scale), "{scale}");
        assert!((volume(&moved) / volume(&mesh) / (scale * scale * scale) - 1.0).abs() < 1e-9);
        for [a, b, c] in mesh.triangles.iter().copied() {
            let sides = |mesh: &Mesh| {
                let [a, b, c] = mesh.corners([a, b, c]);
                DVec3::new(a.distance(b), b.distance(c), c.distance(a))
            };
            assert!(sides(&moved).distance(sides(&mesh) * scale) < 1e-9 * scale);
        }
        assert_eq!(moved.triangles, mesh.triangles);
    }
}

#[portable_test]
fn attack_crop_removes_its_fraction() {
    for mesh in [asteroid(), shapes::terrain(30)] {
        for fraction in [0.1, 0.3, 0.5] {
            let cropped = crop(&mesh, fraction, 3);
            let kept = ((1.0 - fraction) * mesh.positions.len() as f64).round() as usize;
            assert_eq!(cropped.positions.len(), kept);
            let surface = Surface::new(&mesh);
            let stays = |p: &DVec3| surface.nearest(*p).unwrap().distance < 1e-12;
            assert!(cropped.positions.iter().all(stays));
            assert!(Edges::new(&cropped).num_boundary() > 0, "not capped");
            assert_ne!(cropped, crop(&mesh, fraction, 4), "another direction");
        }
    }
}

#[portable_test]
fn attack_reorder_keeps_every_triangle() {
    let mesh = asteroid();
    let reordered = reorder(&mesh, 1);
    let triangles = |mesh: &Mesh| {
        let mut triangles: Vec<[[u64; 3]; 3]> = mesh
            .triangles
            .iter()
            .map(|&t| mesh.corners(t).map(|p| p.to_array().map(f64::to_bits)))
            .map(|mut corners| {
                // Turned to begin with the least, which keeps the winding.
                let least = (0..3).min_by_key(|&i| corners[i]).unwrap();
                corners.rotate_left(least);
                corners
            })
            .collect();
        triangles.sort_unstable();
        triangles
    };
    assert_ne!(reordered.positions, mesh.positions);
    assert_eq!(triangles(&reordered), triangles(&mesh));
}

#[portable_test]
fn attack_smooth_keeps_boundaries_and_shrinks() {
    let terrain = shapes::terrain(20);
    assert_eq!(border(&smooth_inside(&terrain, 0.1, 30)), border(&terrain));
    assert_ne!(border(&smooth(&terrain, 0.1, 30)), border(&terrain));
    let mesh = asteroid();
    assert_eq!(smooth_inside(&mesh, 0.1, 9), smooth(&mesh, 0.1, 9));
    let smoothed = volume(&smooth(&mesh, 0.1, 50)) / volume(&mesh);
    let kept = volume(&taubin(&mesh, 0.5, -0.53, 20)) / volume(&mesh);
    assert!(
        smoothed < 0.999 && (kept - 1.0).abs() < 0.2 * (1.0 - smoothed),
        "{smoothed} {kept}"
    );
}

#[portable_test]
fn attack_subdivisions_have_their_counts() {
    for mesh in [asteroid(), shapes::terrain(20)] {
        let [v, e, f, b] = counts(&mesh);
        for (name, divided, vertices, faces, borders) in [
            ("midpoint", midpoint(&mesh), v + e, 4 * f, 2 * b),
            ("loop", loop_scheme(&mesh), v + e, 4 * f, 2 * b),
            ("sqrt3", sqrt3(&mesh), v + f, 3 * f, b),
            (
                "catmull-clark",
                catmull_clark(&mesh, 1),
                v + e + f,
                6 * f,
                2 * b,
            ),
        ] {
            let [v, _, f, b] = counts(&divided);
            assert_eq!([v, f, b], [vertices, faces, borders], "{name}");
            assert_sound(name, &divided);
            let distance = hausdorff(&mesh, &divided);
            assert!(distance < 0.02, "{name}: {distance}");
        }
        // Each triangle is three quads, which meet in 2 E + 3 F edges.
        let twice = counts(&catmull_clark(&mesh, 2));
        assert_eq!(twice[0], (v + e + f) + (2 * e + 3 * f) + 3 * f);
    }
}

#[portable_test]
fn attack_midpoint_keeps_the_surface() {
    let mesh = asteroid();
    assert!((volume(&midpoint(&mesh)) / volume(&mesh) - 1.0).abs() < 1e-12);
}

/// The benchmark counts edges, on open surfaces too.
#[portable_test]
fn attack_simplifications_remove_so_many_edges() {
    for mesh in [asteroid(), shapes::terrain(30)] {
        let [_, before, _, _] = counts(&mesh);
        for fraction in [0.1, 0.5, 0.9, 0.975] {
            for simple in [simplify(&mesh, fraction), simplify_volume(&mesh, fraction)] {
                let [_, after, _, _] = counts(&simple);
                let most = ((1.0 - fraction) * before as f64).ceil() as usize;
                // The last collapse may have taken three.
                assert!((most - 2..=most).contains(&after), "{after} of {before}");
            }
        }
    }
}

#[portable_test]
fn attack_simplify_volume_preserves_it() {
    let change = |mesh: &Mesh, simple: &Mesh| (volume(simple) / volume(mesh) - 1.0).abs();
    for (name, mesh) in [
        ("asteroid", asteroid()),
        ("machined part", shapes::cad_part()),
    ] {
        for fraction in [0.5, 0.95] {
            let simple = simplify_volume(&mesh, fraction);
            assert_sound(name, &simple);
            let (this, other) = (
                change(&mesh, &simple),
                change(&mesh, &simplify(&mesh, fraction)),
            );
            assert!(this < 1e-9, "{name}, {fraction}: {this}");
            assert!(this < 1e-3 * other, "{name}: {this}, quadrics {other}");
            assert!(hausdorff(&mesh, &simple) < 0.04, "{name}");
            assert_eq!(simple, simplify_volume(&mesh, fraction), "deterministic");
        }
    }
}

/// A collapse takes nothing away within a straight border, and cuts corners last.
#[portable_test]
fn attack_simplify_volume_keeps_borders_and_planes() {
    let mut plane = shapes::terrain(20);
    plane.positions.iter_mut().for_each(|p| p.z = 0.0);
    let simple = simplify_volume(&plane, 0.9);
    assert_sound("plane", &simple);
    assert!(simple.positions.iter().all(|p| p.z.abs() < 1e-12));
    let area = areas(&simple).sum::<f64>();
    assert!((area - 1.0).abs() < 1e-9, "{area}");
}

/// On a flat, regular plane the smooth schemes reproduce the plane, and its square stays one.
#[portable_test]
fn attack_subdivisions_keep_planes() {
    let mut plane = shapes::terrain(12);
    plane.positions.iter_mut().for_each(|p| p.z = 0.0);
    for (name, divided) in [
        ("sqrt3", sqrt3(&plane)),
        ("catmull-clark", catmull_clark(&plane, 2)),
    ] {
        assert!(
            divided.positions.iter().all(|p| p.z.abs() < 1e-15),
            "{name}"
        );
        assert!((areas(&divided).sum::<f64>() - 1.0).abs() < 1e-12, "{name}");
    }
}

#[portable_test]
fn attack_simplify_removes_its_fraction() {
    let mesh = asteroid();
    for (fraction, farthest) in [(0.3, 0.001), (0.5, 0.002), (0.9, 0.01), (0.975, 0.04)] {
        let simple = simplify(&mesh, fraction);
        let kept = simple.triangles.len() as f64 / mesh.triangles.len() as f64;
        assert!((kept - (1.0 - fraction)).abs() < 0.001, "{kept}");
        assert_sound("simplify", &simple);
        assert_eq!(Edges::new(&simple).num_boundary(), 0);
        let distance = hausdorff(&mesh, &simple);
        assert!(distance < farthest, "{fraction}: {distance}");
        let ratio = volume(&simple) / volume(&mesh);
        assert!((ratio - 1.0).abs() < farthest, "{fraction}: {ratio}");
        assert_eq!(simple, simplify(&mesh, fraction), "deterministic");
    }
}

#[portable_test]
fn attack_simplify_keeps_borders_and_planes() {
    let mut plane = shapes::terrain(20);
    plane.positions.iter_mut().for_each(|p| p.z = 0.0);
    let simple = simplify(&plane, 0.9);
    assert_sound("plane", &simple);
    assert!(
        (areas(&simple).sum::<f64>() - 1.0).abs() < 1e-6,
        "the square stays a square"
    );
    assert_eq!(Edges::new(&simple).num_components(), 1);
}

/// Nothing is left to collapse long before nothing is left.
#[portable_test]
fn attack_simplify_keeps_the_topology() {
    let knot = simplify(&shapes::torus_knot(60, 20), 1.0);
    assert_sound("knot", &knot);
    let [v, e, f, b] = counts(&knot);
    assert_eq!(
        (v as i64 - e as i64 + f as i64, b),
        (0, 0),
        "still of genus 1"
    );
    assert!(f >= 14, "no torus has fewer faces than 14, this one {f}");
}

#[portable_test]
fn attack_simplify_accepts_non_manifold_edges() {
    let mut mesh = shapes::terrain(10);
    let first = mesh.positions.len() as u32;
    // A fin on the edge between the first two vertices of a row inside.
    mesh.positions.push(DVec3::new(0.5, 0.5, 1.0));
    mesh.triangles.push([60, 61, first]);
    let simple = simplify(&mesh, 0.5);
    assert_eq!(Edges::new(&simple).num_non_manifold(), 1);
}

#[portable_test]
fn attack_remesh_evens_edges_on_the_same_surface() {
    for (name, mesh, length) in [
        ("asteroid", asteroid(), 0.02),
        ("knot", shapes::torus_knot(160, 24), 0.012),
        ("terrain", shapes::terrain(30), 0.03),
    ] {
        let new = remesh(&mesh, length);
        assert_sound(name, &new);
        assert!(
            hausdorff(&mesh, &new) < 0.003,
            "{name}: {}",
            hausdorff(&mesh, &new)
        );
        let target = length * diagonal(&mesh.positions);
        let lengths: Vec<f64> = new
            .triangles
            .iter()
            .map(|&[a, b, _]| {
                new.positions[a as usize].distance(new.positions[b as usize]) / target
            })
            .collect();
        let even = lengths.iter().filter(|l| (0.66..=1.5).contains(*l)).count();
        assert!(
            even * 20 > lengths.len() * 19,
            "{name}: {even} of {}",
            lengths.len()
        );
        let before = counts(&mesh);
        let after = counts(&new);
        let euler = |[v, e, f, _]: [usize; 4]| v as i64 - e as i64 + f as i64;
        assert_eq!(euler(before), euler(after), "{name}");
        assert_eq!(new, remesh(&mesh, length), "deterministic");
    }
}

#[portable_test]
fn attack_remesh_keeps_creases() {
    let cube = cuboid(DVec3::ONE);
    let new = remesh(&cube, 0.03);
    assert_sound("cube", &new);
    assert!((volume(&new) - 1.0).abs() < 1e-9, "{}", volume(&new));
}

#[portable_test]
fn attack_resample_finds_the_surface_again() {
    for (name, mesh, cell) in [
        ("asteroid", asteroid(), 0.015),
        ("knot", shapes::torus_knot(160, 24), 0.008),
        ("cube", cuboid(DVec3::ONE), 0.02),
    ] {
        let new = resample(&mesh, cell);
        assert_sound(name, &new);
        assert_eq!(Edges::new(&new).num_boundary(), 0, "{name}");
        assert_eq!(Edges::new(&new).num_components(), 1, "{name}");
        let distance = hausdorff(&mesh, &new);
        assert!(distance < cell, "{name}: {distance}");
        let ratio = volume(&new) / volume(&mesh);
        assert!((ratio - 1.0).abs() < 0.01, "{name}: {ratio}");
        assert_eq!(new, resample(&mesh, cell), "deterministic");
    }
}

#[portable_test]
fn attack_resample_ends_an_open_surface_where_it_ended() {
    let terrain = shapes::terrain(30);
    let new = resample(&terrain, 0.015);
    assert_sound("terrain", &new);
    let ratio = areas(&new).sum::<f64>() / areas(&terrain).sum::<f64>();
    assert!((0.95..1.1).contains(&ratio), "{ratio}");
    assert!(hausdorff(&terrain, &new) < 0.015);
}

#[portable_test]
fn attack_warp_has_its_rms_and_is_smooth() {
    let mesh = asteroid();
    let warped = warp(&mesh, 0.1, 0.0008, 3);
    let distortion = Distortion::between(&mesh.positions, &warped.positions);
    assert!((distortion.rms_rel - 0.0008).abs() < 1e-9);
    let displacement = |v: u32| warped.positions[v as usize] - mesh.positions[v as usize];
    let (mut difference, mut size) = (0.0, 0.0);
    for &[a, b, _] in &mesh.triangles {
        difference += (displacement(a) - displacement(b)).length();
        size += displacement(a).length();
    }
    assert!(difference < size, "neighbours move alike");
}

#[portable_test]
fn attack_average_is_the_mean() {
    let mesh = asteroid();
    let moved = mesh.with_positions(mesh.positions.iter().map(|p| *p + DVec3::X).collect());
    let mean = average(&[mesh.clone(), moved]);
    let halfway = mesh.positions.iter().map(|p| *p + DVec3::X / 2.0);
    assert!(
        mean.positions
            .iter()
            .zip(halfway)
            .all(|(a, b)| a.distance(b) < 1e-12)
    );
    assert_eq!(mean.triangles, mesh.triangles);
}

#[portable_test]
fn attack_nothing_comes_of_nothing() {
    let nothing = Mesh::default();
    for result in [
        smooth(&nothing, 0.1, 2),
        smooth_inside(&nothing, 0.1, 2),
        taubin(&nothing, 0.5, -0.53, 2),
        midpoint(&nothing),
        loop_scheme(&nothing),
        sqrt3(&nothing),
        catmull_clark(&nothing, 2),
        simplify(&nothing, 0.5),
        simplify_volume(&nothing, 0.5),
        remesh(&nothing, 0.01),
        resample(&nothing, 0.01),
        warp(&nothing, 0.1, 0.001, 1),
        average(&[]),
    ] {
        assert_eq!(result, nothing);
    }
}

/// Names are what the command line, the page and the tables' random numbers go by.
#[portable_test]
fn every_step_is_found_by_its_name() {
    for attack in CATALOGUE {
        for found in attack.steps() {
            let name = found.to_string();
            let same = step(&name).unwrap();
            assert_eq!((same.attack.name, same.level), (attack.name, found.level));
            let bare = name.trim_end_matches(attack.unit);
            assert_eq!(step(bare).unwrap().to_string(), name);
        }
    }
    for name in [
        "",
        "nois",
        "noise",
        "noise 0.2 %",
        "reorder 1",
        "noise 0.1 bits",
    ] {
        assert!(step(name).is_none(), "{name}");
    }
}
