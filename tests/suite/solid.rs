//! The SOLID carrier.

use crate::portable_test;
use crate::support::fixtures::{key, strong};
use glam::DVec3;
use meshmark::internals::attack::{
    crop, noise, quantize, reorder, similarity, simplify, smooth, smooth_inside,
};
use meshmark::internals::carrier::solid::{Measurement, Surface, Surfaces};
use meshmark::internals::carrier::{Carrier, Host, Mark, StoredError};
use meshmark::internals::code::Codeword;
use meshmark::internals::detection::Statistic;
use meshmark::internals::geometry::{Distortion, Pose, diagonal};
use meshmark::internals::mesh::{Admissible, Mesh, shapes};
use meshmark::internals::progress::ignore;

const MESSAGE: u64 = 0x0f1_2345_6789_abcd;

fn rock() -> Mesh {
    shapes::asteroid(40, 60)
}

/// Marks a mesh at a strength of 0.08 %.
fn marked(mesh: &Mesh, owner: u8) -> Mesh {
    marked_at(mesh, owner, 0.0008)
}

fn marked_at(mesh: &Mesh, owner: u8, rms_rel: f64) -> Mesh {
    marked_as(
        &Host {
            mesh,
            leeway: &strong(mesh),
            admissible: &Admissible::default(),
            rms_rel,
            hidden: false,
            share: 1.0,
            on_top: None,
        },
        owner,
    )
}

fn marked_as(host: &Host, owner: u8) -> Mesh {
    let mark = Mark {
        key: &key(owner),
        codeword: &Codeword::new(MESSAGE),
    };
    let embedded = Carrier::Solid.embed(host, &mark, &mut ignore).unwrap();
    host.mesh.with_positions(
        host.mesh
            .positions
            .iter()
            .zip(embedded.displacement)
            .map(|(p, d)| *p + d)
            .collect(),
    )
}

/// The exponent of the hypothesis in which the message fits best.
fn exponent(mesh: &Mesh, reader: u8) -> f64 {
    let codeword = Codeword::new(MESSAGE);
    let hypotheses = Measurement::new(mesh)
        .read(&key(reader), &mut ignore)
        .unwrap()
        .hypotheses;
    let fits = hypotheses.iter().map(|hypothesis| {
        let symbols = hypothesis.symbols.iter();
        -Statistic::new(symbols.map(|soft| (soft.value * codeword.sign(soft.symbol), soft.weight)))
            .ln_p()
    });
    fits.fold(0.0, f64::max)
}

/// A scale along one axis of the scene, and fewer triangles: nobody sees either.
#[portable_test]
fn solid_stretches_are_undone() {
    let result = marked(&rock(), 1);
    for scale in [
        DVec3::new(1.0, 1.02, 1.0),
        DVec3::new(1.0, 1.0, 0.95),
        DVec3::new(1.1, 1.0, 1.0),
    ] {
        let stretched = result.positions.iter().map(|p| *p * scale).collect();
        let suspect = simplify(&result.with_positions(stretched), 0.5);
        let reached = exponent(&suspect, 1);
        assert!(reached > 60.0, "{scale}: {reached:.0}");
    }
}

#[portable_test]
fn solid_marks_a_mesh_within_the_limit() {
    let (host, result) = (rock(), marked(&rock(), 1));
    let distortion = Distortion::between(&host.positions, &result.positions);
    assert!(
        distortion.rms_rel <= 0.0008 * (1.0 + 1e-9) && distortion.max_rel <= 0.0032 * (1.0 + 1e-9),
        "{distortion:?}"
    );
    assert!(exponent(&result, 1) > 150.0, "{}", exponent(&result, 1));
    assert!(
        exponent(&result, 2) < 12.0,
        "another key sees nothing: {}",
        exponent(&result, 2)
    );
    assert!(
        exponent(&host, 1) < 12.0,
        "the unmarked mesh says nothing: {}",
        exponent(&host, 1)
    );
}

/// A detector gathers the surface in cells for the finest pitch that it tries, here finer than the one that is written: sheets
/// that share a cell in the one and not in the other show other fluxes.
#[portable_test]
fn solid_writes_what_a_detector_sees_of_thin_sheets() {
    let mut finned = shapes::cuboid(DVec3::new(1.0, 1.6, 2.4), [8, 13, 20]);
    for place in [0.7, 0.76, 0.82] {
        let fin = shapes::cuboid(DVec3::new(0.03, 1.2, 1.8), [1, 8, 12]);
        let first = finned.positions.len() as u32;
        let placed = fin.positions.iter().map(|p| *p + DVec3::X * place);
        finned.positions.extend(placed);
        let triangles = fin.triangles.iter().map(|t| t.map(|v| v + first));
        finned.triangles.extend(triangles);
    }
    let reached = exponent(&marked_at(&finned, 1, 0.0004), 1);
    assert!(reached > 150.0, "{reached}");
}

