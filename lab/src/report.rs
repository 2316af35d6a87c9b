//! docs/ROBUSTNESS.md.

use crate::cell::{Cell, Outcome};
use crate::grid::{Kind, Row, Suspect};
use crate::journal::{Mark, Results};
use crate::models::{Class, Model};
use crate::published::{ASPOSE, BENCHMARK, METHODS};
use crate::run::Scope;
use meshmark::Strength;
use meshmark::internals::detection::LN_P_FOUND;
use std::fmt::Write;

/// What a document says of its run.
pub struct Origin<'a> {
    /// Behind `cargo xtask lab`.
    pub arguments: &'a str,
    pub seed: u64,
    /// Files that are no models.
    pub unread: &'a [String],
}

/// The whole document.
pub fn document(origin: &Origin, scope: &Scope, results: &Results) -> String {
    let report = Report { scope, results };
    let mut text = introduction(origin, scope);
    report.beside_published(&mut text);
    for (class, title) in Class::ALL {
        let kinds = [Kind::Null, Kind::Usual];
        report.section(&mut text, title, &kinds, |other| other == class);
    }
    report.section(&mut text, "Deliberate attacks", &[Kind::Deliberate], |_| {
        true
    });
    report.section(
        &mut text,
        "Programs that people have",
        &[Kind::Real],
        |_| true,
    );
    report.versions(&mut text);
    report.removals(&mut text);
    report.marks(&mut text);
    aspose(&mut text);
    if !origin.unread.is_empty() {
        let _ = write!(text, "\n## Files that were not read\n\n");
        for file in origin.unread {
            let _ = writeln!(text, "* {file}");
        }
    }
    text
}

fn introduction(origin: &Origin, scope: &Scope) -> String {
    let Origin {
        arguments, seed, ..
    } = origin;
    let copies = match scope.copies {
        1 => "once".to_owned(),
        copies => format!("{copies} times"),
    };
    format!(
        "# Robustness\n\n\
         `cargo xtask lab{arguments}` wrote this, with fresh keys, payloads and attacks; `cargo xtask lab{arguments} --seed {seed}` runs \
         it again. Each of {} models was marked {copies} at each strength.\n\n\
         Every suspect has also been rotated, scaled and moved at random, and written to a file. **Decoded**: the verdict is *found*, \
         with the payload that was embedded. **p < 1e-9**: the bound, every choice charged. ln p: the median of each carrier's \
         bound. BER: the mean share of wrong payload bits; a payload that is not read counts half. Triangles: how many there are then, of the marked model's. RMS, Hausdorff, MSDM: medians \
         of what the attacker paid, from the attacked surface to the marked one (what was cut off costs nothing), distances in percent \
         of the diagonal. In the rows *unmarked* and *wrong key* there is nothing to find. Failures are named: models that were not \
         decoded, with `(p)` where p < 1e-9 all the same. The probability of a false alarm is in [FALSE_POSITIVES](FALSE_POSITIVES.md).\n\n\
         ![share of suspects found against the bound](robustness/found.svg)\n",
        scope.models.len()
    )
}

struct Report<'a> {
    scope: &'a Scope,
    results: &'a Results,
}

