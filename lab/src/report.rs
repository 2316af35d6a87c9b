//! docs/ROBUSTNESS.md.

use crate::grid::{Kind, Row};
use crate::measure::{Cell, Outcome};
use crate::models::Class;
use crate::seed::Seed;
use meshmark::Carrier;
use std::fmt::Write;

/// The bound that a row counts.
const LN_BOUND: f64 = -20.723_265_836_946_41; // ln 1e-9

/// The whole document.
pub fn table(
    rows: &[Row],
    outcomes: &[Outcome],
    unread: &[String],
    seed: &Seed,
    is_quick: bool,
) -> String {
    let quick = if is_quick { " --quick" } else { "" };
    let mut text = format!(
        "# Robustness\n\n\
         `cargo xtask lab{quick}` wrote this, with fresh keys, payloads and attacks. `cargo xtask lab{quick} --seed {}` runs it \
         again.\n\n\
         Every suspect has also been rotated, scaled and moved at random, and written to a file. **Decoded**: the verdict is *found*, \
         with the payload that was embedded. **p < 1e-9**: the bound, every choice charged. ln p: the median of each carrier's \
         bound. Distance: the median RMS distance from the attacked model's vertices to the marked surface, in percent of the diagonal: \
         what the attacker paid. In the rows *unmarked* and *wrong key* there is nothing to find. Failures are named: models \
         that were not decoded, with `(p)` where p < 1e-9 all the same.\n",
        seed.number
    );
    for (class, title) in Class::ALL {
        let kinds = [Kind::Null, Kind::Usual];
        section(&mut text, title, rows, outcomes, |row, outcome| {
            kinds.contains(&row.kind) && outcome.model.class == class
        });
    }
    section(&mut text, "Deliberate attacks", rows, outcomes, |row, _| {
        row.kind == Kind::Deliberate
    });
    text.push_str("\n## Marks\n\n| model | strength | vertices | RMS, % | largest, % | ln p |\n|---|---|--:|--:|--:|--:|\n");
    for outcome in outcomes {
        let (name, strength) = (&outcome.model.name, outcome.strength);
        let cells = match &outcome.marked {
            Ok(marked) => format!(
                "{} | {:.4} | {:.3} | {:.0}",
                marked.report.vertices,
                100.0 * marked.report.rms_rel,
                100.0 * marked.report.max_rel,
                marked.report.read_back.ln_p
            ),
            Err(error) => format!("| | | not marked: {error}"),
        };
        let _ = writeln!(text, "| {name} | {strength} | {cells} |");
    }
    if !unread.is_empty() {
        let _ = write!(text, "\n## Files that were not read\n\n");
        unread
            .iter()
            .for_each(|file| _ = writeln!(text, "* {file}"));
    }
    text
}

/// One table for each strength.
fn section(
    text: &mut String,
    title: &str,
    rows: &[Row],
    outcomes: &[Outcome],
    belongs: impl Fn(&Row, &Outcome) -> bool,
) {
    let _ = write!(text, "\n## {title}\n");
    for outcomes in by_strength(outcomes) {
        let strength = outcomes[0].strength;
        let _ = write!(
            text,
            "\n### {title}: {strength}\n\n\
             | attack | decoded | p < 1e-9 | ln p, SOLID | ln p, RING | distance, % | failures |\n\
             |---|--:|--:|--:|--:|--:|---|\n"
        );
        for (number, row) in rows.iter().enumerate() {
            let cells: Vec<(&str, &Cell)> = outcomes
                .iter()
                .filter(|outcome| belongs(row, outcome))
                .map(|outcome| (outcome.model.name.as_str(), &outcome.cells[number]))
                .collect();
            if !cells.is_empty() {
                let _ = writeln!(text, "{}", line(row, &cells));
            }
        }
    }
}

fn by_strength<'a>(outcomes: &'a [Outcome<'a>]) -> Vec<Vec<&'a Outcome<'a>>> {
    let mut names: Vec<&str> = Vec::new();
    for outcome in outcomes {
        if !names.contains(&outcome.strength) {
            names.push(outcome.strength);
        }
    }
    names
        .iter()
        .map(|&name| {
            outcomes
                .iter()
                .filter(|outcome| outcome.strength == name)
                .collect()
        })
        .collect()
}

fn line(row: &Row, cells: &[(&str, &Cell)]) -> String {
    let count =
        |holds: &dyn Fn(&Cell) -> bool| cells.iter().filter(|(_, cell)| holds(cell)).count();
    let is_below = |cell: &Cell| cell.read.as_ref().is_ok_and(|read| read.ln_p < LN_BOUND);
    let carrier = |name: Carrier| {
        let of = |cell: &Cell| {
            let carriers = &cell.read.as_ref().ok()?.carriers;
            carriers
                .iter()
                .find(|reading| reading.name == name)
                .map(|reading| reading.ln_p)
        };
        median(
            cells.iter().filter_map(|(_, cell)| of(cell)).collect(),
            0,
            1.0,
        )
    };
    let failures: Vec<String> = cells
        .iter()
        .filter_map(|(name, cell)| match (row.kind, &cell.read) {
            (_, Err(error)) => Some(format!("{name}: {error}")),
            (Kind::Null, _) => is_below(cell).then(|| format!("**{name}: false alarm**")),
            _ if cell.is_decoded => None,
            _ => Some(format!(
                "{name}{}",
                if is_below(cell) { " (p)" } else { "" }
            )),
        })
        .collect();
    format!(
        "| {} | {}/{n} | {}/{n} | {} | {} | {} | {} |",
        row.name,
        count(&|cell| cell.is_decoded),
        count(&is_below),
        carrier(Carrier::Solid),
        carrier(Carrier::Ring),
        median(
            cells
                .iter()
                .filter_map(|(_, cell)| cell.distance_rel)
                .collect(),
            3,
            100.0
        ),
        failures.join(", "),
        n = cells.len(),
    )
}

/// The lower median, times a unit; nothing of nothing.
pub fn median(mut numbers: Vec<f64>, decimals: usize, unit: f64) -> String {
    numbers.sort_by(f64::total_cmp);
    let middle = numbers.get(numbers.len().saturating_sub(1) / 2);
    let Some(middle) = middle else {
        return String::new();
    };
    let text = format!("{:.decimals$}", middle * unit);
    // What rounds to nothing has no sign.
    let is_zero = text.bytes().all(|c| b"-0.".contains(&c));
    text[usize::from(is_zero && text.starts_with('-'))..].to_owned()
}
