//! The RING carrier.

use crate::portable_test;
use crate::support::fixtures::{asteroid, key, strong};
use glam::{DMat3, DVec3};
use meshmark::internals::attack::{crop, reorder, similarity};
use meshmark::internals::carrier::ring::{Measurement, trace};
use meshmark::internals::carrier::{Carrier, Host, Hypothesis, Mark, StoredError};
use meshmark::internals::code::{Codeword, Symbol};
use meshmark::internals::detection::Statistic;
use meshmark::internals::mesh::{Admissible, Mesh, Orbit, shapes};
use meshmark::internals::progress::ignore;

const MESSAGE: u64 = 0x123_4567_89ab_cdef;

/// Marks a mesh at a strength of 0.04 %.
fn marked(mesh: &Mesh, admissible: &Admissible) -> Vec<DVec3> {
    let host = Host {
        mesh,
        leeway: &strong(mesh),
        admissible,
        rms_rel: 0.0004,
        hidden: false,
        share: 1.0,
        on_top: None,
    };
    let mark = Mark {
        key: &key(1),
        codeword: &Codeword::new(MESSAGE),
    };
    let embedded = Carrier::Ring.embed(&host, &mark, &mut ignore);
    embedded.unwrap().displacement
}

fn displaced(mesh: &Mesh, displacement: &[DVec3]) -> Mesh {
    mesh.with_positions(
        mesh.positions
            .iter()
            .zip(displacement)
            .map(|(p, d)| *p + *d)
            .collect(),
    )
}

fn statistic(hypothesis: &Hypothesis) -> Statistic {
    let codeword = Codeword::new(MESSAGE);
    Statistic::new(
        hypothesis
            .symbols
            .iter()
            .map(|soft| (soft.value * codeword.sign(soft.symbol), soft.weight)),
    )
}

fn best(mesh: &Mesh, reader: u8) -> f64 {
    Measurement::new(mesh)
        .read(&key(reader))
        .hypotheses
        .iter()
        .map(|h| statistic(h).ln_p())
        .fold(0.0, f64::min)
}

#[portable_test]
fn ring_marks_a_mesh_within_the_limit() {
    let asteroid = asteroid();
    let displacement = marked(&asteroid, &Admissible::default());
    let result = displaced(&asteroid, &displacement);
    let distortion =
        meshmark::internals::geometry::Distortion::between(&asteroid.positions, &result.positions);
    assert!(
        distortion.rms_rel <= 0.0004 * (1.0 + 1e-12),
        "{distortion:?}"
    );
    assert!(
        distortion.max_rel <= 4.0 * 0.0004 * (1.0 + 1e-12),
        "{distortion:?}"
    );
    assert!(best(&result, 1) < -150.0, "{}", best(&result, 1));
    assert!(
        best(&result, 2) > -10.0,
        "another key sees nothing: {}",
        best(&result, 2)
    );
    assert!(
        best(&asteroid, 1) > -10.0,
        "the unmarked mesh says nothing: {}",
        best(&asteroid, 1)
    );
}

/// The statistic itself does not change, so neither does any verdict.
#[portable_test]
fn ring_reading_does_not_depend_on_pose_or_order() {
    let asteroid = asteroid();
    let result = displaced(&asteroid, &marked(&asteroid, &Admissible::default()));
    let plain = best(&result, 1);
    for other in [
        similarity(&result, 5),
        reorder(&result, 6),
        reorder(&similarity(&result, 7), 8),
    ] {
        assert!(
            (best(&other, 1) / plain - 1.0).abs() < 0.01,
            "{} against {plain}",
            best(&other, 1)
        );
    }
}

#[portable_test]
fn ring_mark_stays_in_every_part() {
    let asteroid = asteroid();
    let result = displaced(&asteroid, &marked(&asteroid, &Admissible::default()));
    let half = best(&crop(&result, 0.5, 3), 1);
    assert!(half < -60.0, "{half}");
}

#[portable_test]
fn ring_turned_over_faces_do_not_matter() {
    let asteroid = asteroid();
    let mut result = displaced(&asteroid, &marked(&asteroid, &Admissible::default()));
    let plain = best(&result, 1);
    result
        .triangles
        .iter_mut()
        .step_by(3)
        .for_each(|triangle| triangle.swap(0, 1));
    assert!((best(&result, 1) / plain - 1.0).abs() < 1e-6);
}

#[portable_test]
fn ring_a_key_owns_a_quarter_of_the_addresses() {
    let measurement = Measurement::new(&asteroid());
    let (mut owned, mut all) = (0, 0);
    for number in 0..20 {
        let reading = measurement.read(&key(number));
        owned += reading.hypotheses[0].symbols.len();
        all += reading.num_addresses;
    }
    let share = owned as f64 / all as f64;
    assert!((0.23..0.27).contains(&share), "{share}");
}

