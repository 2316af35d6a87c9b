//! Copies that leak: who is named after an attack, and after several buyers mixed theirs.

use crate::models::{Class, Model, Size};
use crate::seed::Seed;
use glam::DVec3;
use meshmark::internals::attack::{Step, chain, step};
use meshmark::internals::document::Document;
use meshmark::internals::geometry::{Distortion, diagonal};
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::Scene;
use meshmark::{EmbedOptions, Error, Files, Key, Plan, Strength, Surface, prepare, trace};
use rayon::prelude::*;
use std::fmt::Write;

/// Buyers in a ledger.
const LEDGERS: [u64; 3] = [10, 1000, 100_000];

/// Who mixes has a number among the first ten, so that all ledgers have it.
const FIRST: u64 = LEDGERS[0];

/// The strengths that are tried.
const STRENGTHS: [(&str, Strength); 2] = [
    ("balanced", Strength::BALANCED),
    ("strong", Strength::STRONG),
];

/// How several copies become one.
#[derive(Clone, Copy)]
enum Mix {
    /// One copy, as it is.
    One,
    /// The mean of all.
    Average,
    /// Vertices of each in turn.
    Vertices,
    /// What lies on each side of a plane through the middle, of two; of more, in slices.
    Parts,
    /// Of each coordinate the least or the largest, by turns.
    Extremes,
}

/// Who leaks what.
struct Row {
    num: usize,
    mix: Mix,
    steps: Vec<Step>,
}

fn rows() -> Result<Vec<Row>, String> {
    const ALONE: [&str; 9] = [
        "",
        "noise 0.1 %",
        "quantize 11 bits",
        "Laplacian 10",
        "simplify 50 %",
        "simplify 70 %",
        "crop 30 %",
        "isotropic remeshing 1 %",
        "triangle soup",
    ];
    let mut rows = Vec::new();
    let mut add = |num, mix, name: &str| -> Result<(), String> {
        let steps = match name {
            "" => Vec::new(),
            name => vec![step(name).ok_or(format!("no attack {name}"))?],
        };
        rows.push(Row { num, mix, steps });
        Ok(())
    };
    for name in ALONE {
        add(1, Mix::One, name)?;
    }
    for num in [2, 3, 5] {
        for mix in [Mix::Average, Mix::Vertices, Mix::Parts, Mix::Extremes] {
            add(num, mix, "")?;
        }
        add(num, Mix::Average, "simplify 50 %")?;
    }
    Ok(rows)
}

impl Row {
    fn name(&self) -> String {
        let who = match self.num {
            1 => "one leaks",
            2 => "two",
            3 => "three",
            _ => "five",
        };
        let mix = match self.mix {
            Mix::One => "",
            Mix::Average => " average",
            Mix::Vertices => " take vertices in turn",
            Mix::Parts => " take parts in turn",
            Mix::Extremes => " take minima and maxima",
        };
        let steps: Vec<String> = self.steps.iter().map(|step| format!(", {step}")).collect();
        format!("{who}{mix}{}", steps.concat())
    }

    fn mixed(&self, copies: &[Mesh]) -> Mesh {
        let copies = &copies[..self.num];
        let first = &copies[0];
        let centre = first.positions.iter().sum::<DVec3>() / first.positions.len() as f64;
        let size = diagonal(&first.positions);
        let place = |vertex: usize| -> DVec3 {
            let all = || copies.iter().map(|copy| copy.positions[vertex]);
            match self.mix {
                Mix::One | Mix::Average => all().sum::<DVec3>() / copies.len() as f64,
                Mix::Vertices => copies[vertex % copies.len()].positions[vertex],
                Mix::Parts => {
                    let across = (first.positions[vertex].x - centre.x) / size + 0.5;
                    let slice = (across * copies.len() as f64) as usize;
                    copies[slice.min(copies.len() - 1)].positions[vertex]
                }
                Mix::Extremes => match vertex % 2 {
                    0 => all().fold(DVec3::INFINITY, DVec3::min),
                    _ => all().fold(DVec3::NEG_INFINITY, DVec3::max),
                },
            }
        };
        first.with_positions((0..first.positions.len()).map(place).collect())
    }
}

/// What one row of one model gave, for each ledger.
#[derive(Clone, Copy, Default)]
struct Caught {
    some: [usize; LEDGERS.len()],
    all: [usize; LEDGERS.len()],
    innocents: usize,
    /// Buyers who had no part in it and were asked for.
    trials: usize,
    num_models: usize,
    /// RMS distance from the host, as a multiple of one copy's.
    distance: f64,
}

