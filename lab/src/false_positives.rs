//! How often a key that marked nothing is told that it did: docs/FALSE_POSITIVES.md.

use crate::case::Case;
use crate::models::Model;
use crate::seed::Seed;
use meshmark::attack::{noise, quantize, simplify, smooth};
use meshmark::mesh::Mesh;
use meshmark::{Evidence, Strength, extract};
use rayon::prelude::*;
use std::fmt::Write;

/// Models of each sort: unmarked, and marked and then attacked.
const MODELS: usize = 10;
const SPARE: usize = 3;
/// Keys between two lines of progress.
const BATCH: u64 = 1000;
const DECADES: u32 = 6;

/// The tail of ln p over `tests` tests, each with a key of its own, evenly over the evidence of both sorts.
pub fn table(models: &[Model], seed: &Seed, tests: u64) -> Result<String, String> {
    // Evenly from files and shapes, and some to take the place of those that cannot be marked.
    let count = (MODELS + SPARE).min(models.len());
    let chosen: Vec<&Model> = (0..count)
        .map(|number| &models[number * models.len() / count])
        .collect();
    let cases: Vec<Case> = chosen
        .into_par_iter()
        .map(|model| Case::new(model, ("strong", Strength::STRONG), seed))
        .collect::<Result<_, _>>()?;
    let marked: Vec<(&Case, &Mesh)> = cases
        .iter()
        .filter_map(|case| Some((case, &case.marked.as_ref().ok()?.mesh)))
        .take(MODELS)
        .collect();
    let mut suspects: Vec<(String, Mesh)> = cases
        .iter()
        .take(MODELS)
        .map(|case| (format!("{}, unmarked", case.model.name), case.host.clone()))
        .collect();
    suspects.extend(marked.iter().enumerate().map(|(number, (case, mesh))| {
        let (attack, mesh) = match number % 4 {
            0 => (
                "noise 0.1 %",
                noise(mesh, 0.001, seed.number(&case.purpose, 9)),
            ),
            1 => ("Laplacian 10", smooth(mesh, 0.1, 10)),
            2 => ("quantize 10 bits", quantize(mesh, 10)),
            _ => ("simplify 30 %", simplify(mesh, 0.3)),
        };
        (format!("{}, marked, {attack}", case.model.name), mesh)
    }));
    let evidence: Vec<Evidence> = suspects
        .par_iter()
        .map(|(_, mesh)| Evidence::measure(mesh))
        .collect();

    let mut ln_ps: Vec<Vec<f64>> = vec![Vec::new(); evidence.len()];
    let count = evidence.len() as u64;
    for first in (0..tests).step_by(BATCH as usize) {
        let batch: Vec<(usize, f64)> = (first..tests.min(first + BATCH))
            .into_par_iter()
            .map(|test| {
                let number = (test % count) as usize;
                (
                    number,
                    extract(&evidence[number], &seed.key("false positives", test)).ln_p,
                )
            })
            .collect();
        for (number, ln_p) in batch {
            ln_ps[number].push(ln_p);
        }
        eprint!("\r{} of {tests}   ", tests.min(first + BATCH));
    }
    eprintln!();
    let num_unmarked = suspects.len() - marked.len();
    Ok(document(&suspects, &ln_ps, num_unmarked, seed, tests))
}

fn document(
    suspects: &[(String, Mesh)],
    ln_ps: &[Vec<f64>],
    num_unmarked: usize,
    seed: &Seed,
    tests: u64,
) -> String {
    let mut text = format!(
        "# False positives\n\n\
         `cargo xtask lab --false-positives {tests}` wrote this. With `--seed {}` it runs again.\n\n\
         {tests} keys that marked nothing, each tested once, evenly against the evidence of the {} models below. The bound p holds \
         if no more tests than their number times p get below it, but for chance.\n\n\
         | ln p below that of | bound | all | unmarked | marked by another key and attacked |\n|---|--:|--:|--:|--:|\n",
        seed.number,
        suspects.len()
    );
    let (unmarked, marked) = ln_ps.split_at(num_unmarked);
    for decade in 1..=DECADES {
        let limit = -f64::from(decade) * std::f64::consts::LN_10;
        let bound = (0..decade).fold(tests as f64, |bound, _| bound / 10.0);
        let below = |lists: &[Vec<f64>]| {
            lists
                .iter()
                .flatten()
                .filter(|&&ln_p| ln_p <= limit)
                .count()
        };
        let (u, m) = (below(unmarked), below(marked));
        let _ = writeln!(text, "| 1e-{decade} | {bound:.1} | {} | {u} | {m} |", u + m);
    }
    text.push_str("\n| evidence | tests | smallest ln p |\n|---|--:|--:|\n");
    for ((name, _), ln_ps) in suspects.iter().zip(ln_ps) {
        let least = ln_ps.iter().copied().fold(0.0, f64::min);
        let _ = writeln!(text, "| {name} | {} | {least:.1} |", ln_ps.len());
    }
    text
}