#[portable_test]
fn ring_weights_do_not_depend_on_the_key() {
    let measurement = Measurement::new(&asteroid());
    for hypothesis in measurement.read(&key(1)).hypotheses {
        assert!(
            hypothesis
                .symbols
                .iter()
                .all(|soft| soft.value.abs() <= soft.weight * (1.0 + 1e-12))
        );
        assert!(
            hypothesis
                .symbols
                .iter()
                .all(|soft| (0.0..=2.0).contains(&soft.weight))
        );
        assert!(
            hypothesis
                .symbols
                .iter()
                .any(|soft| soft.symbol == Symbol::Pilot)
        );
    }
}

#[portable_test]
fn ring_measurement_is_its_bytes() {
    let measurement = Measurement::new(&shapes::terrain(20));
    let bytes = measurement.to_bytes();
    assert_eq!(Measurement::from_bytes(&bytes).as_ref(), Ok(&measurement));
    assert_eq!(
        Measurement::from_bytes(&bytes[..bytes.len() - 1]),
        Err(StoredError::Damaged)
    );
    assert_eq!(
        Measurement::from_bytes(&[]).map(|m| m.to_bytes()),
        Ok(vec![])
    );
}

#[portable_test]
fn ring_refuses_a_regular_mesh_and_says_what_is_missing() {
    let ring = |i: u32, j: u32| {
        let (u, v) = (
            f64::from(i) * 0.1 * std::f64::consts::PI,
            f64::from(j) * 0.2 * std::f64::consts::PI,
        );
        let r = 2.0 + libm::cos(v);
        DVec3::new(r * libm::cos(u), r * libm::sin(u), libm::sin(v))
    };
    let at = |i: u32, j: u32| i % 20 * 10 + j % 10;
    let torus = Mesh {
        positions: (0..200).map(|v| ring(v / 10, v % 10)).collect(),
        triangles: (0..200)
            .flat_map(|v| {
                let (i, j) = (v / 10, v % 10);
                [
                    [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                    [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
                ]
            })
            .collect(),
    };
    let host = Host {
        mesh: &torus,
        leeway: &strong(&torus),
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
    let error = Carrier::Ring.embed(&host, &mark, &mut ignore).unwrap_err();
    assert_eq!(error.code(), "carrier.too-few-addresses");
    let message = error.to_string();
    assert!(message.contains("its 200 vertices"), "{message}");
    assert!(message.contains("a mark needs 140"), "{message}");
}

/// Two copies of one mesh, one turned and larger, moved by one displacement.
#[portable_test]
fn ring_instances_move_as_one() {
    let one = shapes::torus_knot(50, 16);
    let num = one.positions.len() as u32;
    let map = DMat3::from_rotation_y(0.7) * 1.7;
    let mut both = one.clone();
    both.positions
        .extend(one.positions.iter().map(|p| map * *p + DVec3::X * 9.0));
    both.triangles
        .extend(one.triangles.iter().map(|t| t.map(|v| v + num)));
    let orbits = (0..num)
        .map(|v| Orbit {
            members: vec![(v, DMat3::IDENTITY), (v + num, map)],
        })
        .collect();
    let admissible = Admissible {
        orbits,
        fixed: vec![],
    };
    let displacement = marked(&both, &admissible);
    for v in 0..num as usize {
        assert!(displacement[v + num as usize].distance(map * displacement[v]) < 1e-12);
    }
    assert!(best(&displaced(&both, &displacement), 1) < -80.0);
}

#[portable_test]
fn ring_fixed_vertices_stay() {
    let asteroid = asteroid();
    let fixed: Vec<u32> = (0..400).collect();
    let displacement = marked(
        &asteroid,
        &Admissible {
            orbits: vec![],
            fixed,
        },
    );
    assert!(displacement[..400].iter().all(|d| *d == DVec3::ZERO));
    assert!(best(&displaced(&asteroid, &displacement), 1) < -100.0);
}

/// Rings that share an address would agree with each other, for everybody to see.
#[portable_test]
fn ring_leaves_no_trace() {
    let hosts = [
        ("asteroid", asteroid()),
        ("torus knot", shapes::torus_knot(120, 20)),
        ("terrain", shapes::terrain(60)),
    ];
    for (name, host) in hosts {
        let result = displaced(&host, &marked(&host, &Admissible::default()));
        let (before, after) = (trace(&host), trace(&result));
        assert!(after - before < 5.0, "{name}: {before:.1} to {after:.1}");
    }
}
