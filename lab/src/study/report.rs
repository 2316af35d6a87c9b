//! docs/STUDY.md.

use super::layers::{Layers, ORDERS};
use super::measure::{Outcome, Smoothed};
use super::note::Read;
use super::verdict::{counts, find, statements};
use crate::plot::{Panel, Row, bars, grid, panels};
use crate::report::median;
use crate::seed::Seed;
use meshmark::internals::paper::Ranking;
use meshmark::internals::paper::figure_5::{Errors, Figure5, Finding, Hosts, STRENGTH, STRENGTHS};
use meshmark::internals::paper::{HostsOptions, HostsRow, NUM_FACES, Rule, Smoothing, Study};
use std::fmt::Write;

/// Hosts of the curves, in the order of their colours.
const SERIES: [&str; 5] = [
    "random",
    "literal",
    "integrated",
    "collapse",
    "all vertices",
];

const FINDINGS: [(Finding, &str); 4] = [
    (Finding::Traced, "traced"),
    (Finding::Original, "with the original"),
    (Finding::Ranked, "ranked again"),
    (Finding::Cells, "cells"),
];

type Results = [(String, Result<Outcome, String>)];
type Table = fn(&Outcome) -> &[HostsRow];
type Figure = fn(&Outcome) -> &Figure5;
type Value = fn(&Errors) -> f64;
type MarkOf = fn(&Smoothed) -> &Result<Read, String>;

/// The document, and its plots by name.
pub fn document(results: &Results, seed: &Seed, num_keys: u32) -> (String, Vec<(String, String)>) {
    let outcomes: Vec<&Outcome> = results
        .iter()
        .filter_map(|(_, result)| result.as_ref().ok())
        .collect();
    let mut text = preface(seed, num_keys);
    verdicts(&mut text, &outcomes);
    models(&mut text, results);
    let mut plots = table_1(&mut text, &outcomes).to_vec();
    plots.extend(figure_5(&mut text, &outcomes));
    plots.push(smoothings(&mut text, &outcomes));
    layers(&mut text, &outcomes);
    text.push_str(OURS);
    (text, plots)
}

fn preface(seed: &Seed, num_keys: u32) -> String {
    format!(
        "# The seed paper's study\n\n\
         What does smoothing do to a watermark? The paper that this project comes from asks it of a mark in chosen vertices (OSVETA), coded by \
         LDPC and run lengths, written by sparse QIM. Here its experiment is repeated, for every smoothing that it names, with this project's own \
         marks beside it.\n\n\
         `cargo xtask study` wrote this, with fresh keys, texts and random hosts; `cargo xtask study --seed {}` runs it again on the same \
         models. `--models DIR` takes the .obj and .glb files of a folder; generated meshes are always there. One model alone: \
         `meshmark study model.glb`.\n\n\
         **Settings.** Meshes of at most {NUM_FACES} faces, as the paper's. *Optimized*: by a face threshold, as the paper does it; *simplified*: by \
         quadric error metrics. {} random draws, {num_keys} keys each with a text of 5 characters (64 bits with its check bits, 1152 hosts at most), {} % of the \
         diagonal RMS, where nothing else is said. I: iterations of MeshSmooth, which is Catmull and Clark's scheme. BER: share of wrong bits; 0.5 is \
         chance. Spreads are standard deviations.\n",
        seed.number,
        HostsOptions::default().draws,
        100.0 * STRENGTH,
    )
}

