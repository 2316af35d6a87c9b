//! Which share of suspects has a bound below any: the power of the test against its probability of a false alarm.

use crate::grid::{Kind, Row};
use crate::journal::Results;
use crate::plot::{Axis, curves};
use std::f64::consts::LN_10;

/// Decades of the bound.
const DECADES: u32 = 60;

/// Kinds of rows, each a line; what no model may exceed is the first.
const LINES: [(Kind, &str); 4] = [
    (Kind::Null, "nothing to find"),
    (Kind::Usual, "what happens to models"),
    (Kind::Deliberate, "deliberate"),
    (Kind::Real, "programs"),
];

pub fn plot(rows: &[Row], results: &Results) -> String {
    let lines: Vec<(&str, Vec<(f64, f64)>)> = LINES
        .iter()
        .filter_map(|&(kind, name)| {
            let of_kind = |name: &str| rows.iter().any(|row| row.kind == kind && row.name == name);
            let cells = results.cells.iter().filter(|cell| of_kind(&cell.row));
            // A suspect that could not be made or read was not found.
            let ln_ps: Vec<f64> = cells
                .map(|cell| cell.outcome.as_ref().map_or(0.0, |outcome| outcome.ln_p))
                .collect();
            (!ln_ps.is_empty()).then(|| (name, line(&ln_ps)))
        })
        .collect();
    let (names, lines): (Vec<&str>, Vec<_>) = lines.into_iter().unzip();
    let x = Axis {
        name: "the bound p of a false alarm",
        ends: (0.0, f64::from(DECADES)),
        marks: [0, 9, 20, 30, 40, 50, 60]
            .map(|decade| (f64::from(decade), format!("1e-{decade}")))
            .to_vec(),
    };
    let y = Axis {
        name: "share of suspects below it",
        ends: (0.0, 1.0),
        marks: [0.0, 0.25, 0.5, 0.75, 1.0]
            .map(|share| (share, format!("{:.0} %", 100.0 * share)))
            .to_vec(),
    };
    curves("Suspects found against the bound", [&x, &y], &names, &lines)
}

/// The share at every decade.
fn line(ln_ps: &[f64]) -> Vec<(f64, f64)> {
    (0..=DECADES)
        .map(f64::from)
        .map(|decade| {
            let below = ln_ps.iter().filter(|&&ln_p| ln_p < -decade * LN_10).count();
            (decade, below as f64 / ln_ps.len() as f64)
        })
        .collect()
}
