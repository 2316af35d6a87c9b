//! Runs the grid.

use crate::case::{Case, Marked};
use crate::grid::{Kind, Row};
use crate::models::Model;
use crate::seed::Seed;
use meshmark::attack::similarity;
use meshmark::geometry::{Surface, diagonal};
use meshmark::mesh::Mesh;
use meshmark::scene::to_glb;
use meshmark::{Extraction, Files, Strength, Verdict, extract, ignore, measure};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// A model at a strength, and what became of its mark in each row.
pub struct Outcome<'a> {
    pub model: &'a Model,
    pub strength: &'static str,
    /// Of the marking; the model's vertices are in it.
    pub marked: Result<Marked, String>,
    pub cells: Vec<Cell>,
}

/// One row of one model at one strength.
pub struct Cell {
    pub read: Result<Extraction, String>,
    /// Found, with the payload that was embedded.
    pub is_decoded: bool,
    /// RMS distance of the attacked surface from the marked one, as a fraction of the diagonal.
    pub distance_rel: Option<f64>,
}

/// Vertices that a distance is taken at.
const SAMPLES: usize = 4000;

/// Every row of every model at every strength, on all cores.
pub fn all<'a>(
    models: &'a [Model],
    rows: &[Row],
    strengths: &'static [(&'static str, Strength)],
    seed: &Seed,
) -> Vec<Outcome<'a>> {
    let pairs: Vec<_> = models
        .iter()
        .flat_map(|model| strengths.iter().map(move |&strength| (model, strength)))
        .collect();
    let cases: Vec<_> = pairs
        .par_iter()
        .map(|&(model, strength)| Case::new(model, strength, seed))
        .collect();
    let (done, total, start) = (
        AtomicUsize::new(0),
        pairs.len() * rows.len(),
        Instant::now(),
    );
    let outcomes = pairs
        .into_par_iter()
        .zip(cases)
        .map(|((model, strength), case)| {
            let cells = rows.par_iter().map(|row| {
                let cell = match &case {
                    Ok(case) => cell(case, row),
                    Err(error) => Cell::failed(error.clone()),
                };
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                let left = start.elapsed().mul_f64((total - done) as f64 / done as f64);
                eprint!("\r{done} of {total}, about {} s left   ", left.as_secs());
                cell
            });
            Outcome {
                model,
                strength: strength.0,
                cells: cells.collect(),
                marked: case.and_then(|case| case.marked),
            }
        });
    let outcomes = outcomes.collect();
    eprintln!();
    outcomes
}

fn cell(case: &Case, row: &Row) -> Cell {
    let purpose = format!("{}, {}", case.purpose, row.name);
    let suspect = || {
        // An unmarked model is there even where it cannot be marked.
        let marked = match (&case.marked, row.kind) {
            (Ok(marked), _) => &marked.mesh,
            (Err(_), Kind::Null) => &case.host,
            (Err(error), _) => return Err(format!("not marked: {error}")),
        };
        let suspect = (row.suspect)(case, marked, case.seed.number(&purpose, 0))?;
        Ok((distance(marked, &suspect), suspect))
    };
    let read = |suspect: &Mesh| {
        let moved = similarity(suspect, case.seed.number(&purpose, 1));
        let evidence = measure(&to_glb(&moved), &Files::new(), &mut ignore)
            .map_err(|error| error.to_string())?;
        Ok(extract(&evidence, &case.key))
    };
    match suspect() {
        Err(error) => Cell::failed(error),
        Ok((distance_rel, suspect)) => {
            let read: Result<Extraction, String> = read(&suspect);
            Cell {
                is_decoded: read.as_ref().is_ok_and(|read| {
                    read.verdict == Verdict::Found && read.number == Some(case.payload.number())
                }),
                read,
                distance_rel,
            }
        }
    }
}

impl Cell {
    fn failed(error: String) -> Cell {
        Cell {
            read: Err(error),
            is_decoded: false,
            distance_rel: None,
        }
    }
}

impl Case<'_> {
    /// RMS displacement of this case's mark; its limit, where there is none.
    pub fn rms_rel(&self) -> f64 {
        self.marked
            .as_ref()
            .map_or(self.strength.rms_rel(), |marked| marked.report.rms_rel)
    }
}

/// From the vertices of the attacked mesh to the marked surface: what was cut off costs nothing.
fn distance(marked: &Mesh, attacked: &Mesh) -> Option<f64> {
    let surface = Surface::new(marked);
    let step = attacked.positions.len().div_ceil(SAMPLES).max(1);
    let squares: Vec<f64> = attacked
        .positions
        .iter()
        .step_by(step)
        .filter_map(|&p| Some(surface.nearest(p)?.distance))
        .map(|distance| distance * distance)
        .collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    mean.is_finite()
        .then(|| mean.sqrt() / diagonal(&marked.positions))
}