fn verdicts(text: &mut String, outcomes: &[&Outcome]) {
    text.push_str(
        "\n## What is reproduced, and what is not\n\n\
         Each statement is held against the models that it is made of (bold); the others are there for comparison.\n\n| statement |",
    );
    outcomes
        .iter()
        .for_each(|outcome| _ = write!(text, " {} |", outcome.name));
    text.push_str(" result |\n|---|");
    outcomes.iter().for_each(|_| text.push_str("--:|"));
    text.push_str("---|\n");
    for statement in statements() {
        let _ = write!(text, "| {} |", statement.text);
        let mut asked = Vec::new();
        for outcome in outcomes {
            let Some((value, holds)) = (statement.check)(outcome) else {
                text.push_str(" |");
                continue;
            };
            let cell = format!("{value:.2} {}", if holds { "yes" } else { "no" });
            if statement.is_asked(&outcome.name) {
                asked.push(holds);
                let _ = write!(text, " **{cell}** |");
            } else {
                let _ = write!(text, " {cell} |");
            }
        }
        let held = asked.iter().filter(|holds| **holds).count();
        let result = match asked.len() {
            0 => "no such model".to_owned(),
            count if held == count => "**pass**".to_owned(),
            count => format!("**fail** ({held} of {count})"),
        };
        let _ = writeln!(text, " {result} |");
    }
}

fn models(text: &mut String, results: &Results) {
    text.push_str(
        "\n## Models\n\n| model | V | F | V, F optimized | V, F simplified |\n|---|--:|--:|--:|--:|\n",
    );
    for (name, result) in results {
        let _ = match result {
            Ok(outcome) => writeln!(
                text,
                "| {name} | {} | {} | {}, {} | {}, {} |",
                outcome.vertices,
                outcome.faces,
                outcome.optimized.vertices,
                outcome.optimized.triangles,
                outcome.simplified.vertices,
                outcome.simplified.triangles
            ),
            Err(error) => writeln!(text, "| {name} | not studied: {error} | | | |"),
        };
    }
}

fn table_1(text: &mut String, outcomes: &[&Outcome]) -> [(String, String); 2] {
    text.push_str(
        "\n## Table I: hosts found again\n\n\
         The paper counts 968 random vertices and 1316 by OSVETA after one iteration (1.36 times as many), 1254 and 1423 after two (1.13), and does \
         not say how. Three rules are tried. **Index**: of all N' vertices of the smoothed mesh the best N are selected, N being the number \
         before; those count that were vertices before. Its chance is N^2/N', on the paper's mesh 979 and 245: the paper's 968 at one iteration is \
         chance. **Region**: the vertices before count that have a selected one within 0.2 mean edges of where they were. **Overlap**: of the best 1000 \
         before, those count that are among the best 1000 afterwards, which is what blind detection has to go on. No rule fits both \
         columns of the paper: its 1254 at two iterations is five times the index rule's chance, and the region rule, which can give so many, gives more at one \
         iteration than at two. We cannot decide how it counted.\n\n\
         ![OSVETA over random by the index rule, optimized](study/table-1-optimized.svg)\n\n\
         ![OSVETA over random by the index rule, simplified](study/table-1-simplified.svg)\n\n\
         Counts, and in brackets OSVETA/random.\n",
    );
    for rule in [Rule::Index, Rule::Region, Rule::Overlap] {
        let name = match rule {
            Rule::Index => "index",
            Rule::Region => "region",
            Rule::Overlap => "overlap",
        };
        for (preparation, table) in tables() {
            let _ = write!(
                text,
                "\n<details{}><summary>{name} rule, {preparation}</summary>\n\n\
                 | model | I | chance | random | least to most | literal | integrated | collapse |\n|---|--:|--:|--:|--:|--:|--:|--:|\n",
                if rule == Rule::Index { " open" } else { "" }
            );
            for outcome in outcomes {
                for iterations in 0..=2 {
                    if let Some(counts) = counts(table(outcome), iterations, rule) {
                        let _ = write!(
                            text,
                            "| {} | {iterations} | {} | {:.0} +- {:.0} | {:.0} to {:.0} |",
                            outcome.name,
                            counts
                                .chance
                                .map_or(String::new(), |chance| format!("{chance:.0}")),
                            counts.random.mean,
                            counts.random.deviation,
                            counts.random.least,
                            counts.random.most,
                        );
                        for count in &counts.ranked {
                            let ratio = count
                                .ratio
                                .map_or(String::new(), |ratio| format!(" ({ratio:.2})"));
                            let _ = write!(text, " {}{ratio} |", count.count);
                        }
                        text.push('\n');
                    }
                }
            }
            text.push_str("\n</details>\n");
        }
    }
    let plot = |(preparation, table): (&str, Table)| {
        let groups = outcomes.iter().flat_map(|outcome| {
            [1, 2].map(|iterations| Row {
                name: format!("{}, I = {iterations}", outcome.name),
                values: ratios(table(outcome), iterations),
            })
        });
        let plot = bars(
            &format!("Table I, index rule, {preparation}: OSVETA/random; dashed: 2.0"),
            &SERIES[..4],
            &groups.collect::<Vec<_>>(),
            8.0,
            &[2.0],
        );
        (format!("table-1-{preparation}.svg"), plot)
    };
    tables().map(plot)
}

