//! Whether the forecast keeps its word on simplification: its colour for a share of the triangles, beside what other simplifiers leave of
//! the same mark at that share.

use crate::case::{Case, Marked};
use crate::informed::HALVING;
use crate::models::Model;
use crate::real::Tool;
use crate::seed::Seed;
use meshmark::internals::attack::step;
use meshmark::internals::scene::to_glb;
use meshmark::{Level, Strength, Verdict, detect};
use rayon::prelude::*;
use std::fmt::Write;

/// A row of the forecast.
struct Row {
    name: &'static str,
    /// This project's other simplifier, at the same share.
    own: &'static str,
    /// Whether a program, by what it is told, keeps that share.
    is_told: fn(&str) -> bool,
}

const ROWS: [Row; 2] = [
    Row {
        name: "simplify-50",
        own: "simplify Lindstrom-Turk 50 %",
        is_told: |words| {
            HALVING.contains(&words) || words == "fast_simplification target_reduction=0.5"
        },
    },
    Row {
        name: "simplify-70",
        own: "simplify Lindstrom-Turk 70 %",
        is_told: |words| words == "fast_simplification target_reduction=0.7",
    },
];

const LEVELS: [Level; 3] = [Level::Green, Level::Amber, Level::Red];

/// What became of a marked model.
struct Told {
    model: String,
    level: Level,
    /// What the forecast reached in its own try.
    ln_p: f64,
    /// By simplifier: whether the mark was found, if it did what it was told.
    is_found: Vec<Option<bool>>,
}

/// Marks each model at a strength under a key of its own, simplifies it in every way, and tells what was found by the forecast's colour.
pub fn table(
    models: &[Model],
    strength: (&'static str, Strength),
    seed: &Seed,
    tools: &[Tool],
) -> Result<String, String> {
    let cases = models.par_iter();
    let cases = cases.map(|model| Case::new(model, strength, 0, seed));
    let mut cases = cases.collect::<Result<Vec<_>, _>>()?;
    cases.retain(|case| case.marked.is_ok());
    let mut text = format!(
        "{}, seed {}: {} of {} models hold a mark.\n\n\
         | forecast | simplifier | green: found of | amber: found of | red: found of | lost, though green (ln p of the forecast) |\n\
         |---|---|--:|--:|--:|---|",
        strength.0,
        seed.number,
        cases.len(),
        models.len(),
    );
    for row in ROWS {
        let tools: Vec<&Tool> = tools.iter().filter(|t| (row.is_told)(&t.name)).collect();
        let told = cases.par_iter().map(|case| told(case, &row, &tools));
        let told: Vec<Told> = told.collect::<Result<_, String>>()?;
        let names = std::iter::once(row.own).chain(tools.iter().map(|tool| &*tool.name));
        for (place, name) in names.enumerate() {
            text += &line(row.name, name, &told, |told| told.is_found[place]);
        }
        let by_all = |told: &Told| Some(told.is_found.iter().flatten().all(|found| *found));
        text += &line(row.name, "each of these", &told, by_all);
    }
    Ok(text)
}

/// What was found of the models that one simplifier made smaller, by the forecast's colour.
fn line(
    row: &str,
    simplifier: &str,
    told: &[Told],
    is_found: impl Fn(&Told) -> Option<bool>,
) -> String {
    let mut text = format!("\n| {row} | {simplifier} |");
    for level in LEVELS {
        let of_level = told.iter().filter(|told| told.level == level);
        let made: Vec<bool> = of_level.filter_map(&is_found).collect();
        let num_found = made.iter().filter(|found| **found).count();
        let _ = write!(text, " {num_found} of {} |", made.len()); // strings take what is written
    }
    let lost = told
        .iter()
        .filter(|told| told.level == Level::Green && is_found(told) == Some(false));
    let lost: Vec<String> = lost
        .map(|told| format!("{} ({:.0})", told.model, told.ln_p))
        .collect();
    text + &format!(" {} |", lost.join(", "))
}

fn told(case: &Case, row: &Row, tools: &[&Tool]) -> Result<Told, String> {
    let marked = case.marked.as_ref().map_err(Clone::clone)?;
    let mut forecasts = marked.report.forecast.iter();
    let forecast = forecasts.find(|forecast| forecast.attack == row.name);
    let forecast = forecast.ok_or(row.name)?;
    let own = step(row.own).ok_or(row.own)?;
    let own = to_glb(&own.apply(&marked.mesh, case.seed.number(&case.purpose, 0)));
    let mut is_found = vec![Some(is_read(case, marked, &own)?)];
    for tool in tools {
        is_found.push(match tool.run(&marked.bytes) {
            Ok(suspect) => Some(is_read(case, marked, &suspect)?),
            Err(said) => {
                eprintln!("{}, {}: {said}", case.model.name, tool.name);
                None
            }
        });
    }
    eprintln!(
        "{}, {}: {:.0}, {is_found:?}",
        case.model.name, row.name, forecast.ln_p
    );
    Ok(Told {
        model: case.model.name.clone(),
        level: forecast.level,
        ln_p: forecast.ln_p,
        is_found,
    })
}

/// Whether a detector reads what was embedded.
fn is_read(case: &Case, marked: &Marked, suspect: &[u8]) -> Result<bool, String> {
    let read = detect(suspect, &case.key, None).map_err(|error| error.to_string())?;
    let is_mark = matches!(read.verdict, Verdict::Found | Verdict::Present);
    Ok(is_mark && read.number == marked.report.number)
}
