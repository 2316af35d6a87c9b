//! How far a mark moves a vertex: by its part and its triangles, whatever the scene around them is.

use crate::portable_test;
use crate::support::fixtures::{key, payload, strong};
use glam::{DMat3, DVec3};
use meshmark::internals::attack::noise;
use meshmark::internals::document::Document;
use meshmark::internals::geometry::{Bounds, Deformation, Leeway, Parts, cuts, diagonal};
use meshmark::internals::mesh::{Admissible, Mesh, Orbit, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{EmbedOptions, EmbedReport, Strength, embed, embed_note};

/// A large rock, and thirty small ones about it, each of few triangles: what a mark of the whole scene would bend.
fn scene() -> Mesh {
    let pebble = |number: u32| {
        let turn = 2.4 * f64::from(number);
        let place = DVec3::new(
            libm::cos(turn),
            libm::sin(turn),
            0.1 * f64::from(number) - 1.5,
        );
        let size = 0.01 + 0.001 * f64::from(number);
        let rock = shapes::asteroid(5, 7);
        let positions = rock.positions.iter().map(|p| *p * size + place * 1.8);
        rock.with_positions(positions.collect())
    };
    Mesh::joined(
        [shapes::asteroid(40, 60)]
            .into_iter()
            .chain((0..30).map(pebble)),
    )
}

/// The most that two vertices of a part left each other by, as a fraction of the part's diagonal; and the largest turn in degrees: of the
/// scene's parts, by the numbers of their vertices.
fn worst(before: &Mesh, after: &Mesh) -> (f64, f64) {
    let mut worst = (0.0f64, 0.0f64);
    let pebble = shapes::asteroid(5, 7).positions.len();
    let rock = before.positions.len() - 30 * pebble;
    let mut first = 0;
    for len in [rock].into_iter().chain([pebble; 30]) {
        let moves = (first..first + len).map(|v| after.positions[v] - before.positions[v]);
        let mean = moves.clone().sum::<DVec3>() / len as f64;
        let size = diagonal(&before.positions[first..first + len]);
        worst.0 = moves
            .map(|d| d.distance(mean) / size)
            .fold(worst.0, f64::max);
        first += len;
    }
    for &triangle in &before.triangles {
        let [a, b] = [before, after].map(|mesh| {
            let [a, b, c] = mesh.corners(triangle);
            (b - a).cross(c - a).normalize()
        });
        worst.1 = worst.1.max(a.angle_between(b).to_degrees());
    }
    worst
}

fn report(strength: Strength) -> (EmbedReport, (f64, f64)) {
    let host = to_glb(&scene());
    let options = EmbedOptions::default().with_strength(strength);
    let marked = embed(&host, payload(), &key(1), &options).unwrap();
    let [before, after] = [&host, &marked.model].map(|bytes| {
        let document = Document::read(bytes, &Default::default()).unwrap();
        Scene::gather(&document).unwrap().mesh
    });
    let seen = worst(&before, &after);
    (marked.report, seen)
}

#[portable_test]
fn leeway_small_parts_keep_their_shape_at_every_strength() {
    let number = Strength::new(0.0006).unwrap();
    for (strength, part, turn) in [
        (Strength::SUBTLE, 0.01, 10.0),
        (Strength::BALANCED, 0.01, 10.0),
        (Strength::STRONG, 0.02, 20.0),
        (number, 0.02, 20.0),
    ] {
        let (report, seen) = report(strength);
        assert!(seen.0 <= part && seen.1 <= turn, "{strength:?}: {seen:?}");
        assert!(report.worst_part_rel <= part && report.worst_turn_degrees <= turn);
        // Their mean is over corners, the report's too: both say about the same.
        assert!(report.worst_part_rel > 0.7 * seen.0, "{report:?}");
        assert!((report.worst_turn_degrees - seen.1).abs() < 0.1, "{seen:?}");
        assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    }
}

/// Who insists on more gets more, and is told what it does.
#[portable_test]
fn leeway_a_number_beyond_strong_warns() {
    let (report, seen) = report(Strength::new(0.01).unwrap());
    assert!(seen.0 > 0.02 && seen.1 < 90.0, "{seen:?}");
    assert!(!report.warnings.is_empty());
    let part = format!("{:.1} %", 100.0 * report.worst_part_rel);
    assert!(report.warnings[0].contains(&part), "{:?}", report.warnings);
}

/// A limit in scene units holds after rounding, and is what the report says.
#[portable_test]
fn leeway_keeps_to_a_largest_movement() {
    let rock = to_glb(&shapes::asteroid(40, 60));
    let most = |options: &EmbedOptions| embed(&rock, payload(), &key(1), options).unwrap().report;
    let options = EmbedOptions::default().with_strength(Strength::STRONG);
    let free = most(&options);
    let (reach, diagonal) = (0.5 * free.max_movement, free.diagonal);
    assert!((free.max_movement - free.max_rel * diagonal).abs() < 1e-12);
    let held = most(&options.with_max_movement(reach));
    assert!(
        held.max_movement <= reach && held.max_movement > 0.9 * reach,
        "{held:?}"
    );
}

#[portable_test]
fn leeway_holds_for_notes() {
    let host = to_glb(&Mesh::joined([scene(), shapes::asteroid(60, 80)]));
    let report = embed_note(&host, "small parts", &key(1)).unwrap().report;
    assert!(report.worst_part_rel > 0.0 && report.worst_part_rel <= 0.02);
    assert!(report.worst_turn_degrees > 0.0 && report.worst_turn_degrees <= 20.0);
}

/// Whatever is asked for, nothing turns over, no displacement becomes longer, and instances still move as one.
#[portable_test]
fn leeway_keeps_any_displacement_within_its_bounds() {
    let mesh = shapes::low_poly();
    let parts = Parts::new(&mesh);
    let far = noise(&mesh, 0.2, 3);
    let asked: Vec<DVec3> = far
        .positions
        .iter()
        .zip(&mesh.positions)
        .map(|(b, a)| *b - *a)
        .collect();
    let map = DMat3::from_diagonal(DVec3::new(-2.0, 1.0, 1.0));
    let admissible = Admissible {
        orbits: vec![Orbit {
            members: vec![(0, DMat3::IDENTITY), (7, map)],
        }],
        fixed: Vec::new(),
    };
    for bounds in [Bounds::HIDDEN, Bounds::STRONG, Bounds::STRONG.times(20.0)] {
        let leeway = Leeway::new(&mesh, &parts, bounds);
        let mut kept = asked.clone();
        admissible.project(&mut kept);
        let before = kept.clone();
        leeway.keep(&mesh.positions, &mut kept, &admissible);
        let after: Vec<DVec3> = mesh
            .positions
            .iter()
            .zip(&kept)
            .map(|(p, d)| *p + *d)
            .collect();
        let seen = Deformation::between(&mesh, &parts, &after);
        assert!(seen.worst_part <= 2.0 * bounds.part, "{seen:?}");
        assert!(seen.worst_turn <= bounds.turn.min(90.0), "{seen:?}");
        assert_eq!(seen.num_turned_over, 0);
        assert!(leeway.beyond(&after).is_empty());
        assert!(
            kept.iter()
                .zip(&before)
                .all(|(a, b)| a.length() <= b.length())
        );
        assert!(kept[7].distance(map * kept[0]) < 1e-12);
        assert!(kept.iter().any(|d| *d != DVec3::ZERO));
    }
}

/// What would go too far is named, so that it can be left where it was.
#[portable_test]
fn leeway_names_what_is_beyond() {
    let mesh = shapes::low_poly();
    let mut after = mesh.positions.clone();
    assert!(strong(&mesh).beyond(&after).is_empty());
    after[5] += DVec3::X * 0.05 * diagonal(&mesh.positions);
    assert!(strong(&mesh).beyond(&after).contains(&5));
}

/// A plate of two sheets that hang together at their rim, so many diagonals apart.
fn plate(thickness: f64) -> Mesh {
    shapes::cuboid(DVec3::new(1.0, 1.0, thickness), [12, 12, 1])
}

/// A sheet that is pushed through the other one of its part cuts it, along the way and not at its neighbours; one that lay upon it did before.
#[portable_test]
fn cuts_are_where_a_surface_goes_through_itself() {
    let num_cuts = |mesh: &Mesh, depth: f64| {
        let middle = |p: &DVec3| p.x.abs() < 0.1 && p.y.abs() < 0.1 && p.z > 0.0;
        let pushed = |p: &DVec3| if middle(p) { *p - DVec3::Z * depth } else { *p };
        let after: Vec<DVec3> = mesh.positions.iter().map(pushed).collect();
        assert_ne!(after, mesh.positions);
        cuts(mesh, &Parts::new(mesh), &after).len()
    };
    let thin = plate(0.01);
    assert_eq!(num_cuts(&thin, 0.009), 0);
    assert!(num_cuts(&thin, 0.02) > 3);
    // The parts of a scene may touch, and move into each other.
    let two = Mesh::joined([thin.clone(), moved(&thin, DVec3::Z * 0.0101)]);
    let mut after = two.positions.clone();
    for position in &mut after[..thin.positions.len()] {
        position.z += 0.001;
    }
    assert!(cuts(&two, &Parts::new(&two), &after).is_empty());
}

fn moved(mesh: &Mesh, by: DVec3) -> Mesh {
    mesh.with_positions(mesh.positions.iter().map(|p| *p + by).collect())
}

/// Whatever the strength: noise as strong makes these models cut themselves, the mark does not.
#[portable_test]
fn cuts_are_none_that_a_mark_makes() {
    let thin = shapes::asteroid(40, 60);
    let flat = thin
        .positions
        .iter()
        .map(|p| *p * DVec3::new(1.0, 1.0, 0.02));
    for (name, mesh) in [
        ("a thin disc", thin.with_positions(flat.collect())),
        ("a machined part", shapes::cad_part()),
    ] {
        let shaken = noise(&mesh, 0.01, 3).positions;
        assert!(
            !cuts(&mesh, &Parts::new(&mesh), &shaken).is_empty(),
            "{name}"
        );
        for strength in [Strength::STRONG, Strength::new(0.004).unwrap()] {
            let options = EmbedOptions::default().with_strength(strength);
            let marked = embed(&to_glb(&mesh), payload(), &key(1), &options).unwrap();
            let [host, after] = [&to_glb(&mesh), &marked.model].map(|bytes| {
                let document = Document::read(bytes, &Default::default()).unwrap();
                Scene::gather(&document).unwrap().mesh
            });
            let seen = cuts(&host, &Parts::new(&host), &after.positions).len();
            assert_eq!((seen, marked.report.new_intersections), (0, 0), "{name}");
        }
    }
}
