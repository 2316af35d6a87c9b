//! Floors of robustness: for every step of the attacks' catalogue, and for some chains, how far below the bound a mark on small
//! generated meshes has to be. `floors.txt` has a line a cell: mesh, attack, and the largest ln p that passes, or `lost` where
//! nothing is promised and nothing is tried. A floor may be raised freely; lowering one needs a line in the changelog.
//! A sample of the cells is tried with every commit, all others by `cargo xtask test --all`.
//!
//! Natively only: the golden marks hold wasm to the same bytes.
#![cfg(not(target_arch = "wasm32"))]

use crate::support::fixtures::{key, marked, payload};
use meshmark::internals::attack::{CATALOGUE, Step, chain, step};
use meshmark::internals::document::Document;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{Verdict, extract, measure};
use std::sync::Mutex;

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

type Shape = fn() -> Mesh;

const MESHES: [(&str, Shape); 4] = [
    ("asteroid", || shapes::asteroid(40, 60)),
    ("torus knot", || shapes::torus_knot(160, 24)),
    ("terrain", || shapes::terrain(60)),
    ("creature", shapes::low_poly),
];

/// A marked mesh, and what is done to it.
struct Cell<'a> {
    mesh: &'a Marked,
    steps: Vec<Step>,
    /// Whether it is tried with every commit.
    is_sample: bool,
}

struct Marked {
    name: &'static str,
    mesh: Mesh,
}

fn marked_meshes() -> Vec<Marked> {
    let mark = |(name, shape): (_, Shape)| {
        let model = marked(&to_glb(&shape()), &key(1)).unwrap().model;
        let document = Document::read(&model, &Default::default()).unwrap();
        let mesh = Scene::gather(&document).unwrap().mesh;
        Marked { name, mesh }
    };
    MESHES.map(mark).into()
}

/// Every attack on every mesh.
///
/// The sample: each chain and each attack on one mesh, the meshes taking turns, at the strongest level that
/// has a floor there. An attack that has no floor on the mesh whose turn it is goes to the next that has.
fn cells(meshes: &[Marked]) -> Vec<Cell<'_>> {
    let mut cells = Vec::new();
    for (place, mesh) in meshes.iter().enumerate() {
        for (turn, names) in CHAINS.iter().enumerate() {
            cells.push(Cell {
                mesh,
                steps: names.iter().map(|name| step(name).unwrap()).collect(),
                is_sample: turn == place,
            });
        }
    }
    for (turn, attack) in CATALOGUE.iter().enumerate() {
        let first = cells.len();
        for place in 0..meshes.len() {
            let mesh = &meshes[(turn + place) % meshes.len()];
            // The strongest level first.
            let steps: Vec<Step> = attack.steps().collect();
            cells.extend(steps.into_iter().rev().map(|step| Cell {
                mesh,
                steps: vec![step],
                is_sample: false,
            }));
        }
        let mut new = cells[first..].iter_mut();
        if let Some(sample) = new.find(|cell| cell.floor() != Some(None)) {
            sample.is_sample = true;
        }
    }
    cells
}

impl Cell<'_> {
    fn attack(&self) -> String {
        match &*self.steps {
            [] => "none".to_owned(),
            steps => (steps.iter().map(Step::to_string).collect::<Vec<_>>()).join(", "),
        }
    }

    fn floor(&self) -> Option<Option<f64>> {
        floor(self.mesh.name, &self.attack())
    }

    /// What is wrong: the cell is above its floor, or has no line.
    fn failure(&self) -> Option<String> {
        let (name, attack) = (self.mesh.name, self.attack());
        if self.floor() == Some(None) {
            return None;
        }
        let suspect = to_glb(&chain(&self.mesh.mesh, &self.steps, 11));
        let evidence = measure(&suspect).unwrap();
        let answer = extract(&evidence, &key(1));
        let is_read = answer.verdict == Verdict::Found && answer.number == Some(payload().number());
        let seen = if is_read {
            format!("ln p {:.0}", answer.details().ln_p)
        } else {
            "not read".to_owned()
        };
        match self.floor().flatten() {
            None => Some(format!("{name} | {attack} has no line; {seen}")),
            Some(floor) if !is_read || answer.details().ln_p > floor => {
                Some(format!("{name} | {attack}: {seen}, the floor is {floor}"))
            }
            _ => None,
        }
    }
}

/// Tries cells on all cores; fails with the name of each that is wrong.
fn hold(cells: Vec<Cell>) {
    let num_threads = std::thread::available_parallelism().map_or(1, usize::from);
    let cells = Mutex::new(cells.into_iter());
    let failures = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..num_threads {
            scope.spawn(|| {
                loop {
                    let Some(cell) = cells.lock().unwrap().next() else {
                        break;
                    };
                    failures.lock().unwrap().extend(cell.failure());
                }
            });
        }
    });
    let failures = failures.into_inner().unwrap();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn floors_of_a_sample() {
    let meshes = marked_meshes();
    let mut cells = cells(&meshes);
    cells.retain(|cell| cell.is_sample);
    hold(cells);
}

#[test]
#[ignore = "takes minutes: cargo xtask test --all"]
fn floors_of_all_other_cells() {
    let meshes = marked_meshes();
    let mut cells = cells(&meshes);
    cells.retain(|cell| !cell.is_sample);
    hold(cells);
}

/// A line that no test reads would promise nothing.
#[test]
fn every_floor_is_of_a_cell() {
    let mut cells: Vec<&str> = Vec::new();
    for line in FLOORS.lines() {
        let [mesh, attack, floor] = line.split(" | ").collect::<Vec<_>>()[..] else {
            panic!("{line}");
        };
        assert!(MESHES.iter().any(|(name, _)| *name == mesh), "{line}");
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