/// A block, one end of which is rough.
#[portable_test]
fn solid_hides_in_rough_surfaces() {
    let mut block = shapes::cuboid(DVec3::new(1.3, 1.0, 0.75), [52, 40, 30]);
    let rough = noise(&block, 0.004, 3);
    let is_rough = |p: &DVec3| p.x > 0.2;
    for (p, q) in block.positions.iter_mut().zip(&rough.positions) {
        if is_rough(p) {
            *p = *q;
        }
    }
    let host = Host {
        mesh: &block,
        leeway: &strong(&block),
        admissible: &Admissible::default(),
        rms_rel: 0.0004,
        hidden: true,
        share: 1.0,
        on_top: None,
    };
    let result = marked_as(&host, 1);
    let rms = |side: fn(f64) -> bool| {
        let pairs = block.positions.iter().zip(&result.positions);
        let moved: Vec<f64> = pairs
            .filter(|(p, _)| side(p.x))
            .map(|(p, q)| p.distance_squared(*q))
            .collect();
        (moved.iter().sum::<f64>() / moved.len() as f64).sqrt() / diagonal(&block.positions)
    };
    let (flat, rough) = (rms(|x| x < 0.1), rms(|x| x > 0.3));
    assert!(flat < 0.0001 && rough > 4.0 * flat, "{flat} {rough}");
    assert!(exponent(&result, 1) > 125.0, "{}", exponent(&result, 1));
}

/// Each attack with the share of the exponent that has to be left.
#[portable_test]
fn solid_stays_in_the_shape() {
    let result = marked(&rock(), 1);
    let whole = exponent(&result, 1);
    for (name, suspect, share) in [
        (
            "similarity, reorder",
            reorder(&similarity(&result, 5), 6),
            0.97,
        ),
        ("noise 0.1 %", noise(&result, 0.001, 7), 0.9),
        (
            "noise 0.3 %, similarity",
            similarity(&noise(&result, 0.003, 8), 9),
            0.6,
        ),
        ("quantize 10", quantize(&result, 10), 0.8),
        (
            "quantize 9, similarity",
            similarity(&quantize(&result, 9), 10),
            0.5,
        ),
        ("smooth 5", smooth(&result, 0.1, 5), 0.3),
        (
            "smooth 20, similarity",
            similarity(&smooth(&result, 0.1, 20), 11),
            0.3,
        ),
        ("smooth 50", smooth(&result, 0.1, 50), 0.2),
    ] {
        let left = exponent(&suspect, 1) / whole;
        assert!(left >= share, "{name}: {left:.2} of {whole:.0} is left");
    }
}

#[portable_test]
fn solid_undoes_smoothing_that_held_boundaries() {
    let open = crop(&shapes::asteroid(60, 90), 0.3, 3);
    assert_is_undone(&open, smooth_inside, [9, 27, 45]);
}

/// There it moves vertices farther than a step is wide, and takes a third of the area.
#[portable_test]
fn solid_undoes_smoothing_of_few_triangles() {
    assert_is_undone(&shapes::low_poly(), smooth, [7, 14, 28]);
}

/// Of a mark, three tenths and more are left after each number of steps.
fn assert_is_undone(host: &Mesh, smooth: fn(&Mesh, f64, u32) -> Mesh, numbers: [u32; 3]) {
    let result = marked(host, 1);
    let whole = exponent(&result, 1);
    for steps in numbers {
        let left = exponent(&smooth(&result, 0.1, steps), 1) / whole;
        assert!(left >= 0.3, "{steps}: {left:.2} of {whole:.0} is left");
    }
}

#[portable_test]
fn solid_marks_of_two_keys_stay_beside_each_other() {
    let twice = marked(&marked(&rock(), 1), 2);
    assert!(
        exponent(&twice, 1) > 40.0 && exponent(&twice, 2) > 150.0,
        "{} {}",
        exponent(&twice, 1),
        exponent(&twice, 2)
    );
}

#[portable_test]
fn solid_measurement_is_its_bytes() {
    let measurement = Measurement::new(&shapes::torus_knot(100, 24));
    let bytes = measurement.to_bytes();
    assert_eq!(Measurement::from_bytes(&bytes).as_ref(), Ok(&measurement));
    assert_eq!(
        Measurement::from_bytes(&bytes[..bytes.len() - 1]),
        Err(StoredError::Damaged)
    );
    assert!(bytes.len() < 2_000_000);
}

#[portable_test]
fn solid_refuses_shapes_that_cannot_hold_it() {
    let sheet = Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2]],
    };
    // It is seen from hundreds of lattice points, and its three vertices can serve nine.
    let host = Host {
        mesh: &sheet,
        leeway: &strong(&sheet),
        admissible: &Admissible::default(),
        rms_rel: 0.0008,
        hidden: false,
        share: 1.0,
        on_top: None,
    };
    let mark = Mark {
        key: &key(1),
        codeword: &Codeword::new(MESSAGE),
    };
    let error = Carrier::Solid.embed(&host, &mark, &mut ignore).unwrap_err();
    assert_eq!(error.code(), "carrier.too-few-addresses");
    assert!(error.to_string().contains("3 vertices give 9"), "{error}");
}

