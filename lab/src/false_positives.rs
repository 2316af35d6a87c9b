//! How often a key that marked nothing is told that it did: docs/FALSE_POSITIVES.md.

use crate::case::Case;
use crate::crafted;
use crate::models::Model;
use crate::plot::{Axis, curves};
use crate::seed::Seed;
use meshmark::internals::attack::{noise, quantize_evenly, simplify, smooth};
use meshmark::internals::carrier::{Measurement, ring, solid};
use meshmark::internals::mesh::Mesh;
use meshmark::{Evidence, Strength, extract};
use rayon::prelude::*;
use std::f64::consts::LN_10;
use std::fmt::Write;

/// A part of the table: whose evidence, what is measured of it, and how many of all keys are tested against that.
struct Part {
    title: &'static str,
    suspects: Suspects,
    surfaces: usize,
    /// One in so many.
    share: u64,
    /// Into how many rounds the keys are divided: after each the table is written, with what there is.
    rounds: u64,
}

/// Models that have axes of their own: one key costs some milliseconds.
const DISTINCT: [&str; 10] = [
    "teapot",
    "fandisk",
    "rocker-arm",
    "cheburashka",
    "stanford-bunny",
    "cow",
    "woody",
    "machined part",
    "rover",
    "seven shapes",
];

/// Models whose axes are near each other: all turns of the frame are tried, and where they are nearer, a scan of all angles, which
/// takes half a second.
const NEAR: [&str; 8] = [
    "suzanne",
    "chr_knight",
    "ShapeCollection",
    "torus knot",
    "terrain",
    "torus",
    "vase",
    "capsule",
];

enum Suspects {
    /// Each of these models unmarked, and marked and then attacked.
    Models(&'static [&'static str]),
    /// Those of [`crafted`].
    Crafted,
}

const PARTS: [Part; 4] = [
    Part {
        title: "The suspect as it is",
        suspects: Suspects::Models(&DISTINCT),
        surfaces: 1,
        share: 1,
        rounds: 50,
    },
    Part {
        title: "With everything undone that may have been done to it",
        suspects: Suspects::Models(&DISTINCT),
        surfaces: usize::MAX,
        share: 500,
        rounds: 1,
    },
    Part {
        title: "Frames whose axes are hard to tell apart",
        suspects: Suspects::Models(&NEAR),
        surfaces: 1,
        share: 2000,
        rounds: 1,
    },
    Part {
        title: "Suspects that were made to break the bound",
        suspects: Suspects::Crafted,
        surfaces: 1,
        share: 1,
        rounds: 1,
    },
];

const DECADES: u32 = 6;

/// The tail of ln p over tests with keys of their own, `tests` of them in the first part. `write` gets the table again and again,
/// each time with more of them,
/// and with the plot of the first part.
pub fn table(
    models: &[Model],
    seed: &Seed,
    tests: u64,
    write: &dyn Fn(&str, &str) -> Result<(), String>,
) -> Result<(), String> {
    let mut text = format!(
        "# False positives\n\n\
         `cargo xtask lab --false-positives {tests}` wrote this. With `--seed {}` it runs again.\n\n\
         Keys that marked nothing, each tested once, evenly against the evidence of unmarked models and of models that another key \
         marked and that were then attacked. The bound p holds if no more tests than their number times p get below it, but \
         for chance: *at most* is what independent tests whose bound is exact would exceed in one of a hundred tables.\n\n\
         ![share of keys below each bound](robustness/false-positives.svg)\n",
        seed.number
    );
    let mut plot = String::new();
    for part in PARTS {
        let (names, evidence): (Vec<String>, Vec<Evidence>) = match part.suspects {
            Suspects::Models(names) => measured(models, names, &part, seed)?,
            Suspects::Crafted => crafted::suspects(),
        }
        .into_iter()
        .unzip();
        let mut ln_ps: Vec<Vec<f64>> = vec![Vec::new(); evidence.len()];
        let each = (tests / part.share).div_ceil(evidence.len() as u64 * part.rounds);
        let mut section = String::new();
        for round in 0..part.rounds {
            for (number, evidence) in evidence.iter().enumerate() {
                let first = (number as u64 * part.rounds + round) * each;
                let found: Vec<f64> = (first..first + each)
                    .into_par_iter()
                    .map(|test| {
                        extract(evidence, &seed.key(part.title, test))
                            .details()
                            .ln_p
                    })
                    .collect();
                ln_ps[number].extend(found);
            }
            section = document(part.title, &names, &ln_ps);
            if part.rounds > 1 {
                plot = tail(&names, &ln_ps);
            }
            write(&format!("{text}{section}"), &plot)?;
            eprintln!("{}: {} of {}", part.title, round + 1, part.rounds);
        }
        text.push_str(&section);
    }
    Ok(())
}

