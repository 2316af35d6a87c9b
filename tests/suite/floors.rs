//! Floors of robustness: for every step of the attacks' catalogue, and for some chains, how far below the bound a mark on small
//! generated meshes has to be. `floors.txt` has a line a cell: mesh, attack, and the largest ln p that passes, or `lost` where
//! nothing is promised and nothing is tried. A floor may be raised freely; lowering one needs a line in the changelog.
//!
//! Natively only: the golden marks hold wasm to the same bytes.
#![cfg(not(target_arch = "wasm32"))]

use crate::support::fixtures::{key, marked, payload};
use meshmark::internals::attack::{CATALOGUE, Step, chain, step};
use meshmark::internals::document::Document;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{Verdict, extract, measure};

const FLOORS: &str = include_str!("floors.txt");

const CHAINS: [&[&str]; 4] = [
    &[],
    &[
        "crop 30 %",
        "similarity",
        "reorder",
        "glTF quantize 14 bits",
    ],
    &["simplify 50 %", "glTF quantize 12 bits"],
    &["noise 0.1 %", "similarity", "Laplacian 10"],
];

/// A cell's floor: `None` where nothing is promised.
fn floor(mesh: &str, attack: &str) -> Option<Option<f64>> {
    let line = FLOORS.lines().find_map(|line| {
        let (cell, floor) = line.rsplit_once(" | ")?;
        (cell == format!("{mesh} | {attack}")).then_some(floor)
    })?;
    Some((line != "lost").then(|| line.parse().unwrap()))
}

/// Every attack on a mesh; fails with the name of each cell that is above its floor, or has no line.
fn hold(name: &str, mesh: &Mesh) {
    let model = marked(&to_glb(mesh), &key(1)).unwrap().model;
    let document = Document::read(&model, &Default::default()).unwrap();
    let marked = Scene::gather(&document).unwrap().mesh;
    let single = CATALOGUE
        .iter()
        .flat_map(|attack| attack.steps().map(|step| vec![step]));
    let chains = CHAINS.map(|names| names.iter().map(|name| step(name).unwrap()).collect());
    let failures: Vec<String> = chains
        .into_iter()
        .chain(single)
        .filter_map(|steps: Vec<Step>| {
            let attack = match &*steps {
                [] => "none".to_owned(),
                steps => (steps.iter().map(Step::to_string).collect::<Vec<_>>()).join(", "),
            };
            let floor = floor(name, &attack);
            if floor == Some(None) {
                return None;
            }
            let suspect = to_glb(&chain(&marked, &steps, 11));
            let evidence = measure(&suspect).unwrap();
            let answer = extract(&evidence, &key(1));
            let is_read =
                answer.verdict == Verdict::Found && answer.number == Some(payload().number());
            let seen = if is_read {
                format!("ln p {:.0}", answer.details().ln_p)
            } else {
                "not read".to_owned()
            };
            match floor.flatten() {
                None => Some(format!("{name} | {attack} has no line; {seen}")),
                Some(floor) if !is_read || answer.details().ln_p > floor => {
                    Some(format!("{name} | {attack}: {seen}, the floor is {floor}"))
                }
                _ => None,
            }
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn floors_of_an_asteroid() {
    hold("asteroid", &shapes::asteroid(40, 60));
}

#[test]
fn floors_of_a_torus_knot() {
    hold("torus knot", &shapes::torus_knot(160, 24));
}

#[test]
fn floors_of_a_terrain() {
    hold("terrain", &shapes::terrain(60));
}

#[test]
fn floors_of_a_low_poly_creature() {
    hold("creature", &shapes::low_poly());
}

/// A line that no test reads would promise nothing.
#[test]
fn every_floor_is_of_a_cell() {
    let mut cells: Vec<&str> = Vec::new();
    for line in FLOORS.lines() {
        let [mesh, attack, floor] = line.split(" | ").collect::<Vec<_>>()[..] else {
            panic!("{line}");
        };
        assert!(
            ["asteroid", "torus knot", "terrain", "creature"].contains(&mesh),
            "{line}"
        );
        let known = |attack: &str| step(attack).is_some_and(|step| step.to_string() == attack);
        assert!(attack == "none" || attack.split(", ").all(known), "{line}");
        assert!(
            floor == "lost" || floor.parse::<f64>().is_ok_and(|floor| floor < 0.0),
            "{line}"
        );
        assert!(
            !cells.contains(&&line[..line.len() - floor.len()]),
            "twice: {line}"
        );
        cells.push(&line[..line.len() - floor.len()]);
    }
}
