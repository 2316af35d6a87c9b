//! What the study is held against, and whether it is so.

use super::measure::Outcome;
use meshmark::internals::paper::Ranking;
use meshmark::internals::paper::figure_5::{Errors, Figure5, Finding, Hosts, STRENGTH};
use meshmark::internals::paper::{HostsRow, Rule, RuleCounts};

/// The paper's OSVETA over the chance of the index rule, in the mean: what the literal ranking has to match.
const LITERAL: f64 = 1.27;
const WITHIN: f64 = 0.15;
/// What better rankings have to beat.
const RATIO: f64 = 2.0;
/// Payload errors between these are chance.
const CHANCE: std::ops::RangeInclusive<f64> = 0.4..=0.6;

pub struct Statement {
    pub text: String,
    /// Parts of the names of the models that it is made of; all, where there are none.
    pub asked: &'static [&'static str],
    /// A number, and whether the statement is true.
    pub check: fn(&Outcome) -> Option<(f64, bool)>,
}

impl Statement {
    pub fn is_asked(&self, model: &str) -> bool {
        self.asked.is_empty() || self.asked.iter().any(|part| model.contains(part))
    }
}

pub fn statements() -> Vec<Statement> {
    let statement = |text: &str, asked, check| Statement {
        text: text.to_owned(),
        asked,
        check,
    };
    vec![
        statement(
            "Table I, optimized: literal ranking at I = 1 within 15 % of 1.27 times chance",
            &["bunny"],
            |outcome| {
                let index = counts(&outcome.optimized.table_1, 1, Rule::Index)?;
                let value = of(index, Ranking::Literal)? as f64 / index.chance?;
                Some((value, (value / LITERAL - 1.0).abs() <= WITHIN))
            },
        ),
        statement(
            "Table I, optimized: OSVETA/random at least 2.0 at I = 1 and 2, integrated ranking or collapse cost",
            &["bunny", "horse", "cow"],
            |outcome| best_ratio(&outcome.optimized.table_1),
        ),
        statement(
            "Table I, simplified: the same",
            &["bunny", "horse", "cow"],
            |outcome| best_ratio(&outcome.simplified.table_1),
        ),
        statement(
            "Fig. 5, simplified: payload BER 0, traced, at I = 1 and 2, all hosts",
            &[],
            |outcome| traced(&outcome.simplified.figure_5),
        ),
        statement("Fig. 5, optimized: the same", &[], |outcome| {
            traced(&outcome.optimized.figure_5)
        }),
        statement(
            "Fig. 5, simplified, distances from the centroid of the volume: the same",
            &[],
            |outcome| traced(&outcome.from_volume),
        ),
        statement(
            "Fig. 5, simplified: ranking again is at chance, payload BER 0.4 to 0.6, without any attack",
            &[],
            |outcome| {
                let again: Vec<&Errors> = outcome
                    .simplified
                    .figure_5
                    .against_smoothing
                    .iter()
                    .filter(|errors| errors.iterations == 0 && errors.finding == Finding::Ranked)
                    .collect();
                let mean = again.iter().map(|errors| errors.payload.mean).sum::<f64>()
                    / again.len() as f64;
                let is_unread = again.iter().all(|errors| errors.read == 0.0);
                Some((mean, CHANCE.contains(&mean) && is_unread))
            },
        ),
        statement(
            "Cells: BER 0 after MeshSmooth 1, the model as it came",
            &["bunny", "rocker-arm"],
            |outcome| {
                let value = outcome.unprepared.payload.mean;
                Some((value, value == 0.0))
            },
        ),
        statement(
            "Cells: the same, simplified",
            &["bunny", "rocker-arm"],
            |outcome| {
                let figure = &outcome.simplified.figure_5.against_smoothing;
                let value = find(figure, Hosts::All, Finding::Cells, 1, STRENGTH)?
                    .payload
                    .mean;
                Some((value, value == 0.0))
            },
        ),
    ]
}

/// The counts of a rule after so many iterations.
pub fn counts(table: &[HostsRow], iterations: u32, rule: Rule) -> Option<&RuleCounts> {
    let row = table.iter().find(|row| row.iterations == iterations)?;
    row.rules.iter().find(|counts| counts.rule == rule)
}

/// The errors of hosts that were found in a way.
pub fn find(
    errors: &[Errors],
    hosts: Hosts,
    finding: Finding,
    iterations: u32,
    strength: f64,
) -> Option<&Errors> {
    errors.iter().find(|errors| {
        (
            errors.hosts,
            errors.finding,
            errors.iterations,
            errors.strength,
        ) == (hosts.name(), finding, iterations, strength)
    })
}

fn of(counts: &RuleCounts, ranking: Ranking) -> Option<usize> {
    let mut ranked = counts.ranked.iter();
    ranked
        .find(|count| count.ranking == ranking)
        .map(|count| count.count)
}

/// Of the better ranking, the lower ratio of both iterations.
fn best_ratio(table: &[HostsRow]) -> Option<(f64, bool)> {
    let lower = |ranking| {
        [1, 2].into_iter().fold(f64::INFINITY, |least, iterations| {
            let ratio = counts(table, iterations, Rule::Index).and_then(|index| {
                let mut ranked = index.ranked.iter();
                ranked.find(|count| count.ranking == ranking)?.ratio
            });
            least.min(ratio.unwrap_or(0.0))
        })
    };
    let value = f64::max(lower(Ranking::Integrated), lower(Ranking::Collapse));
    Some((value, value >= RATIO))
}

/// The largest payload error of hosts that were traced.
fn traced(figure: &Figure5) -> Option<(f64, bool)> {
    let traced = figure
        .against_smoothing
        .iter()
        .filter(|errors| errors.finding == Finding::Traced && errors.iterations > 0);
    let value = traced.map(|errors| errors.payload.mean).reduce(f64::max)?;
    Some((value, value == 0.0))
}
