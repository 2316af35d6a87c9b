//! What an attack costs.

use crate::portable_test;
use crate::support::fixtures::asteroid;
use meshmark::internals::attack::{
    bend, crop, into_scene, midpoint, mirror, noise, reorder, similarity, simplify, smooth, soup,
    swap_axes, warp,
};
use meshmark::internals::geometry::{Distortion, Quality, diagonal};
use meshmark::internals::mesh::{Mesh, shapes};

/// RMS, Hausdorff and MSDM.
fn between(reference: &Mesh, attacked: &Mesh) -> [f64; 3] {
    let quality = Quality::between(reference, attacked);
    [quality.rms_rel, quality.hausdorff_rel, quality.msdm].map(Option::unwrap)
}

#[portable_test]
fn quality_of_the_same_is_perfect() {
    for mesh in [asteroid(), shapes::terrain(30), shapes::seven_shapes()] {
        // By the nearest points, where vertices do not correspond.
        for same in [mesh.clone(), reorder(&mesh, 1)] {
            let same = between(&mesh, &same);
            assert!(same.iter().all(|x| *x < 1e-9), "{same:?}");
        }
    }
    let nothing = Quality::between(&asteroid(), &Mesh::default());
    assert_eq!(nothing, Quality::default());
    assert_eq!(nothing.msdm, None);
}

#[portable_test]
fn quality_falls_with_noise() {
    let mesh = shapes::torus_knot(160, 24);
    let mut last = [0.0; 3];
    for amplitude in [0.0005, 0.001, 0.003, 0.005] {
        let noisy = noise(&mesh, amplitude, 7);
        let this = between(&mesh, &noisy);
        assert!(this.iter().zip(last).all(|(this, last)| *this > last));
        assert!(this[2] < 1.0, "{this:?}");
        // The same, however it is compared.
        let other = between(&mesh, &reorder(&noisy, 1));
        assert!(
            (other[0] / this[0] - 1.0).abs() < 0.02,
            "{other:?} {this:?}"
        );
        assert!(
            (0.5..2.0).contains(&(other[2] / this[2])),
            "{other:?} {this:?}"
        );
        last = this;
    }
}

/// A plane that rises: the distance is known.
#[portable_test]
fn quality_measures_distances() {
    let terrain = shapes::terrain(20);
    let plane = |height: f64, cells| {
        let mut plane = shapes::terrain(cells);
        plane.positions.iter_mut().for_each(|p| p.z = height * p.x);
        plane
    };
    let flat = plane(0.0, 20);
    // Another tessellation, so that nothing corresponds; heights 0 to 0.01, of RMS 0.01 / 3^0.5.
    let [rms, largest, _] = between(&flat, &plane(0.01, 25));
    let size = diagonal(&flat.positions);
    assert!(
        (rms * size / (0.01 / 3.0_f64.sqrt()) - 1.0).abs() < 2e-3,
        "{rms}"
    );
    assert!((largest * size / 0.01 - 1.0).abs() < 1e-3, "{largest}");

    for free in [
        crop(&terrain, 0.3, 1),
        into_scene(&terrain, 2.0, 1),
        midpoint(&terrain),
    ] {
        let [rms, largest, _] = between(&terrain, &free);
        assert!(rms < 1e-9 && largest < 1e-9, "{rms} {largest}");
    }
}

#[portable_test]
fn quality_does_not_mind_where_the_copy_is() {
    let mesh = asteroid();
    let noisy = noise(&mesh, 0.001, 3);
    let here = between(&mesh, &noisy);
    for moved in [similarity(&noisy, 1), mirror(&noisy), swap_axes(&noisy)] {
        let there = between(&mesh, &moved);
        for (there, here) in there.iter().zip(here) {
            assert!((there / here - 1.0).abs() < 0.01, "{there} {here}");
        }
    }
    // What stretches, or turns a part only, is no such move.
    let bent = between(&mesh, &bend(&mesh, 10.0));
    assert!(bent[0] > 0.003, "{bent:?}");
}

/// Eyes mind noise more than a bulge.
#[portable_test]
fn quality_tells_noise_from_a_smooth_warp() {
    for mesh in [asteroid(), shapes::torus_knot(160, 24), shapes::terrain(50)] {
        let noisy = noise(&mesh, 0.003, 5);
        let rms = Distortion::between(&mesh.positions, &noisy.positions).rms_rel;
        let warped = warp(&mesh, 0.2, rms, 5);
        let [noise, warp] = [&noisy, &warped].map(|copy| between(&mesh, copy)[2]);
        assert!(noise > 2.0 * warp, "{noise} {warp}");
    }
}

#[portable_test]
fn quality_compares_other_triangles() {
    let mesh = shapes::torus_knot(160, 24);
    let msdm = |copy: &Mesh| between(&mesh, copy)[2];
    for same in [
        midpoint(&mesh),
        soup(&mesh),
        crop(&mesh, 0.3, 1),
        into_scene(&mesh, 2.0, 1),
    ] {
        assert!(msdm(&same) < 1e-6, "{}", msdm(&same));
    }
    let [half, most] = [0.5, 0.9].map(|fraction| msdm(&simplify(&mesh, fraction)));
    assert!(half < most && most < 1.0, "{half} {most}");
    let [little, much] = [5, 50].map(|steps| msdm(&smooth(&mesh, 0.1, steps)));
    assert!(little < much, "{little} {much}");
}