/// What is measured of some models.
fn measured(
    models: &[Model],
    names: &[&str],
    part: &Part,
    seed: &Seed,
) -> Result<Vec<(String, Evidence)>, String> {
    let measure = |(name, mesh): (String, Mesh)| {
        let evidence = Evidence::from_iter([
            Measurement::Ring(ring::Measurement::new(&mesh)),
            Measurement::Solid(solid::Surfaces::new(&mesh).take(part.surfaces).collect()),
        ]);
        (name, evidence)
    };
    let suspects = suspects(models, names, seed)?;
    Ok(suspects.into_par_iter().map(measure).collect())
}

/// Each model unmarked, and marked and then attacked.
fn suspects(models: &[Model], names: &[&str], seed: &Seed) -> Result<Vec<(String, Mesh)>, String> {
    let cases: Vec<Case> = models
        .par_iter()
        .filter(|model| names.contains(&&*model.name))
        .map(|model| Case::new(model, ("strong", Strength::STRONG), 0, seed))
        .collect::<Result<_, _>>()?;
    let name = |case: &Case, what: &str| format!("{}, {what}", case.model.name);
    let unmarked = cases
        .iter()
        .map(|case| (name(case, "unmarked"), case.host.clone()));
    let marked = cases.iter().filter_map(|case| {
        let marked = case.marked.as_ref().ok()?;
        Some((case, &marked.mesh))
    });
    let attacked = marked.enumerate().map(|(number, (case, mesh))| {
        let (attack, mesh) = match number % 4 {
            0 => (
                "noise 0.1 %",
                noise(mesh, 0.001, seed.number(&case.purpose, 9)),
            ),
            1 => ("Laplacian 10", smooth(mesh, 0.1, 10)),
            2 => ("quantize 10 bits", quantize_evenly(mesh, 10)),
            _ => ("simplify 30 %", simplify(mesh, 0.3)),
        };
        (name(case, &format!("marked, {attack}")), mesh)
    });
    Ok(unmarked.chain(attacked).collect())
}

/// How many tests have a bound of that many decades or less, of those of unmarked models or of the others; and how many there are.
fn below(names: &[String], ln_ps: &[Vec<f64>], is_unmarked: bool, decade: u32) -> (usize, usize) {
    let limit = -f64::from(decade) * LN_10;
    let lists = names.iter().zip(ln_ps);
    let lists = lists.filter(|(name, _)| name.ends_with("unmarked") == is_unmarked);
    lists.fold((0, 0), |(below, all), (_, ln_ps)| {
        let here = ln_ps.iter().filter(|&&ln_p| ln_p <= limit).count();
        (below + here, all + ln_ps.len())
    })
}

/// The share of tests below each bound, by decades of both, for as long as there are any.
fn tail(names: &[String], ln_ps: &[Vec<f64>]) -> String {
    let of = |is_unmarked: bool| {
        (1..=DECADES)
            .map(|decade| (decade, below(names, ln_ps, is_unmarked, decade)))
            .take_while(|(_, (below, _))| *below > 0)
            .map(|(decade, (below, all))| {
                (f64::from(decade), libm::log10(all as f64 / below as f64))
            })
            .collect()
    };
    let far = f64::from(DECADES);
    let axis = |name, ends| Axis {
        name,
        ends,
        marks: (0..=DECADES)
            .map(|decade| (f64::from(decade), format!("1e-{decade}")))
            .collect(),
    };
    curves(
        "Keys that marked nothing",
        [
            &axis("the bound p", (0.0, far)),
            &axis("share of keys below it", (far, 0.0)),
        ],
        &[
            "the bound",
            "unmarked",
            "marked by another key and attacked",
        ],
        &[vec![(0.0, 0.0), (far, far)], of(true), of(false)],
    )
}

