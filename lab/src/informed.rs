//! What the original, or the record of an embedding, adds to a reading: one table, of the attacks that blind reading is weakest in.

use crate::case::Case;
use crate::models::Model;
use crate::seed::Seed;
use glam::DVec3;
use meshmark::internals::attack::{chain, crop, remesh, similarity, simplify, step};
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::to_glb;
use meshmark::{
    Comparison, RecordOptions, Shape, Strength, Verdict, compare, compare_with_record, detect,
    record,
};
use rayon::prelude::*;
use std::time::Instant;

/// Length of a side after remeshing, as a fraction of the diagonal.
const REMESHED: f64 = 0.01;

type Make = fn(&Case, &Mesh, u64) -> Result<Mesh, String>;

/// The rows: what is done to the marked mesh.
const ROWS: [(&str, Make); 16] = [
    ("none", |_, marked, _| Ok(marked.clone())),
    (
        "crop 30 %, simplify 50 %, glTF quantize 10 bits",
        |_, marked, seed| {
            by_name(
                marked,
                &["crop 30 %", "simplify 50 %", "glTF quantize 10 bits"],
                seed,
            )
        },
    ),
    ("crop 50 %, isotropic remeshing 1 %", |_, marked, seed| {
        Ok(remesh(&crop(marked, 0.5, seed), REMESHED))
    }),
    ("crop 70 %", |_, marked, seed| Ok(crop(marked, 0.7, seed))),
    ("crop 90 %", |_, marked, seed| Ok(crop(marked, 0.9, seed))),
    ("mirrored, isotropic remeshing 1 %", |_, marked, _| {
        Ok(remesh(&mirrored(marked), REMESHED))
    }),
    ("scaled by 1.5, 1 and 0.7, simplify 50 %", |_, marked, _| {
        let scaled = marked.positions.iter();
        let scaled = scaled.map(|p| *p * DVec3::new(1.5, 1.0, 0.7)).collect();
        Ok(simplify(&marked.with_positions(scaled), 0.5))
    }),
    ("simplify 90 %", |_, marked, seed| {
        by_name(marked, &["simplify 90 %"], seed)
    }),
    ("simplify 95 %", |_, marked, seed| {
        by_name(marked, &["simplify 95 %"], seed)
    }),
    ("Laplacian 50", |_, marked, seed| {
        by_name(marked, &["Laplacian 50"], seed)
    }),
    (
        "isotropic remeshing 1 %, Laplacian 10",
        |_, marked, seed| by_name(&remesh(marked, REMESHED), &["Laplacian 10"], seed),
    ),
    ("noise 0.5 %", |_, marked, seed| {
        by_name(marked, &["noise 0.5 %"], seed)
    }),
    ("quantize 7 bits", |_, marked, seed| {
        by_name(marked, &["quantize 7 bits"], seed)
    }),
    ("resampled distance 0.8 %", |_, marked, seed| {
        by_name(marked, &["resampled distance 0.8 %"], seed)
    }),
    ("unmarked", |case, _, _| Ok(case.host.clone())),
    ("wrong key", |case, _, _| case.by_another(1)),
];

fn by_name(mesh: &Mesh, names: &[&str], seed: u64) -> Result<Mesh, String> {
    let named = |name: &&str| step(name).ok_or_else(|| format!("there is no attack {name}"));
    let steps = names.iter().map(named).collect::<Result<Vec<_>, _>>()?;
    Ok(chain(mesh, &steps, seed))
}

fn mirrored(mesh: &Mesh) -> Mesh {
    let turned = mesh.positions.iter().map(|p| DVec3::new(-p.x, p.y, p.z));
    let mut mirrored = mesh.with_positions(turned.collect());
    mirrored.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mirrored
}

/// What one reading said.
struct Said {
    /// Found with the payload that was embedded, or present of a mark without one.
    is_right: bool,
    /// Found or present, whatever was read.
    is_mark: bool,
    is_same_shape: bool,
    ln_p: f64,
    seconds: f64,
}

