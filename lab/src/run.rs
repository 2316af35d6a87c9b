//! Runs the grid: every row of every copy of every model at every strength, on all cores, and what a run before has left.

use crate::case::Case;
use crate::cell::cell;
use crate::grid::{Kind, Row};
use crate::journal::{Entry, Journal, Mark, Marked};
use crate::models::{Model, Size};
use crate::removal::{Means, removal};
use crate::seed::Seed;
use meshmark::Strength;
use meshmark::internals::geometry::Quality;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// What is run.
pub struct Scope {
    pub models: Vec<Model>,
    pub rows: Vec<Row>,
    pub means: Vec<Means>,
    pub strengths: &'static [(&'static str, Strength)],
    /// Keys, payloads and attacks of each model at each strength.
    pub copies: u32,
}

/// Counts what is done, and says how long the rest may take.
struct Clock {
    done: AtomicUsize,
    total: usize,
    start: Instant,
}

impl Clock {
    fn tick(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        let left = self
            .start
            .elapsed()
            .mul_f64((self.total - done) as f64 / done as f64);
        let bar = "#".repeat(30 * done / self.total);
        eprint!(
            "\r[{bar:30}] {done} of {}, about {} s left   ",
            self.total,
            left.as_secs()
        );
    }
}

/// Measures what the journal does not have yet.
pub fn run(scope: &Scope, seed: &Seed, journal: &Journal) -> Result<(), String> {
    let done = journal.results();
    let cells: BTreeSet<_> = (done.cells.iter())
        .map(|cell| (&*cell.model, &*cell.strength, cell.copy, &*cell.row))
        .collect();
    let removals: BTreeSet<_> = (done.removals.iter())
        .map(|removal| (&*removal.model, &*removal.strength, &*removal.means))
        .collect();
    let marks: BTreeSet<_> = (done.marks.iter())
        .map(|mark| (&*mark.model, &*mark.strength, mark.copy))
        .collect();
    let mut jobs = Vec::new();
    for model in &scope.models {
        for &strength in scope.strengths {
            for copy in 0..scope.copies {
                // What takes long is done with few models, once.
                let is_first = copy == 0 && model.size == Size::Quick;
                let rows: Vec<&Row> = (scope.rows.iter())
                    .filter(|row| row.kind != Kind::Real || is_first)
                    .filter(|row| !cells.contains(&(&*model.name, strength.0, copy, &*row.name)))
                    .collect();
                let means: Vec<&Means> = (scope.means.iter())
                    .filter(|means| {
                        is_first && !removals.contains(&(&*model.name, strength.0, means.name))
                    })
                    .collect();
                let is_marked = marks.contains(&(&*model.name, strength.0, copy));
                jobs.push((model, strength, copy, is_marked, rows, means));
            }
        }
    }
    let clock = Clock {
        done: AtomicUsize::new(0),
        total: jobs.iter().map(|job| job.4.len() + job.5.len()).sum(),
        start: Instant::now(),
    };
    let finished = jobs
        .par_iter()
        .filter(|job| job.4.len() + job.5.len() > 0)
        .try_for_each(|(model, strength, copy, is_marked, rows, means)| {
            let case = Case::new(model, *strength, *copy, seed)?;
            if !is_marked {
                journal.record(Entry::Mark(mark(&case)))?;
            }
            rows.par_iter().try_for_each(|row| {
                journal.record(Entry::Cell(cell(&case, row)))?;
                clock.tick();
                Ok::<(), String>(())
            })?;
            means.par_iter().try_for_each(|means| {
                // A model that is not marked has said so in its cells.
                if let Ok(removal) = removal(&case, means) {
                    journal.record(Entry::Removal(removal))?;
                }
                clock.tick();
                Ok(())
            })
        });
    eprintln!();
    finished
}

fn mark(case: &Case) -> Mark {
    let outcome = case
        .marked
        .as_ref()
        .map_err(Clone::clone)
        .map(|marked| Marked {
            vertices: marked.report.vertices,
            rms_rel: marked.report.rms_rel,
            max_rel: marked.report.max_rel,
            msdm: Quality::between(&case.host, &marked.mesh).msdm,
            ln_p: marked.report.read_back.details().ln_p,
        });
    Mark {
        model: case.model.name.clone(),
        strength: case.strength_name.to_owned(),
        copy: case.copy,
        outcome,
    }
}