/// The same tail for any suspects: so many tests with keys of their own in all, evenly.
pub fn section(title: &str, suspects: Vec<(String, Evidence)>, seed: &Seed, tests: u64) -> String {
    let each = tests.div_ceil(suspects.len() as u64);
    let (names, evidence): (Vec<String>, Vec<Evidence>) = suspects.into_iter().unzip();
    let read = |(number, evidence): (u64, &Evidence)| {
        let tests = (number * each..(number + 1) * each).into_par_iter();
        let ln_p = |test| extract(evidence, &seed.key(title, test)).details().ln_p;
        tests.map(ln_p).collect()
    };
    let ln_ps: Vec<Vec<f64>> = (0..).zip(&evidence).map(read).collect();
    document(title, &names, &ln_ps)
}

/// The tail of ln p over the tests of some suspects.
pub fn document(title: &str, names: &[String], ln_ps: &[Vec<f64>]) -> String {
    let tests = ln_ps.iter().map(Vec::len).sum::<usize>();
    let mut text = format!(
        "\n## {}\n\n{tests} keys.\n\n\
         | ln p below that of | bound | at most | all | unmarked | marked by another key and attacked |\n\
         |---|--:|--:|--:|--:|--:|\n",
        title
    );
    for decade in 1..=DECADES {
        let bound = (0..decade).fold(tests as f64, |bound, _| bound / 10.0);
        let [u, m] = [true, false].map(|is_unmarked| below(names, ln_ps, is_unmarked, decade).0);
        let _ = writeln!(
            text,
            "| 1e-{decade} | {bound:.1} | {} | {} | {u} | {m} |",
            at_most(bound),
            u + m
        );
    }
    text.push_str("\n| evidence | tests | below 1e-2 | smallest ln p |\n|---|--:|--:|--:|\n");
    for (name, ln_ps) in names.iter().zip(ln_ps) {
        let least = ln_ps.iter().copied().fold(0.0, f64::min);
        let limit = -2.0 * LN_10;
        let below = ln_ps.iter().filter(|&&ln_p| ln_p <= limit).count();
        let _ = writeln!(text, "| {name} | {} | {below} | {least:.1} |", ln_ps.len());
    }
    text
}

/// What a Poisson variable of a mean, up to which a binomial one of small p is one, exceeds with a probability of 1 % at most.
fn at_most(mean: f64) -> u64 {
    /// Beyond so many standard deviations nothing counts.
    const FAR: f64 = 20.0;
    let (low, high) = (
        (mean - FAR * mean.sqrt()).max(0.0) as u64,
        (mean + FAR * (1.0 + mean.sqrt())) as u64,
    );
    let mode = mean as u64;
    // Relative to the likeliest, going away from it.
    let mut parts = vec![1.0; (high - low + 1) as usize];
    for k in (low..mode).rev() {
        parts[(k - low) as usize] = parts[(k + 1 - low) as usize] * (k + 1) as f64 / mean;
    }
    for k in mode + 1..=high {
        parts[(k - low) as usize] = parts[(k - 1 - low) as usize] * mean / k as f64;
    }
    let allowed = 0.01 * parts.iter().sum::<f64>();
    let mut above = 0.0;
    for k in (low..=high).rev() {
        above += parts[(k - low) as usize];
        if above > allowed {
            return k;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of the Poisson distribution.
    #[test]
    fn at_most_is_the_99th_percentile() {
        assert_eq!(
            [0.001, 0.1, 1.0, 10.0, 100.0].map(at_most),
            [0, 1, 4, 18, 124]
        );
    }
}