fn tables() -> [(&'static str, Table); 2] {
    [
        ("optimized", |outcome| &outcome.optimized.table_1),
        ("simplified", |outcome| &outcome.simplified.table_1),
    ]
}

fn ratios(table: &[HostsRow], iterations: u32) -> Vec<Option<f64>> {
    let index = counts(table, iterations, Rule::Index);
    let ranked = index.map_or(&[][..], |index| &index.ranked);
    let ratios = ranked.iter().map(|count| count.ratio);
    [Some(1.0)].into_iter().chain(ratios).collect()
}

/// The three versions of the figure.
fn figures() -> [(&'static str, &'static str, Figure); 3] {
    fn of(study: &Study) -> &Figure5 {
        &study.figure_5
    }
    [
        (
            "figure-5-simplified",
            "Simplified, distances from the mean of the vertices",
            |outcome| of(&outcome.simplified),
        ),
        (
            "figure-5-optimized",
            "Optimized, distances from the mean of the vertices",
            |outcome| of(&outcome.optimized),
        ),
        (
            "figure-5-volume",
            "Simplified, distances from the centroid of the volume",
            |outcome| &outcome.from_volume,
        ),
    ]
}

/// The places of the figure's two axes.
fn places() -> impl Iterator<Item = (bool, u32, f64)> {
    let smoothing = (0..=2).map(|iterations| (true, iterations, STRENGTH));
    smoothing.chain(STRENGTHS.map(|strength| (false, 1, strength)))
}

fn half(figure: &Figure5, is_smoothing: bool) -> &[Errors] {
    if is_smoothing {
        &figure.against_smoothing
    } else {
        &figure.against_strength
    }
}

fn figure_5(text: &mut String, outcomes: &[&Outcome]) -> Vec<(String, String)> {
    text.push_str(
        "\n## Fig. 5: errors\n\n\
         Hosts are found again in four ways. **Traced**: their new indices are known, which is what the paper assumes. **With the original** (eq. 1, \
         k = c || k'): by the surface in the direction of each host, after alignment of the frames. **Ranked again**: blind, from the suspect's own \
         ranking. The mark itself changes the ranking, the hosts arrive as a permutation, and codes against losses and gains do not \
         mend permutations. **Cells**: blind, the bit of a vertex is that of its direction in the suspect's frame; all vertices are hosts, and \
         none has to be found. Raw: before the codes. The paper measures from the mean of the vertices, which subdivision moves because new vertices are not \
         spread as the old ones; the third version measures from the centroid of the volume. \
         Shapes like the torus knot, two of whose spreads are equal but for its relief, have no frame to go by: whatever needs one fails on them without any \
         attack.\n",
    );
    let mut plots = Vec::new();
    for (name, title, figure) in figures() {
        let _ = write!(
            text,
            "\n### {title}\n\n![{title}](study/{name}.svg)\n\nMean of all models, raw / payload:\n\n"
        );
        errors_table(text, outcomes, figure);
        for outcome in outcomes {
            let _ = write!(text, "\n<details><summary>{}</summary>\n\n", outcome.name);
            errors_table(text, std::slice::from_ref(outcome), figure);
            text.push_str("\n</details>\n");
        }
        plots.push((format!("{name}.svg"), curves(title, outcomes, figure)));
    }
    plots
}

fn errors_table(text: &mut String, outcomes: &[&Outcome], figure: Figure) {
    text.push_str("| hosts | found |");
    for (is_smoothing, iterations, strength) in places() {
        let _ = if is_smoothing {
            write!(text, " I = {iterations} |")
        } else {
            write!(text, " I = 1, {} % |", percent(strength))
        };
    }
    text.push_str("\n|---|---|");
    places().for_each(|_| text.push_str("--:|"));
    text.push('\n');
    for (finding, found) in FINDINGS {
        for hosts in Hosts::every() {
            let mean = |(is_smoothing, iterations, strength), of: Value| {
                mean(outcomes.iter().filter_map(|outcome| {
                    let errors = half(figure(outcome), is_smoothing);
                    find(errors, hosts, finding, iterations, strength).map(of)
                }))
            };
            let cells: Option<Vec<String>> = places()
                .map(|place| {
                    let raw = mean(place, |errors| errors.raw.mean)?;
                    let payload = mean(place, |errors| errors.payload.mean)?;
                    Some(format!("{raw:.2} / {payload:.2}"))
                })
                .collect();
            if let Some(cells) = cells {
                let _ = writeln!(
                    text,
                    "| {} | {found} | {} |",
                    hosts.name(),
                    cells.join(" | ")
                );
            }
        }
    }
}

fn curves(title: &str, outcomes: &[&Outcome], figure: Figure) -> String {
    let value: [(&str, Value); 2] = [
        ("raw", |errors| errors.raw.mean),
        ("payload", |errors| errors.payload.mean),
    ];
    let mut all = Vec::new();
    for is_smoothing in [true, false] {
        let places: Vec<_> = places().filter(|place| place.0 == is_smoothing).collect();
        let axis = if is_smoothing { "" } else { ", by %" };
        for (name, of) in value {
            for (finding, found) in FINDINGS {
                let line = |hosts| {
                    let points = places.iter().map(|&(_, iterations, strength)| {
                        mean(outcomes.iter().filter_map(|outcome| {
                            let errors = half(figure(outcome), is_smoothing);
                            find(errors, hosts, finding, iterations, strength).map(of)
                        }))
                    });
                    points.collect::<Option<Vec<f64>>>().unwrap_or_default()
                };
                all.push(Panel {
                    title: format!("{found}: {name}{axis}"),
                    places: places
                        .iter()
                        .map(|&(is_smoothing, iterations, strength)| {
                            if is_smoothing {
                                format!("I = {iterations}")
                            } else {
                                percent(strength).to_string()
                            }
                        })
                        .collect(),
                    lines: Hosts::every().map(line).collect(),
                });
            }
        }
    }
    panels(
        &format!("{title}: BER, mean of models ({})", outcomes.len()),
        &SERIES,
        &all,
        FINDINGS.len(),
        0.6,
    )
}

fn smoothings(text: &mut String, outcomes: &[&Outcome]) -> (String, String) {
    text.push_str(
        "\n## Every smoothing\n\n\
         Simplified meshes. *Moved*: RMS displacement of the vertices that were there before, in percent of the diagonal, median of the models; the mark's own \
         is 0.08. BER: of the payload, mean of all models and keys. Note, SOLID and RING are this project's: a note is cells with a step of its own, read \
         by `note::read`; SOLID and RING are embedded alone at *strong*, and read by `detect`. Of each: in how many models it was read rightly, and the median of \
         ln p. One iteration: half a step of the umbrella operator or of its square; mean curvature flow for half a squared mean edge; Taubin's 0.5 and -0.53; \
         one round of the mean filter of eqs 2 to 4; one subdivision.\n\n\
         ![What is read after every smoothing](study/smoothings.svg)\n\n\
         | smoothing | I | moved, % | random, traced | literal, traced | integrated, traced | collapse, traced | collapse, with the original | collapse, \
         ranked again | cells | note | SOLID | RING |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let columns: [(Hosts, Finding); 7] = [
        (Hosts::Random, Finding::Traced),
        (Hosts::Ranked(Ranking::Literal), Finding::Traced),
        (Hosts::Ranked(Ranking::Integrated), Finding::Traced),
        (Hosts::Ranked(Ranking::Collapse), Finding::Traced),
        (Hosts::Ranked(Ranking::Collapse), Finding::Original),
        (Hosts::Ranked(Ranking::Collapse), Finding::Ranked),
        (Hosts::All, Finding::Cells),
    ];
    let marks: [MarkOf; 3] = [|row| &row.note, |row| &row.solid, |row| &row.ring];
    let mut rows = Vec::new();
    let mut lost = String::new();
    for smoothing in Smoothing::ALL {
        for iterations in 1..=2 {
            let of_errors = |(hosts, finding), value: Value| {
                mean(outcomes.iter().filter_map(|outcome| {
                    let here = outcome
                        .errors
                        .iter()
                        .filter(|errors| errors.smoothing == smoothing);
                    let here: Vec<Errors> = here.cloned().collect();
                    find(&here, hosts, finding, iterations, STRENGTH).map(value)
                }))
            };
            let here = |outcome: &&Outcome| {
                let mut rows = outcome.smoothed.iter();
                rows.position(|row| (row.smoothing, row.iterations) == (smoothing, iterations))
            };
            let smoothed: Vec<(&str, &Smoothed)> = outcomes
                .iter()
                .filter_map(|outcome| Some((&*outcome.name, &outcome.smoothed[here(outcome)?])))
                .collect();
            let moved = smoothed.iter().map(|(_, row)| row.moved_rel).collect();
            let _ = write!(
                text,
                "| {} | {iterations} | {} |",
                smoothing.name(),
                median(moved, 3, 100.0)
            );
            for column in columns {
                let _ = match of_errors(column, |errors| errors.payload.mean) {
                    Some(ber) => write!(text, " {ber:.2} |"),
                    None => write!(text, " |"),
                };
            }
            let mut shares: Vec<Option<f64>> = columns
                .iter()
                .map(|&column| of_errors(column, |errors| errors.read))
                .collect();
            for (mark, name) in marks.iter().zip(["note", "SOLID", "RING"]) {
                let reads = smoothed.iter().map(|(_, row)| mark(row));
                let right = reads.clone().flatten().filter(|read| read.is_right).count();
                let ln_ps = reads.clone().flatten().map(|read| read.ln_p).collect();
                let _ = write!(
                    text,
                    " {right}/{} ({}) |",
                    smoothed.len(),
                    median(ln_ps, 0, 1.0)
                );
                shares.push(Some(right as f64 / smoothed.len().max(1) as f64));
                let failures: Vec<&str> = smoothed
                    .iter()
                    .filter(|(_, row)| !mark(row).as_ref().is_ok_and(|read| read.is_right))
                    .map(|(model, _)| *model)
                    .collect();
                if !failures.is_empty() {
                    let _ = writeln!(
                        lost,
                        "| {} | {iterations} | {name} | {} |",
                        smoothing.name(),
                        failures.join(", ")
                    );
                }
            }
            text.push('\n');
            rows.push(Row {
                name: format!("{} {iterations}", smoothing.name()),
                values: shares,
            });
        }
    }
    let _ = write!(
        text,
        "\n<details><summary>Models whose note or mark was not read</summary>\n\n| smoothing | I | what | models |\n|---|--:|---|---|\n{lost}\n</details>\n"
    );
    let refused: Vec<String> = outcomes
        .iter()
        .filter_map(|outcome| Some((&outcome.name, outcome.smoothed.first()?)))
        .flat_map(|(model, row)| {
            let names = marks.iter().zip(["note", "SOLID", "RING"]);
            names.filter_map(move |(mark, name)| {
                let error = mark(row).as_ref().err()?;
                Some(format!("{name} in {model} ({error})"))
            })
        })
        .collect();
    if !refused.is_empty() {
        let _ = writeln!(text, "\nNot embedded at all: {}.", refused.join("; "));
    }
    let plot = grid(
        "Share of texts and marks that are read after every smoothing",
        &[
            "random, traced",
            "literal, traced",
            "integrated, traced",
            "collapse, traced",
            "collapse, original",
            "collapse, again",
            "cells, blind",
            "note, blind",
            "SOLID, blind",
            "RING, blind",
        ],
        &rows,
    );
    ("smoothings.svg".to_owned(), plot)
}

fn layers(text: &mut String, outcomes: &[&Outcome]) {
    text.push_str(
        "\n## Multiple watermarking\n\n\
         The paper names it a threat: a second mark damages the first. A note and a mark (SOLID with RING on top, *strong*) of one key, in simplified \
         meshes: each alone, and both in either order. RMS: displacement by all that was written. Medians; failures are named.\n\n\
         | written | I | RMS, % | note read | ln p, note | mark read | ln p, mark | ln p, SOLID | ln p, RING | failures |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|---|\n",
    );
    for order in ORDERS {
        for iterations in [0, 1] {
            let here: Vec<(&str, &Result<Layers, String>)> = outcomes
                .iter()
                .flat_map(|outcome| {
                    let layers = outcome.layers.iter();
                    let here = layers
                        .filter(|layer| (layer.order, layer.iterations) == (order, iterations));
                    here.map(|layer| (&*outcome.name, &layer.read))
                })
                .collect();
            let read = || here.iter().filter_map(|(_, read)| read.as_ref().ok());
            let middle = |of: fn(&Layers) -> f64, decimals, unit| {
                median(read().map(of).collect(), decimals, unit)
            };
            let has = |part| order.contains(part);
            let share = |part, is_right: fn(&Layers) -> bool, of: fn(&Layers) -> f64| {
                if has(part) {
                    let right = read().filter(|layers| is_right(layers)).count();
                    format!("{right}/{} | {}", here.len(), middle(of, 0, 1.0))
                } else {
                    " | ".to_owned()
                }
            };
            let failures: Vec<String> = here
                .iter()
                .filter_map(|(model, read)| match read {
                    Err(error) => Some(format!("{model}: {error}")),
                    Ok(layers) if has("note") && !layers.note.is_right => {
                        Some(format!("{model}: note"))
                    }
                    Ok(layers) if has("mark") && !layers.is_found => Some(format!("{model}: mark")),
                    Ok(_) => None,
                })
                .collect();
            let carriers = if has("mark") {
                format!(
                    "{} | {}",
                    middle(|layers| layers.ln_p_solid, 0, 1.0),
                    middle(|layers| layers.ln_p_ring, 0, 1.0)
                )
            } else {
                " | ".to_owned()
            };
            let _ = writeln!(
                text,
                "| {order} | {iterations} | {} | {} | {} | {carriers} | {} |",
                middle(|layers| layers.rms_rel, 3, 100.0),
                share(
                    "note",
                    |layers| layers.note.is_right,
                    |layers| layers.note.ln_p
                ),
                share("mark", |layers| layers.is_found, |layers| layers.ln_p),
                failures.join(", ")
            );
        }
    }
}

const OURS: &str = "
## What is the paper's, and what is ours

* The paper's: eqs 1 to 7, the run lengths (0 is two, 1 is three), hosts in decreasing order of stability, the criteria's names, MeshSmooth at one and two
  iterations, a thousand hosts, 11732 faces, Table I. Its counts of vertices, 5870, 35200 and 140788, are Catmull and Clark's V' = V + E + F exactly.
* Not in the paper, and so our interpretation: the weights of the criteria (three rankings, [GLOSSARY](GLOSSARY.md)), the length L of the sparse vectors (3), the
  step (the one that gives the RMS displacement which is named), the LDPC code (CCSDS TC128, min-sum), the channel that the run-length decoder takes
  for granted (1 in 1000 lost, 1 in 1000 gained), what counts as found again, and the axis of Fig. 5. The paper's models are not public; *horse-like* is
  the cow where there is no horse.
* Ours alone: ranking by collapse cost, the barycentres of area and volume, cells and notes, SOLID and RING.
";

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// A fraction in percent, as few digits as it has.
fn percent(fraction: f64) -> f64 {
    (fraction * 1e6).round() / 1e4
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::super::layers::Layer;
    use super::*;
    use meshmark::internals::mesh::shapes;
    use meshmark::internals::paper::study;
    use meshmark::internals::progress::ignore;

    /// A mesh that is just large enough; its marks are made up.
    fn outcome(name: &str) -> Outcome {
        let study = study(&shapes::asteroid(30, 45), 5, 1, &mut ignore).unwrap();
        let read = Read {
            is_right: true,
            ln_p: -123.0,
        };
        let errors = &study.figure_5.against_smoothing;
        Outcome {
            name: name.to_owned(),
            vertices: 5000,
            faces: 10_000,
            from_volume: study.figure_5.clone(),
            errors: errors.clone(),
            smoothed: vec![Smoothed {
                smoothing: Smoothing::MeshSmooth,
                iterations: 1,
                moved_rel: 0.00123,
                solid: Ok(read),
                ring: Err("too small".to_owned()),
                note: Ok(Read {
                    is_right: false,
                    ln_p: 0.0,
                }),
            }],
            unprepared: errors.last().unwrap().clone(),
            layers: vec![Layer {
                order: ORDERS[2],
                iterations: 0,
                read: Ok(Layers {
                    rms_rel: 0.001,
                    note: read,
                    is_found: false,
                    ln_p: 0.0,
                    ln_p_solid: -4.0,
                    ln_p_ring: -3.0,
                }),
            }],
            optimized: study.clone(),
            simplified: study,
        }
    }

    #[test]
    fn what_is_measured_is_in_the_document() {
        let results = [
            ("pebble".to_owned(), Ok(outcome("pebble"))),
            ("grain".to_owned(), Err("too few hosts".to_owned())),
        ];
        let (text, plots) = document(&results, &Seed::new(5), 1);
        for part in [
            "--seed 5`",
            "| pebble | 5000 | 10000 | 1352, 2700 | 1352, 2700 |",
            "| grain | not studied: too few hosts |",
            "| pebble | 0 | 1352 | 1352 +- 0 | 1352 to 1352 | 1352 (1.00) |",
            "| collapse | traced | 0.00 / 0.00 |",
            "| 0/1 (0) | 1/1 (-123) | 0/1 () |",
            "| meshSmooth | 1 | note | pebble |",
            "Not embedded at all: RING in pebble (too small).",
            "| note, then mark | 0 | 0.100 | 1/1 | -123 | 0/1 | 0 | -4 | -3 | pebble: mark |",
        ] {
            assert!(text.contains(part), "{part} is not in {text}");
        }
        // Of statements on bunnies there is none to say.
        assert!(
            text.lines()
                .any(|line| line.contains("1.27") && line.ends_with("| no such model |"))
        );
        // Every table's rows have as many cells as its head.
        for table in text.split("\n\n") {
            let mut rows = table.lines().filter(|line| line.starts_with('|'));
            let cells = |row: &str| row.matches('|').count();
            let head = rows.next().map(cells);
            assert!(rows.all(|row| Some(cells(row)) == head), "{table}");
        }
        for (name, svg) in plots {
            assert!(text.contains(&format!("(study/{name})")), "{name} is shown");
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{svg}");
        }
    }
}
