//! Scenes of several objects: what is one, and that a mark is found in what was taken out of a scene or put into one.

use crate::portable_test;
use crate::support::fixtures::{cuboid, key, payload, strong};
use crate::support::gltf_builder::{Component, GltfBuilder, Layout, Packing, primitive};
use glam::{DMat3, DQuat, DVec3};
use meshmark::internals::attack::{similarity, simplify};
use meshmark::internals::carrier::solid::{Measurement, Surfaces};
use meshmark::internals::carrier::{Host, Mark};
use meshmark::internals::code::{Checked, Codeword};
use meshmark::internals::document::Document;
use meshmark::internals::geometry::Pieces;
use meshmark::internals::mesh::{Admissible, Mesh, Orbit, shapes};
use meshmark::internals::progress::ignore;
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{Carrier, EmbedOptions, Extraction, Strength, Verdict, detect, embed};

fn moved(mesh: &Mesh, size: f64, by: DVec3) -> Mesh {
    mesh.with_positions(mesh.positions.iter().map(|p| *p * size + by).collect())
}

/// Two triangles.
fn floor(height: f64) -> Mesh {
    let corner = |x: f64, y: f64| DVec3::new(5.0 * x, 5.0 * y, height);
    Mesh {
        positions: vec![
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

/// A figure of two parts that touch, and a stone beside it.
fn figure_and_stone() -> Mesh {
    let body = shapes::asteroid(24, 36);
    let hat = moved(&shapes::asteroid(12, 18), 0.3, DVec3::Z * 1.05);
    let stone = moved(&shapes::asteroid(10, 14), 0.4, DVec3::new(3.0, 0.5, -0.5));
    Mesh::joined([body, hat, stone])
}

fn sizes(pieces: &[Vec<[u32; 3]>]) -> Vec<usize> {
    pieces.iter().map(Vec::len).collect()
}

#[portable_test]
fn pieces_are_what_touches_and_its_patches() {
    let [body, hat, stone] =
        [(24, 36), (12, 18), (10, 14)].map(|(a, b)| shapes::asteroid(a, b).triangles.len());
    let scene = figure_and_stone();
    let turned = DQuat::from_scaled_axis(DVec3::new(0.3, 1.1, -0.4));
    let positions = scene.positions.iter().map(|p| turned * *p * 7.0);
    let with_floor = Mesh::joined([scene.clone(), floor(-1.0)]);
    for (name, scene) in [
        ("as it is", scene.clone()),
        ("turned", scene.with_positions(positions.collect())),
        ("on a floor", with_floor),
    ] {
        let pieces = Pieces::of(&scene);
        assert_eq!(sizes(&pieces.objects), [body + hat, stone], "{name}");
        assert_eq!(sizes(&pieces.patches), [body, hat], "{name}");
        assert_eq!(
            sizes(&Pieces::stable_objects(&scene)),
            [body + hat, stone],
            "{name}"
        );
    }
}

/// What is one object is read as a whole: nothing is charged for pieces.
#[portable_test]
fn pieces_of_one_object_are_none() {
    let pieces = Pieces::of(&shapes::asteroid(24, 36));
    assert_eq!(pieces.in_order().count(), 0);
}

/// Objects that touch only just are not told apart for certain.
#[portable_test]
fn pieces_that_hardly_touch_are_not_stable() {
    let rock = shapes::asteroid(24, 36);
    let diagonal = meshmark::internals::geometry::diagonal(&rock.positions);
    let width = rock.positions.iter().map(|p| p.x).fold(0.0, f64::max)
        - rock.positions.iter().map(|p| p.x).fold(0.0, f64::min);
    let beside = |gap: f64| {
        Mesh::joined([
            rock.clone(),
            moved(&rock, 1.0, DVec3::X * (width + gap * diagonal)),
        ])
    };
    let num_stable = |gap| Pieces::stable_objects(&beside(gap)).len();
    assert_eq!(
        [num_stable(0.5), num_stable(-0.5)],
        [2, 0],
        "far apart; one in the other"
    );
    let gaps = (0..40).map(|step| 0.005 * f64::from(step) - 0.1);
    let unsure =
        gaps.filter(|&gap| !Pieces::of(&beside(gap)).objects.is_empty() && num_stable(gap) == 0);
    assert!(unsure.count() > 0, "the limit was not met");
}

fn marked(mesh: &Mesh) -> Mesh {
    let options = EmbedOptions::default().with_strength(Strength::STRONG);
    let marked = embed(&to_glb(mesh), payload(), &key(1), &options).unwrap();
    Scene::gather(&Document::read(&marked.model, &Default::default()).unwrap())
        .unwrap()
        .mesh
}

/// SOLID's piece, where SOLID found the payload.
fn found(suspect: &Mesh) -> Option<Option<usize>> {
    let found: Extraction = detect(&to_glb(suspect), &key(1), None).unwrap();
    let carriers = found.details().carriers.iter();
    let mut solid = carriers.filter(|reading| reading.name == Carrier::Solid);
    let solid = solid.find(|reading| reading.number == Some(payload().number()))?;
    (found.verdict == Verdict::Found).then_some(solid.piece)
}

/// A model beside, in, on and under what is not its owner's, then simplified to half: RING is gone, and the frame of all is another.
#[portable_test]
fn pieces_hold_the_mark_of_a_model_among_others() {
    let model = marked(&shapes::asteroid(40, 60));
    let inside = moved(&shapes::cad_part(), 0.25, DVec3::new(0.1, 0.0, 0.05));
    let beside = moved(&shapes::torus_knot(60, 12), 0.7, DVec3::new(1.5, 2.5, 0.3));
    let room = moved(&cuboid(DVec3::splat(2.0)), 4.0, DVec3::splat(-4.0));
    for (name, other) in [
        ("a floor", floor(-1.1)),
        ("a hidden part", inside),
        ("a second model", beside),
        ("a room", room),
    ] {
        let suspect = simplify(&Mesh::joined([model.clone(), other]), 0.5);
        assert_eq!(found(&similarity(&suspect, 5)), Some(Some(1)), "{name}");
    }
}

/// A model of several parts among which something was hidden, and beside which something stands: their boxes touch, so that all is one
/// object, and the model is what is left of it.
#[portable_test]
fn pieces_hold_the_mark_of_a_model_of_parts_with_another_in_it() {
    let body = shapes::asteroid(40, 60);
    let hat = moved(&shapes::asteroid(24, 36), 0.4, DVec3::Z * 1.05);
    let model = marked(&Mesh::joined([body, hat]));
    let hidden = moved(&shapes::cad_part(), 0.25, DVec3::new(0.1, 0.0, 0.05));
    let near = moved(&shapes::torus_knot(60, 12), 0.5, DVec3::X * 1.7);
    for (name, other) in [("hidden", hidden), ("near", near)] {
        let suspect = Mesh::joined([model.clone(), other]);
        assert!(Pieces::of(&suspect).objects.is_empty(), "{name}: parted");
        let found = found(&similarity(&simplify(&suspect, 0.5), 5));
        assert!(found.is_some_and(|piece| piece.is_some()), "{name}");
    }
}

/// A found piece is called what its node is, or the node above it.
#[portable_test]
fn pieces_that_are_found_are_named() {
    let rock = marked(&shapes::asteroid(40, 60));
    let room = moved(&cuboid(DVec3::splat(2.0)), 4.0, DVec3::splat(-4.0));
    let mut builder = GltfBuilder::new(Packing::Glb);
    for mesh in [&room, &simplify(&rock, 0.5)] {
        let points: Vec<[f64; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
        let position = builder.positions(0, Layout::F32, &points);
        let indices = builder.indices(0, Component::U32, &mesh.triangles.concat());
        builder.mesh(&[primitive(position, Some(indices), 4)]);
    }
    builder.node(r#"{"mesh":0,"name":"room"}"#);
    builder.node(r#"{"children":[2],"name":"rock"}"#);
    builder.node(r#"{"mesh":1,"name":""}"#);
    let answer = detect(&builder.build().bytes, &key(1), None).unwrap();
    let place = answer.found_in.unwrap();
    assert_eq!((place.name.as_deref(), place.parts), (Some("rock"), 1));
    assert_eq!(place.of_parts, 2);
}

/// Each object of a scene has the mark, and keeps it when it is taken out.
#[portable_test]
fn pieces_hold_the_mark_of_their_scene() {
    let rock = shapes::asteroid(36, 54);
    let pebble = rock
        .positions
        .iter()
        .map(|p| *p * DVec3::new(0.4, 0.6, 0.5) + DVec3::X * 5.0);
    let objects = [
        shapes::asteroid(40, 60),
        rock.with_positions(pebble.collect()),
    ];
    let scene = marked(&Mesh::joined(objects));
    assert_eq!(found(&similarity(&scene, 6)), Some(Some(1)));
    for object in Pieces::of(&scene).objects {
        let alone = simplify(&scene.part(object), 0.5);
        assert_eq!(found(&similarity(&alone, 7)), Some(None));
    }
}

/// What RING does to an object follows the object's size, as what SOLID did: a pebble far from a rock keeps SOLID.
#[portable_test]
fn pieces_that_are_small_keep_their_mark_beneath_ring() {
    let pebble = moved(&shapes::asteroid(36, 54), 0.06, DVec3::X * 4.0);
    let scene = marked(&Mesh::joined([shapes::asteroid(40, 60), pebble]));
    let objects = Pieces::of(&scene).objects;
    assert_eq!(objects.len(), 2);
    for object in objects {
        assert_eq!(found(&similarity(&scene.part(object), 8)), Some(None));
    }
}

/// An object and its instance, far apart, are marked once and move as one.
#[portable_test]
fn pieces_that_are_instances_share_their_mark() {
    let rock = shapes::asteroid(40, 60);
    let num = rock.positions.len() as u32;
    let mesh = Mesh::joined([rock.clone(), moved(&rock, 1.0, DVec3::X * 5.0)]);
    let members = |vertex| vec![(vertex, DMat3::IDENTITY), (vertex + num, DMat3::IDENTITY)];
    let orbits = (0..num).map(|vertex| Orbit {
        members: members(vertex),
    });
    let host = Host {
        mesh: &mesh,
        leeway: &strong(&mesh),
        admissible: &Admissible {
            orbits: orbits.collect(),
            fixed: vec![],
        },
        rms_rel: Strength::STRONG.rms_rel(),
        hidden: false,
        share: 1.0,
        on_top: None,
    };
    let message = Checked::new(&key(1)).message(payload());
    let mark = Mark {
        key: &key(1),
        codeword: &Codeword::new(message),
    };
    let embedded = Carrier::Solid.embed(&host, &mark, &mut ignore);
    let displacement = embedded.unwrap().displacement;
    let (first, second) = displacement.split_at(num as usize);
    assert!(first == second && first.iter().any(|d| *d != DVec3::ZERO));
    let displaced = mesh
        .positions
        .iter()
        .zip(&displacement)
        .map(|(p, d)| *p + *d);
    let displaced = mesh.with_positions(displaced.collect());
    for object in Pieces::of(&displaced).objects {
        assert_eq!(found(&displaced.part(object)), Some(None));
    }
}

/// Objects so far apart that the whole is read at no pitch: evidence says so too, and pieces keep their numbers.
#[portable_test]
fn pieces_keep_their_numbers_where_the_whole_is_not_read() {
    let rock = shapes::asteroid(24, 36);
    let far = |number: u32| moved(&rock, 1.0, DVec3::X * 60.0 * f64::from(number));
    let scene = marked(&Mesh::joined((0..3).map(far)));
    assert!(Surfaces::new(&scene).is_empty(), "the whole is read");
    assert_eq!(found(&scene), Some(Some(1)));
    let measured = Measurement::new(&scene);
    let stored = Measurement::from_bytes(&measured.to_bytes()).unwrap();
    assert_eq!(stored, measured);
    let reading = stored.read(&key(1), &mut ignore).unwrap();
    assert!(reading.hypotheses.iter().all(|way| way.piece == 1));
}