impl Report<'_> {
    /// The cells of a row at a strength, in the models' order.
    fn cells(&self, row: &Row, strength: &str, class: impl Fn(Class) -> bool) -> Vec<&Cell> {
        let models = self.scope.models.iter().filter(|model| class(model.class));
        let of = |model: &'_ Model| {
            let cells = self.results.cells.iter();
            let is_here = |cell: &&Cell| {
                cell.model == model.name && cell.strength == strength && cell.row == row.name
            };
            cells.filter(is_here).collect::<Vec<_>>()
        };
        models.flat_map(of).collect()
    }

    /// One table for each strength.
    fn section(
        &self,
        text: &mut String,
        title: &str,
        kinds: &[Kind],
        class: impl Fn(Class) -> bool + Copy,
    ) {
        let rows = || {
            self.scope
                .rows
                .iter()
                .filter(|row| kinds.contains(&row.kind))
        };
        if rows().all(|row| {
            self.strengths()
                .all(|strength| self.cells(row, strength, class).is_empty())
        }) {
            return;
        }
        let _ = write!(text, "\n## {title}\n");
        for strength in self.strengths() {
            let _ = write!(
                text,
                "\n### {title}: {strength}\n\n\
                 | attack | decoded | p < 1e-9 | ln p, SOLID | ln p, RING | BER | triangles, % | RMS, % | Hausdorff, % | MSDM | failures |\n\
                 |---|--:|--:|--:|--:|--:|--:|--:|--:|--:|---|\n"
            );
            for row in rows() {
                let cells = self.cells(row, strength, class);
                if !cells.is_empty() {
                    let _ = writeln!(text, "{}", line(row, &cells));
                }
            }
        }
    }

    /// The programs and their versions, each once.
    fn versions(&self, text: &mut String) {
        let mut programs: Vec<&str> = Vec::new();
        for row in &self.scope.rows {
            if let Suspect::Tool(tool) = &row.make
                && !programs.contains(&&*tool.program)
            {
                programs.push(&tool.program);
            }
        }
        if !programs.is_empty() {
            let _ = writeln!(
                text,
                "\n{}. Each was given the marked file itself.",
                programs.join(", ")
            );
        }
    }

    fn strengths(&self) -> impl Iterator<Item = &'static str> + use<> {
        let strengths: &'static [(&'static str, Strength)] = self.scope.strengths;
        strengths.iter().map(|(name, _)| *name)
    }

    /// The benchmark's rows, with the figures of others.
    fn beside_published(&self, text: &mut String) {
        let Some(strength) = self.strengths().last() else {
            return;
        };
        let _ = write!(
            text,
            "\n## Beside what has been published\n\n\
             Shares of wrong bits. The columns of other methods are of the model Venus, from the LIRIS benchmark's page of results (Wang et \
             al. 2010), with their RMS distortion and MSDM; rows for simplification and cropping could not be found. *Cho et al., here* is this \
             lab's own implementation of the method, in the same models as meshmark ({strength}), with the same RMS displacement and \
             the same attacks: the mean over all plain models. No published method states the probability of a false alarm.\n\n\
             | attack | {} | Cho et al., here | **meshmark** |\n|---|{}--:|--:|\n",
            METHODS.join(" | "),
            "--:|".repeat(METHODS.len())
        );
        for row in &self.scope.rows {
            let cells = self.cells(row, strength, |class| class == Class::Plain);
            let outcomes = || cells.iter().flat_map(|cell| &cell.outcome);
            let baseline = mean(outcomes().filter_map(|outcome| outcome.baseline));
            let Some(baseline) = baseline else {
                continue;
            };
            let published = BENCHMARK.iter().find(|(name, _)| *name == row.name);
            let published = published.map_or("| ".repeat(METHODS.len()), |(_, bers)| {
                bers.map(|ber| format!("{ber:.2} | ")).concat()
            });
            let ours = mean(outcomes().map(Outcome::ber)).unwrap_or(0.5);
            let _ = writeln!(
                text,
                "| {} | {published}{baseline:.2} | {ours:.2} |",
                row.name
            );
        }
    }

    fn removals(&self, text: &mut String) {
        if self.results.removals.is_empty() {
            return;
        }
        text.push_str(
            "\n## What it takes to remove a mark\n\n\
             The weakest level, in steps of a quarter, at which the verdict is not *found* any more, by bisection: as if what is stronger \
             always removed more. And what it makes of the model.\n\n\
             | attack | model | strength | removed by | RMS, % | Hausdorff, % | MSDM |\n|---|---|---|--:|--:|--:|--:|\n",
        );
        for means in &self.scope.means {
            let of = |model: &str, strength: &str| {
                let mut removals = self.results.removals.iter();
                removals.find(|removal| {
                    removal.means == means.name
                        && removal.model == model
                        && removal.strength == strength
                })
            };
            let models = self.scope.models.iter();
            let removals = models.flat_map(|model| {
                (self.strengths()).filter_map(move |strength| of(&model.name, strength))
            });
            for removal in removals {
                let cost = match &removal.weakest {
                    Some((level, quality)) => format!(
                        "{}{} | {} | {} | {}",
                        significant(*level),
                        means.unit,
                        percent(quality.rms_rel),
                        percent(quality.hausdorff_rel),
                        plain(quality.msdm)
                    ),
                    None => "nothing that was tried | | |".to_owned(),
                };
                let (name, model, strength) = (means.name, &removal.model, &removal.strength);
                let _ = writeln!(text, "| {name} | {model} | {strength} | {cost} |");
            }
        }
    }

    fn marks(&self, text: &mut String) {
        text.push_str(
            "\n## Marks\n\n| model | strength | vertices | RMS, % | largest, % | MSDM | ln p |\n|---|---|--:|--:|--:|--:|--:|\n",
        );
        let of = |mark: &Mark| match &mark.outcome {
            Ok(marked) => format!(
                "{} | {:.4} | {:.3} | {} | {:.0}",
                marked.vertices,
                100.0 * marked.rms_rel,
                100.0 * marked.max_rel,
                plain(marked.msdm),
                marked.ln_p
            ),
            Err(error) => format!("| | | | not marked: {error}"),
        };
        for model in &self.scope.models {
            for strength in self.strengths() {
                let marks = self.results.marks.iter().filter(|mark| {
                    mark.model == model.name && mark.strength == strength && mark.copy == 0
                });
                for mark in marks {
                    let _ = writeln!(text, "| {} | {strength} | {} |", model.name, of(mark));
                }
            }
        }
    }
}

