//! The same surface written otherwise, and with more beside it that is not seen: triangles that are there twice, fins, shells, strays.

use crate::portable_test;
use crate::support::fixtures::{key, payload};
use glam::DVec3;
use meshmark::internals::attack::{
    ball_within, both_sides, bridged_hull, copies, hull, midpoint, needles, reorder, similarity,
    simplify, stray,
};
use meshmark::internals::document::Document;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{Carrier, EmbedOptions, Embedding, Strength, Verdict, detect, embed, inspect};

fn gathered(mesh: &Mesh) -> Scene {
    Scene::gather(&Document::read(&to_glb(mesh), &Default::default()).unwrap()).unwrap()
}

fn marked(mesh: &Mesh, carriers: &[Carrier]) -> Embedding {
    let options = EmbedOptions::default()
        .with_strength(Strength::STRONG)
        .with_carriers(carriers.iter().copied());
    embed(&to_glb(mesh), payload(), &key(1), &options).unwrap()
}

fn mesh_of(embedding: &Embedding) -> Mesh {
    let document = Document::read(&embedding.model, &Default::default()).unwrap();
    Scene::gather(&document).unwrap().mesh
}

fn assert_found(suspect: &Mesh, name: &str) {
    let found = detect(&to_glb(&similarity(suspect, 5)), &key(1), None).unwrap();
    let is_right = found.verdict == Verdict::Found && found.number == Some(payload().number());
    assert!(is_right, "{name}: {:?}", found.details());
}

/// The triangles by where their corners are, whatever they are called.
fn places(mesh: &Mesh) -> Vec<[[u64; 3]; 3]> {
    let place = |&triangle: &[u32; 3]| {
        let mut corners = mesh
            .corners(triangle)
            .map(|p| p.to_array().map(f64::to_bits));
        let least = (0..3).min_by_key(|&i| corners[i]).unwrap();
        corners.rotate_left(least);
        corners
    };
    let mut places: Vec<_> = mesh.triangles.iter().map(place).collect();
    places.sort_unstable();
    places
}

/// Whatever the order and the directions in the file, what is there twice is there once, and faces as it did, or outwards.
#[portable_test]
fn layers_of_one_surface_are_one() {
    for (name, mesh) in [
        ("closed", shapes::asteroid(20, 30)),
        ("a sheet", shapes::leaf(16, 20)),
    ] {
        let once = places(&gathered(&mesh).mesh);
        let twice = both_sides(&mesh);
        let backwards = Mesh {
            triangles: twice.triangles.iter().rev().copied().collect(),
            ..twice.clone()
        };
        let some = copies(&mesh, 0.5, 2, 0.0, 3);
        for suspect in [twice, backwards, some] {
            assert_eq!(places(&gathered(&suspect).mesh), once, "{name}");
        }
    }
}

/// Of each attack on how triangles are written: what is found without it is found with it, in each carrier alone.
#[portable_test]
fn layers_hide_no_carrier() {
    for carrier in Carrier::STANDARD {
        let model = mesh_of(&marked(&shapes::asteroid(40, 60), &[carrier]));
        for (name, suspect) in [
            ("both sides", both_sides(&model)),
            ("both sides, reordered", reorder(&both_sides(&model), 2)),
            ("copies of 5 %", copies(&model, 0.05, 1, 0.0, 1)),
            ("each three times", copies(&model, 1.0, 2, 0.0, 1)),
            ("needles", needles(&model, 1.0, 1)),
        ] {
            assert_found(&suspect, &format!("{name}, {}", carrier.name()));
        }
    }
}

/// What SOLID alone can hold, for triangles or neighbourhoods are others.
#[portable_test]
fn layers_leave_the_shape_readable() {
    let model = mesh_of(&marked(&shapes::asteroid(40, 60), &[Carrier::Solid]));
    let split = Mesh::joined([model.clone(), both_sides(&midpoint(&model))]);
    for (name, suspect) in [
        ("copies 1e-5 away", copies(&model, 1.0, 1, 1e-5, 1)),
        (
            "copied, halved",
            simplify(&copies(&model, 0.5, 1, 0.0, 1), 0.5),
        ),
        (
            "split and copied",
            copies(&midpoint(&model), 1.0, 1, 0.0, 1),
        ),
        ("beside its split", split),
        ("an outline", simplify(&hull(&model, 0.005), 0.5)),
        ("hollowed", simplify(&hull(&model, -0.02), 0.5)),
        (
            "a shell on a bridge",
            simplify(&bridged_hull(&model, 0.005), 0.5),
        ),
        ("hollowed, on a bridge", bridged_hull(&model, -0.02)),
        ("a ball within", simplify(&ball_within(&model, 0.05), 0.5)),
        ("a stray", simplify(&stray(&model, 100.0), 0.5)),
    ] {
        assert_found(&suspect, name);
    }
}

/// A model whose surface is there twice is marked as the same model that is there once, in both carriers.
#[portable_test]
fn layers_of_a_host_move_together() {
    let rock = shapes::asteroid(40, 60);
    let one = marked(&rock, &Carrier::STANDARD);
    let two = marked(&both_sides(&rock), &Carrier::STANDARD);
    assert_eq!(mesh_of(&two), mesh_of(&one));
    let copied = marked(&copies(&rock, 1.0, 1, 0.0, 4), &Carrier::STANDARD);
    let document = Document::read(&copied.model, &Default::default()).unwrap();
    let placed = document.positions(0).unwrap();
    let (own, copy) = placed.split_at(rock.positions.len());
    let mut copy: Vec<_> = copy.to_vec();
    let mut own: Vec<_> = own.to_vec();
    let bits = |p: &[f64; 3]| p.map(f64::to_bits);
    own.sort_by_key(bits);
    copy.sort_by_key(bits);
    assert_eq!(own, copy);
}

/// A speck far away says nothing of how large the model is; it stays, and is named.
#[portable_test]
fn layers_do_not_count_strays() {
    let rock = shapes::asteroid(40, 60);
    let alone = marked(&rock, &Carrier::STANDARD);
    for away in [3.0, 10.0, 100.0] {
        let strewn = stray(&rock, away);
        assert_eq!(gathered(&strewn).strays.len(), 1, "{away}");
        let marked = marked(&strewn, &Carrier::STANDARD);
        assert_eq!(marked.report.rms_rel, alone.report.rms_rel);
        assert_eq!(marked.report.diagonal, alone.report.diagonal);
        assert!(
            marked.report.warnings.len() == 1,
            "{:?}",
            marked.report.warnings
        );
        assert_eq!(inspect(&to_glb(&strewn)).unwrap().warnings.len(), 1);
        let before = Document::read(&to_glb(&strewn), &Default::default()).unwrap();
        let after = Document::read(&marked.model, &Default::default()).unwrap();
        let specks = [before, after]
            .map(|document| document.positions(0).unwrap()[rock.positions.len()..].to_vec());
        assert_eq!(specks[0], specks[1]);
        assert_eq!(mesh_of(&marked), mesh_of(&alone));
    }
    // What stands near, is large, or is many, is part of a scene.
    for scene in [
        stray(&rock, 0.9),
        Mesh::joined([
            rock.clone(),
            shapes::cuboid(DVec3::ONE, [3, 3, 3]).with_positions(
                shapes::cuboid(DVec3::ONE, [3, 3, 3])
                    .positions
                    .iter()
                    .map(|p| *p + DVec3::X * 50.0)
                    .collect(),
            ),
        ]),
    ] {
        assert!(gathered(&scene).strays.is_empty());
    }
    assert!(inspect(&to_glb(&rock)).unwrap().warnings.is_empty());
}
