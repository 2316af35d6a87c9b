//! How often a key that marked nothing is told that it did: docs/FALSE_POSITIVES.md.

use crate::case::Case;
use crate::models::{Class, Model};
use crate::seed::Seed;
use meshmark::attack::{noise, quantize, simplify, smooth};
use meshmark::carrier::{ring, solid};
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
/// One key in so many is tested with everything that a detector tries.
const SHARE_OF_ALL: u64 = 100;

/// The tail of ln p over `tests` tests, each with a key of its own, evenly over the evidence of both sorts.
pub fn table(models: &[Model], seed: &Seed, tests: u64) -> Result<String, String> {
    // Evenly from files and shapes, and some to take the place of those that cannot be marked.
    // Symmetric shapes cost a scan of seconds for each key, and test nothing else.
    let models: Vec<&Model> = models
        .iter()
        .filter(|model| model.class != Class::Symmetric)
        .collect();
    let count = (MODELS + SPARE).min(models.len());
    let chosen: Vec<&Model> = (0..count)
        .map(|number| models[number * models.len() / count])
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
    let num_unmarked = suspects.len() - marked.len();
    let mut text = format!(
        "# False positives\n\n\
         `cargo xtask lab --false-positives {tests}` wrote this. With `--seed {}` it runs again.\n\n\
         Keys that marked nothing, each tested once, evenly against the evidence of {} models. The bound p holds if no more \
         tests than their number times p get below it, but for chance.\n",
        seed.number,
        suspects.len()
    );
    for (title, tests, surfaces) in [
        ("The suspect as it is", tests, 1),
        (
            "With everything undone that may have been done to it",
            tests / SHARE_OF_ALL,
            usize::MAX,
        ),
    ] {
        let evidence: Vec<Evidence> = suspects
            .par_iter()
            .map(|(_, mesh)| Evidence {
                ring: ring::Measurement::new(mesh),
                solid: solid::Surfaces::new(mesh).take(surfaces).collect(),
            })
            .collect();
        let ln_ps = tail(&evidence, seed, title, tests);
        let _ = write!(text, "\n## {title}\n\n{tests} keys.\n\n");
        text.push_str(&document(&suspects, &ln_ps, num_unmarked, tests));
    }
    Ok(text)
}

/// For each piece of evidence, the ln p of the keys that were tested against it.
fn tail(evidence: &[Evidence], seed: &Seed, purpose: &str, tests: u64) -> Vec<Vec<f64>> {
    let mut ln_ps: Vec<Vec<f64>> = vec![Vec::new(); evidence.len()];
    let count = evidence.len() as u64;
    for first in (0..tests).step_by(BATCH as usize) {
        let batch: Vec<(usize, f64)> = (first..tests.min(first + BATCH))
            .into_par_iter()
            .map(|test| {
                let number = (test % count) as usize;
                let key = seed.key(purpose, test);
                (number, extract(&evidence[number], &key).ln_p)
            })
            .collect();
        for (number, ln_p) in batch {
            ln_ps[number].push(ln_p);
        }
        eprint!("\r{} of {tests}   ", tests.min(first + BATCH));
    }
    eprintln!();
    ln_ps
}

fn document(
    suspects: &[(String, Mesh)],
    ln_ps: &[Vec<f64>],
    num_unmarked: usize,
    tests: u64,
) -> String {
    let mut text = String::from(
        "| ln p below that of | bound | all | unmarked | marked by another key and attacked |\n|---|--:|--:|--:|--:|\n",
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
