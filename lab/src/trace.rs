//! Copies that leak: who is named after an attack, and after several buyers mixed theirs.

use crate::models::Model;
use crate::seed::Seed;
use glam::DVec3;
use meshmark::internals::attack::{Step, chain, similarity, step};
use meshmark::internals::document::Document;
use meshmark::internals::geometry::{Distortion, diagonal};
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::Scene;
use meshmark::internals::{Beside, trace_all};
use meshmark::{
    EmbedOptions, Error, Files, Model as File, Plan, RecordOptions, Strength, Surface, prepare,
    record,
};
use rayon::prelude::*;
use std::fmt::Write;
use std::sync::Mutex;

/// Buyers in a ledger.
const LEDGERS: [u64; 3] = [10, 1000, 100_000];

/// Who mixes has a number among the first ten, so that all ledgers have it.
const FIRST: u64 = LEDGERS[0];

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

/// What is at hand beside the key and the ledger.
#[derive(Clone, Copy)]
enum With {
    Nothing,
    Original,
    Record,
}

impl With {
    const ALL: [With; 3] = [With::Nothing, With::Original, With::Record];
}

/// Who leaks what, and what it is read with.
struct Row {
    num: usize,
    mix: Mix,
    steps: Vec<Step>,
    with: With,
    /// Whether the suspect is turned, scaled and moved at random too.
    is_moved: bool,
}

/// What is read with the original and the record too.
const HARD: [(usize, Mix, &[&str]); 6] = [
    (
        1,
        Mix::One,
        &["crop 30 %", "simplify 50 %", "glTF quantize 10 bits"],
    ),
    (1, Mix::One, &["simplify 90 %"]),
    (2, Mix::Average, &["crop 50 %", "simplify 50 %"]),
    (
        2,
        Mix::Average,
        &["crop 30 %", "simplify 50 %", "glTF quantize 10 bits"],
    ),
    (3, Mix::Average, &["simplify 50 %"]),
    (5, Mix::Average, &[]),
];

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
    let known = |name: &&str| step(name).ok_or(format!("no attack {name}"));
    let mut add = |num, mix, name: &str| -> Result<(), String> {
        let names = Some(name).filter(|name| !name.is_empty());
        rows.push(Row {
            num,
            mix,
            steps: names.iter().map(known).collect::<Result<_, _>>()?,
            with: With::Nothing,
            is_moved: false,
        });
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
    for (num, mix, names) in HARD {
        for with in With::ALL {
            rows.push(Row {
                num,
                mix,
                steps: names.iter().map(known).collect::<Result<_, _>>()?,
                with,
                is_moved: true,
            });
        }
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
        let moved = if self.is_moved { ", moved" } else { "" };
        let with = match self.with {
            With::Nothing => "",
            With::Original => "; with the original",
            With::Record => "; with the record",
        };
        format!("{who}{mix}{}{moved}{with}", steps.concat())
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

/// A table with a line for each row, of the models that hold numbers. It takes hours, so what is known so far is told on the way.
pub fn table(
    models: &[Model],
    (name, strength): (&str, Strength),
    seed: &Seed,
) -> Result<String, String> {
    let rows = rows()?;
    let ledgers = LEDGERS.map(|buyers| (1..=buyers).collect::<Vec<u64>>());
    let header = format!(
        "Seed {}. Caught: at least one of who leaked / all of them.\n",
        seed.number
    );
    let found = Mutex::new(Vec::new());
    models.par_iter().for_each(|model| {
        let purpose = format!("trace, {name}, {}", model.name);
        let caught = of_model(model, strength, &rows, &ledgers, seed, &purpose);
        let mut found = found
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        found.push((model.name.clone(), caught));
        eprintln!("{}", strength_table(name, &rows, &found));
    });
    let found = found
        .into_inner()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    Ok(header + &strength_table(name, &rows, &found))
}

/// The table of a strength, of the models that are done; those that hold no number are named above it.
fn strength_table(name: &str, rows: &[Row], found: &[(String, Option<Vec<Caught>>)]) -> String {
    let names = |holds: bool| {
        let mut names: Vec<&str> = found
            .iter()
            .filter(|(_, caught)| caught.is_some() == holds)
            .map(|(name, _)| &**name)
            .collect();
        names.sort_unstable();
        match names.as_slice() {
            [] => "none".to_owned(),
            names => names.join(", "),
        }
    };
    let caught: Vec<&Vec<Caught>> = found
        .iter()
        .filter_map(|(_, caught)| caught.as_ref())
        .collect();
    let mut text = format!(
        "\n{name}: {} models: {}. Too small for a number: {}.\n\n\
         | | 10 buyers | 1 000 | 100 000 | innocents named | distance from the host, of one copy's |\n|---|--:|--:|--:|--:|--:|\n",
        caught.len(),
        names(true),
        names(false),
    );
    let (mut named, mut trials) = (0, 0);
    for (number, row) in rows.iter().enumerate() {
        let all = caught.iter().map(|rows| rows[number]);
        let sum = all.fold(Caught::default(), Caught::and);
        let cells = (0..LEDGERS.len()).map(|i| format!("{} / {}", sum.some[i], sum.all[i]));
        let cells: Vec<String> = cells.collect();
        named += sum.innocents;
        trials += sum.trials;
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.2} |",
            row.name(),
            cells.join(" | "),
            sum.innocents,
            sum.distance / sum.num_models.max(1) as f64
        );
    }
    let _ = writeln!(text, "\nInnocents: {named} named in {trials} trials.");
    text
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
    let (plan, specimen) = prepare(&model.bytes, &key, &options).ok()?;
    let record = record(&model.bytes, &specimen, &key, &RecordOptions::default()).ok()?;
    let first = seed.number(purpose, 1) % FIRST;
    let numbers: Vec<u64> = (0..5).map(|i| 1 + (first + 2 * i) % FIRST).collect();
    let copies = copies(&plan, &numbers).ok()?;
    let host = mesh(&model.bytes)?;
    let distance = |mesh: &Mesh| Distortion::between(&host.positions, &mesh.positions).rms_rel;
    let one = distance(&copies[0]);
    let attack_seed = seed.number(purpose, 2);
    let caught = rows.iter().map(|row| {
        let mixed = row.mixed(&copies);
        let attacked = chain(&mixed, &row.steps, attack_seed);
        let suspect = match row.is_moved {
            true => similarity(&attacked, attack_seed),
            false => attacked,
        };
        let mut caught = Caught {
            num_models: 1,
            distance: distance(&mixed) / one,
            ..Caught::default()
        };
        let guilty = &numbers[..row.num];
        let positions: Vec<[f64; 3]> = suspect.positions.iter().map(|p| p.to_array()).collect();
        let surface = Surface::new(&positions, &suspect.triangles);
        let beside = match row.with {
            With::Nothing => Beside::Nothing,
            With::Original => Beside::Original(File::new(&model.bytes)),
            With::Record => Beside::Record(&record),
        };
        // Nobody is named where the suspect cannot be read.
        let tracings = trace_all(surface.into(), beside, &key, ledgers).unwrap_or_default();
        for (place, tracing) in tracings.iter().enumerate() {
            let named = tracing.buyers.iter().map(|buyer| buyer.number);
            let (of_these, others): (Vec<u64>, _) =
                named.partition(|number| guilty.contains(number));
            caught.trials += tracing.num_buyers - row.num;
            caught.some[place] = usize::from(!of_these.is_empty());
            caught.all[place] = usize::from(of_these.len() == row.num);
            caught.innocents += others.len();
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