impl Said {
    fn of(comparison: &Comparison, number: Option<u64>, start: Instant) -> Said {
        Said {
            is_same_shape: comparison.shape == Shape::Same,
            ..Said::new(
                comparison.verdict,
                comparison.number,
                number,
                comparison.ln_p(),
                start,
            )
        }
    }

    fn new(
        verdict: Verdict,
        read: Option<u64>,
        number: Option<u64>,
        ln_p: f64,
        start: Instant,
    ) -> Said {
        let is_mark = matches!(verdict, Verdict::Found | Verdict::Present);
        Said {
            is_right: is_mark && read == number,
            is_mark,
            is_same_shape: true,
            ln_p,
            seconds: start.elapsed().as_secs_f64(),
        }
    }
}

/// Blind, with the original, with the record.
type Cell = [Said; 3];

/// Prints the table, row after row: each model once at a strength, under keys of its own.
pub fn table(
    models: &[Model],
    (name, strength): (&'static str, Strength),
    seed: &Seed,
) -> Result<String, String> {
    let cases = models.par_iter();
    let cases = cases.map(|model| Case::new(model, (name, strength), 0, seed));
    let mut cases = cases.collect::<Result<Vec<_>, _>>()?;
    cases.retain(|case| case.marked.is_ok());
    let names: Vec<&str> = cases.iter().map(|case| &*case.model.name).collect();
    println!(
        "{name}, seed {}, {} models: {}\n\n\
         | attack | blind | with the original | with the record | ln p, median: blind | original | record | s, median: original | record | not found with the original |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|---|",
        seed.number,
        names.len(),
        names.join(", "),
    );
    for row in &ROWS {
        let cells = cases.par_iter().map(|case| cells_of(case, row));
        let cells = cells.collect::<Result<Vec<Cell>, _>>()?;
        println!("{}", line(row.0, &names, &cells));
    }
    Ok(String::new())
}

fn line(row: &str, names: &[&str], cells: &[Cell]) -> String {
    let found = |by: usize| cells.iter().filter(|cell| cell[by].is_right).count();
    let median = |by: usize, of: fn(&Said) -> f64| {
        let mut values: Vec<f64> = cells.iter().map(|cell| of(&cell[by])).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let missed: Vec<String> = names
        .iter()
        .zip(cells)
        .filter(|(_, cell)| !cell[1].is_right)
        .map(
            |(name, cell)| match (cell[1].is_mark, cell[1].is_same_shape) {
                (true, _) => format!("{name} (p)"),
                (_, false) => format!("{name} (another shape)"),
                _ => (*name).to_owned(),
            },
        )
        .collect();
    format!(
        "| {row} | {} | {} | {} | {:.0} | {:.0} | {:.0} | {:.1} | {:.1} | {} |",
        found(0),
        found(1),
        found(2),
        median(0, |said| said.ln_p),
        median(1, |said| said.ln_p),
        median(2, |said| said.ln_p),
        median(1, |said| said.seconds),
        median(2, |said| said.seconds),
        missed.join(", "),
    )
}

fn cells_of(case: &Case, (name, make): &(&str, Make)) -> Result<Cell, String> {
    let marked = case.marked.as_ref().map_err(Clone::clone)?;
    let purpose = format!("{}, {name}", case.purpose);
    let suspect = make(case, &marked.mesh, case.seed.number(&purpose, 0))?;
    let suspect = to_glb(&similarity(&suspect, case.seed.number(&purpose, 1)));
    let said = |error: meshmark::Error| format!("{}, {name}: {error}", case.model.name);
    let number = marked.report.number;
    let start = Instant::now();
    let read = detect(&suspect, &case.key, None).map_err(said)?;
    let ln_p = read.details().ln_p;
    let blind = Said::new(read.verdict, read.number, number, ln_p, start);
    let start = Instant::now();
    let informed = compare(&suspect, &case.model.bytes, &case.key).map_err(said)?;
    let informed = Said::of(&informed, number, start);
    let options = RecordOptions::default();
    let kept = record(&case.model.bytes, &marked.report, &case.key, &options).map_err(said)?;
    let start = Instant::now();
    let recorded = compare_with_record(&suspect, &kept, &case.key).map_err(said)?;
    Ok([blind, informed, Said::of(&recorded, number, start)])
}