/// What no surface gives is refused by name. A measurement as bytes: origin and axes in 4, pitches in 1, spreads and the scene's axes in 7
/// times 4, units of areas and of moments in 4 each, the number of clusters in 4; then the first cluster's cell in 9, its centre in 3, area vector in 6, moment in 2, area in 1.
#[portable_test]
fn solid_refuses_forged_measurements() {
    const PITCHES: usize = 4;
    const SPREADS: usize = 5;
    const SCENE: usize = 17;
    const AREA_UNIT: usize = 33;
    const MOMENT_UNIT: usize = 37;
    const COUNT: usize = 41;
    const FIRST: usize = 45;
    let bytes = Measurement::new(&rock()).to_bytes();
    let with = |at: usize, forged: &[u8]| {
        let mut bytes = bytes.clone();
        bytes[at..at + forged.len()].copy_from_slice(forged);
        bytes
    };
    let impossible = |forged: &[u8]| match Measurement::from_bytes(forged) {
        Err(StoredError::Impossible(what)) => what,
        other => panic!("{:?}", other.map(drop)),
    };
    assert!(Measurement::from_bytes(&bytes).is_ok());
    let surfaces: Vec<Surface> = Surfaces::new(&rock()).take(3).collect();
    let [suspect, first, second] = surfaces.try_into().expect("there are three");
    let twice = Measurement::from_iter([suspect.clone(), first.clone(), first.clone()]);
    let turned = Measurement::from_iter([suspect, second, first]);
    for forged in [twice, turned] {
        assert_eq!(
            impossible(&forged.to_bytes()),
            "surfaces out of order or twice"
        );
    }
    assert_eq!(
        impossible(&bytes.repeat(18)),
        "more pieces than are looked for"
    );
    assert_eq!(
        impossible(&[&[2], &bytes[1..SPREADS], &bytes[AREA_UNIT..]].concat()),
        "surfaces without the suspect's own"
    );
    for pitches in [0b111, 0b100_0001] {
        assert_eq!(
            impossible(&with(PITCHES, &[pitches])),
            "a surface at more pitches than are read"
        );
    }
    assert_eq!(
        Measurement::from_bytes(&with(PITCHES, &[0])),
        Err(StoredError::Damaged)
    );
    for number in [1.5f32, f32::NAN, -0.1] {
        assert_eq!(
            impossible(&with(SPREADS, &number.to_le_bytes())),
            "a frame with no such spreads"
        );
    }
    for number in [2.0f32, f32::NAN, f32::INFINITY] {
        assert_eq!(
            impossible(&with(SCENE, &number.to_le_bytes())),
            "a frame that is not turned but distorted"
        );
    }
    for unit in [1e5f32, f32::INFINITY, f32::NAN, -1.0] {
        assert_eq!(
            impossible(&with(AREA_UNIT, &unit.to_le_bytes())),
            "areas in a unit that no surface needs"
        );
        assert_eq!(
            impossible(&with(MOMENT_UNIT, &unit.to_le_bytes())),
            "moments in a unit that no surface needs"
        );
    }
    assert_eq!(
        impossible(&with(COUNT, &u32::MAX.to_le_bytes())),
        "more pieces than are kept of a surface"
    );
    // The first cluster's area vector, and its moment, as long as can be; its area as small.
    for at in [FIRST + 9 + 3, FIRST + 9 + 9] {
        let mut forged = with(at, &i16::MAX.to_le_bytes());
        forged[FIRST + 9 + 11] = u8::MAX;
        assert_eq!(
            impossible(&forged),
            "a piece with more flux than its area gives"
        );
    }
    let few = |count: u32, clusters: &[&[u8]]| {
        [&bytes[..COUNT], &count.to_le_bytes(), &clusters.concat()].concat()
    };
    let far: &[u8] = &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x03];
    assert_eq!(
        impossible(&few(1, &[far, &[0; 12]])),
        "a piece beyond the frame"
    );
    let (first, rest) = (&bytes[FIRST..FIRST + 9], [0; 12]);
    let same: &[u8] = &[0];
    assert_eq!(
        impossible(&few(2, &[first, &rest, same, &rest])),
        "two pieces in one cell"
    );
}

/// A long rod has little area in its own frame: it is marked at the finest pitch.
#[portable_test]
fn solid_marks_long_rods() {
    let rock = shapes::asteroid(24, 36);
    let drawn = |thick: f64| {
        let by = DVec3::new(1.2 * thick, thick, 1.0);
        rock.with_positions(rock.positions.iter().map(|p| *p * by).collect())
    };
    let area = |mesh: &Mesh| {
        let size = Pose::of(mesh).unwrap().size;
        mesh.area() / (size * size)
    };
    let mut rods = (1..100).map(|step| drawn(0.002 * f64::from(step)));
    let rod = rods.find(|mesh| area(mesh) > 1.87).unwrap();
    assert!(area(&rod) < 2.0);
    let found = exponent(&similarity(&marked(&rod, 1), 3), 1);
    assert!(found > 90.0, "{found}");
}