impl Caught {
    fn and(self, other: Caught) -> Caught {
        let sum = |a: [usize; 3], b: [usize; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        Caught {
            some: sum(self.some, other.some),
            all: sum(self.all, other.all),
            innocents: self.innocents + other.innocents,
            trials: self.trials + other.trials,
            num_models: self.num_models + other.num_models,
            distance: self.distance + other.distance,
        }
    }
}

/// A table with a line for each row, of the usual plain models that hold numbers. A reading of the others scans for axes or looks at many
/// pieces, which takes seconds, and there are some thousand readings. What is known so far is told on the way.
pub fn table(mut models: Vec<Model>, seed: &Seed) -> Result<String, String> {
    models.retain(|model| model.size <= Size::Usual && model.class == Class::Plain);
    let rows = rows()?;
    let ledgers = LEDGERS.map(|buyers| (1..=buyers).collect::<Vec<u64>>());
    let mut text = format!(
        "Seed {}. Caught: at least one of who leaked / all of them.\n",
        seed.number
    );
    let mut num_trials = 0;
    let mut num_named = 0;
    for (name, strength) in STRENGTHS {
        let found: Vec<(String, Option<Vec<Caught>>)> = models
            .par_iter()
            .map(|model| {
                let purpose = format!("trace, {name}, {}", model.name);
                let caught = of_model(model, strength, &rows, &ledgers, seed, &purpose);
                eprintln!("{name}: {} is done", model.name);
                (model.name.clone(), caught)
            })
            .collect();
        let without = found.iter().filter(|(_, caught)| caught.is_none());
        let without: Vec<&str> = without.map(|(name, _)| &**name).collect();
        let caught: Vec<&Vec<Caught>> = found
            .iter()
            .filter_map(|(_, caught)| caught.as_ref())
            .collect();
        let _ = writeln!(
            text,
            "\n{name}: {} models; too small for a number: {}\n\n| | 10 buyers | 1 000 | 100 000 | innocents named | distance from the host, of one copy's |\n|---|--:|--:|--:|--:|--:|",
            caught.len(),
            if without.is_empty() {
                "none".to_owned()
            } else {
                without.join(", ")
            },
        );
        for (number, row) in rows.iter().enumerate() {
            let all = caught.iter().map(|rows| rows[number]);
            let sum = all.fold(Caught::default(), Caught::and);
            let cells = (0..LEDGERS.len()).map(|i| format!("{} / {}", sum.some[i], sum.all[i]));
            let cells: Vec<String> = cells.collect();
            let innocents = sum.innocents;
            num_named += innocents;
            num_trials += sum.trials;
            let _ = writeln!(
                text,
                "| {} | {} | {innocents} | {:.2} |",
                row.name(),
                cells.join(" | "),
                sum.distance / sum.num_models.max(1) as f64
            );
        }
        eprintln!("{text}");
    }
    let _ = write!(
        text,
        "\nInnocents: {num_named} named in {num_trials} trials."
    );
    Ok(text)
}

/// `None` where the model holds no number.
fn of_model(
    model: &Model,
    strength: Strength,
    rows: &[Row],
    ledgers: &[Vec<u64>],
    seed: &Seed,
    purpose: &str,
) -> Option<Vec<Caught>> {
    let key = seed.key(purpose, 0);
    let options = EmbedOptions::default().with_strength(strength);
    let (plan, _) = prepare(&model.bytes, &key, &options).ok()?;
    let first = seed.number(purpose, 1) % FIRST;
    let numbers: Vec<u64> = (0..5).map(|i| 1 + (first + 2 * i) % FIRST).collect();
    let copies = copies(&plan, &numbers).ok()?;
    let host = mesh(&model.bytes)?;
    let distance = |mesh: &Mesh| Distortion::between(&host.positions, &mesh.positions).rms_rel;
    let one = distance(&copies[0]);
    let caught = rows.iter().map(|row| {
        let mixed = row.mixed(&copies);
        let suspect = chain(&mixed, &row.steps, seed.number(purpose, 2));
        let mut caught = Caught {
            num_models: 1,
            distance: distance(&mixed) / one,
            ..Caught::default()
        };
        let guilty = &numbers[..row.num];
        let mut is_settled = false;
        for (place, ledger) in ledgers.iter().enumerate().rev() {
            // Who is named among many is named among few: their bound is charged less.
            if is_settled {
                caught.some[place] = 1;
                caught.all[place] = 1;
                continue;
            }
            let named = named(&suspect, &key, ledger);
            caught.trials += ledger.len() - row.num;
            let num_caught = named
                .iter()
                .filter(|number| guilty.contains(number))
                .count();
            caught.some[place] = usize::from(num_caught > 0);
            caught.all[place] = usize::from(num_caught == row.num);
            caught.innocents += named.len() - num_caught;
            is_settled = num_caught == row.num;
        }
        caught
    });
    Some(caught.collect())
}

fn copies(plan: &Plan, numbers: &[u64]) -> Result<Vec<Mesh>, Error> {
    let stamped = numbers.iter().map(|&number| plan.stamp(number));
    let meshes = stamped.map(|copy| copy.map(|copy| mesh(&copy.model).unwrap_or_default()));
    meshes.collect()
}

fn mesh(model: &[u8]) -> Option<Mesh> {
    let document = Document::read(model, &Files::new()).ok()?;
    Some(Scene::gather(&document).ok()?.mesh)
}

/// Nobody where the suspect cannot be read.
fn named(suspect: &Mesh, key: &Key, ledger: &[u64]) -> Vec<u64> {
    let positions: Vec<[f64; 3]> = suspect.positions.iter().map(|p| p.to_array()).collect();
    let surface = Surface::new(&positions, &suspect.triangles);
    let tracing = trace(surface, key, ledger);
    let buyers = tracing.map(|tracing| tracing.buyers).unwrap_or_default();
    buyers.into_iter().map(|buyer| buyer.number).collect()
}