fn aspose(text: &mut String) {
    text.push_str(
        "\n## Aspose.3D\n\n\
         The one commercial library with a mesh watermark that could be tried: version 26.9.0, trial, on two models. It leaves the \
         geometry as it is.\n\n\
         | attack | cow | Stanford bunny |\n|---|---|---|\n",
    );
    for (attack, cow, bunny) in ASPOSE {
        let _ = writeln!(text, "| {attack} | {cow} | {bunny} |");
    }
}

fn line(row: &Row, cells: &[&Cell]) -> String {
    let outcomes = || cells.iter().flat_map(|cell| &cell.outcome);
    let is_below = |outcome: &Outcome| outcome.ln_p < LN_P_FOUND;
    let numbers = |of: &dyn Fn(&Outcome) -> Option<f64>, decimals, unit| {
        median(outcomes().filter_map(of).collect(), decimals, unit)
    };
    let failures: Vec<String> = cells
        .iter()
        .filter_map(|cell| {
            let model = &cell.model;
            match &cell.outcome {
                Err(error) => Some(format!("{model}: {error}")),
                Ok(outcome) if row.kind == Kind::Null => {
                    is_below(outcome).then(|| format!("**{model}: false alarm**"))
                }
                Ok(outcome) if outcome.is_decoded => None,
                Ok(outcome) if is_below(outcome) => Some(format!("{model} (p)")),
                Ok(_) => Some(model.clone()),
            }
        })
        .collect();
    let ber = match row.kind {
        Kind::Null => None,
        // What could not be made or read has been lost.
        _ => mean(
            cells
                .iter()
                .map(|cell| cell.outcome.as_ref().map_or(0.5, Outcome::ber)),
        ),
    };
    format!(
        "| {} | {}/{n} | {}/{n} | {} | {} | {} | {} | {} | {} | {} | {} |",
        row.name,
        outcomes().filter(|outcome| outcome.is_decoded).count(),
        outcomes().filter(|outcome| is_below(outcome)).count(),
        numbers(&|outcome| Some(outcome.solid), 0, 1.0),
        numbers(&|outcome| Some(outcome.ring), 0, 1.0),
        ber.map_or(String::new(), |ber| format!("{ber:.2}")),
        numbers(&|outcome| Some(outcome.triangles), 0, 100.0),
        numbers(&|outcome| outcome.quality.rms_rel, 3, 100.0),
        numbers(&|outcome| outcome.quality.hausdorff_rel, 2, 100.0),
        numbers(&|outcome| outcome.quality.msdm, 2, 1.0),
        failures.join(", "),
        n = cells.len(),
    )
}

fn mean(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let numbers: Vec<f64> = numbers.collect();
    (!numbers.is_empty()).then(|| numbers.iter().sum::<f64>() / numbers.len() as f64)
}

fn percent(fraction: Option<f64>) -> String {
    fraction.map_or(String::new(), |fraction| format!("{:.3}", 100.0 * fraction))
}

fn plain(number: Option<f64>) -> String {
    number.map_or(String::new(), |number| format!("{number:.2}"))
}

/// As many decimals as three digits need.
fn significant(number: f64) -> String {
    let decimals = match number {
        ..1.0 => 3,
        ..10.0 => 2,
        ..100.0 => 1,
        _ => 0,
    };
    format!("{number:.decimals$}")
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
