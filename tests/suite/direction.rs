//! The DIRECTION carrier: what notes are in.

use crate::portable_test;
use crate::support::fixtures::key;
use glam::DVec3;
use meshmark::internals::attack::{catmull_clark, noise, reorder, similarity, simplify};
use meshmark::internals::carrier::direction::{Cells, NUM_TESTS};
use meshmark::internals::code::Block;
use meshmark::internals::detection::{LN_P_FOUND, union};
use meshmark::internals::mesh::{Mesh, shapes};

const MESSAGE: [u8; 8] = *b"Bata Vas";

/// An ellipsoid with bumps: a frame whose axes differ, and distances that do.
fn pebble() -> Mesh {
    let mesh = shapes::asteroid(80, 160);
    let stretch = DVec3::new(1.0, 0.8, 0.6);
    mesh.with_positions(mesh.positions.iter().map(|&p| p * stretch).collect())
}

const STEP: f64 = 0.012;

fn in_cells(mesh: &Mesh, owner: u8, message: &[u8]) -> Mesh {
    let cells = Cells::new(&key(owner), Block::Tc128, STEP);
    let moved = cells.embed(mesh, message).unwrap();
    let positions = mesh.positions.iter().zip(moved).map(|(p, d)| *p + d);
    mesh.with_positions(positions.collect())
}

#[portable_test]
fn cells_are_read_blind() {
    let mesh = pebble();
    let marked = in_cells(&mesh, 1, &MESSAGE);
    let cells = Cells::new(&key(1), Block::Tc128, STEP);
    for (name, suspect) in [
        ("none", marked.clone()),
        ("noise", noise(&marked, 0.001, 1)),
        ("meshsmooth", catmull_clark(&marked, 1)),
        ("simplify", simplify(&marked, 0.3)),
    ] {
        let suspect = similarity(&reorder(&suspect, 3), 4);
        let readings = cells.read(&suspect);
        let right = readings
            .iter()
            .find(|reading| reading.decoded.message == MESSAGE);
        let right = right.unwrap_or_else(|| panic!("{name}"));
        assert!(right.decoded.is_codeword);
        let word = Block::Tc128.encode(&MESSAGE);
        let charge = libm::log(f64::from(NUM_TESTS)) + 64.0 * std::f64::consts::LN_2;
        let ln_p = union(right.statistic(&word).ln_p(), charge);
        assert!(ln_p < LN_P_FOUND, "{name}: {ln_p}");
    }
}

#[portable_test]
fn cells_say_nothing_to_another_key() {
    let marked = in_cells(&pebble(), 1, &MESSAGE);
    let word = Block::Tc128.encode(&MESSAGE);
    for stranger in 2..6 {
        let readings = Cells::new(&key(stranger), Block::Tc128, STEP).read(&marked);
        assert!(!readings.is_empty());
        for reading in readings {
            assert_ne!(reading.decoded.message, MESSAGE);
            assert!(reading.statistic(&word).ln_p() > -20.0);
        }
    }
}

#[portable_test]
fn cells_of_nothing() {
    let cells = Cells::new(&key(1), Block::Tc128, STEP);
    assert!(cells.read(&Mesh::default()).is_empty());
    let error = cells.embed(&Mesh::default(), &MESSAGE).unwrap_err();
    assert_eq!(error.code(), "carrier.too-few-hosts");
}
