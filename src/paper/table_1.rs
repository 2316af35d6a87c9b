//! Table I: how many host vertices are found again after smoothing, chosen at random and by each ranking.
//!
//! The paper gives one number a column and does not say how it counts. Its column of one iteration is within reach of
//! [`Rule::Index`]: 968 at random, where that rule's chance level is 979, and 1316 by OSVETA, 1.34 times that. How near
//! [`Ranking::Literal`] comes depends on how the mesh was prepared: on the Stanford bunny 1.32 times after
//! [`Preparation::Optimize`](super::Preparation::Optimize), 1.87 times after
//! [`Preparation::Simplify`](super::Preparation::Simplify). Meshes that hardly had to be simplified differ more, and no rule
//! fits both columns.

use super::smoothing::Smoothing;
use super::spread::Spread;
use super::stability::{Ranking, ranked};
use crate::mesh::Mesh;
use crate::order::order_by;
use crate::random::Random;
use glam::DVec3;

/// What counts as found again, for a mesh of N vertices that has N' after smoothing.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "camelCase")]
pub enum Rule {
    /// Of all N' vertices the best N are selected; those of them count that were vertices before, by their index.
    Index,
    /// Of all N' vertices the best N are selected; the vertices before count that have one of them near where they were.
    Region,
    /// Of the best hosts before, those count that are among as many best hosts afterwards: what blind detection has to go on.
    Overlap,
}

/// How the study counts.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct HostsOptions {
    /// Draws of random hosts. Default 20.
    pub draws: u32,
    /// What they are drawn with, and equals are put in order with. Default 1.
    pub seed: u64,
    /// Hosts of the overlap rule. Default 1000, as in the paper.
    pub num_hosts: u32,
    /// How near is near for the region rule, in mean edges of the mesh before. Default 0.2.
    pub tau: f64,
}

impl Default for HostsOptions {
    fn default() -> HostsOptions {
        HostsOptions {
            draws: 20,
            seed: 1,
            num_hosts: 1000,
            tau: 0.2,
        }
    }
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct HostsRow {
    /// How the mesh was smoothed.
    pub smoothing: Smoothing,
    /// How often.
    pub iterations: u32,
    /// N.
    pub num_vertices_before: usize,
    /// N'.
    pub num_vertices: usize,
    /// By rule.
    pub rules: Vec<RuleCounts>,
}

/// Counts by one rule.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct RuleCounts {
    /// The rule.
    pub rule: Rule,
    /// What random hosts come to by arithmetic; absent for the region rule, which depends on the shape.
    pub chance: Option<f64>,
    /// What random hosts came to.
    pub random: Spread,
    /// What each ranking comes to.
    pub ranked: Vec<Count>,
}

/// The count of a ranking.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Count {
    /// The ranking.
    pub ranking: Ranking,
    /// Hosts found again.
    pub count: usize,
    /// That over the mean of random ones, the paper's OSVETA/random; absent where random hosts are never found.
    pub ratio: Option<f64>,
}

/// One row of Table I. O(N' log N') for each ranking, and O(N') for each draw.
pub fn hosts(
    mesh: &Mesh,
    smoothing: Smoothing,
    iterations: u32,
    options: &HostsOptions,
) -> HostsRow {
    let smoothed = smoothing.apply(mesh, iterations);
    let (before, after) = (mesh.positions.len(), smoothed.positions.len());
    let near = Near::new(mesh, &smoothed, options.tau * mesh.mean_edge());
    let num_hosts = (options.num_hosts as usize).min(before);
    let counts = |order_before: &[u32], order_after: &[u32]| {
        let is_among = |order: &[u32], count: usize| {
            let mut among = vec![false; after];
            order
                .iter()
                .take(count)
                .for_each(|&v| among[v as usize] = true);
            among
        };
        let selected = is_among(order_after, before);
        let best = is_among(order_after, num_hosts);
        let hosts = order_before.iter().take(num_hosts);
        [
            (
                Rule::Index,
                selected.iter().take(before).filter(|&&is| is).count(),
            ),
            (Rule::Region, near.count(&selected)),
            (Rule::Overlap, hosts.filter(|&&v| best[v as usize]).count()),
        ]
    };
    let mut random = Random::new(options.seed);
    let drawn: Vec<_> = (0..options.draws)
        .map(|_| counts(&random.permutation(before), &random.permutation(after)))
        .collect();
    let by_ranking = Ranking::ALL.map(|ranking| {
        let [before, after] = [mesh, &smoothed].map(|mesh| ranked(mesh, ranking, random.bits()));
        (ranking, counts(&before, &after))
    });
    let chance = |rule: Rule, count: usize| {
        let chance = count as f64 * count as f64 / after.max(1) as f64;
        (rule != Rule::Region).then_some(chance)
    };
    let rule_counts = |(place, (rule, count)): (usize, (Rule, usize))| {
        let draws: Vec<f64> = drawn.iter().map(|counts| counts[place].1 as f64).collect();
        let spread = Spread::of(&draws);
        RuleCounts {
            rule,
            chance: chance(rule, count),
            random: spread,
            ranked: by_ranking
                .iter()
                .map(|(ranking, counts)| Count {
                    ranking: *ranking,
                    count: counts[place].1,
                    ratio: (spread.mean > 0.0).then(|| counts[place].1 as f64 / spread.mean),
                })
                .collect(),
        }
    };
    let rules = [
        (Rule::Index, before),
        (Rule::Region, before),
        (Rule::Overlap, num_hosts),
    ];
    HostsRow {
        smoothing,
        iterations,
        num_vertices_before: before,
        num_vertices: after,
        rules: rules.into_iter().enumerate().map(rule_counts).collect(),
    }
}

/// For each vertex before smoothing, the vertices afterwards that are near where it was.
struct Near {
    ends: Vec<usize>,
    vertices: Vec<u32>,
}

impl Near {
    fn new(before: &Mesh, after: &Mesh, distance: f64) -> Near {
        let cell = |p: DVec3| (p / distance).floor();
        let order = order_by(after.positions.iter().map(|&p| key(cell(p))));
        let mut near = Near {
            ends: Vec::new(),
            vertices: Vec::new(),
        };
        for &position in &before.positions {
            for x in [-1.0, 0.0, 1.0] {
                for y in [-1.0, 0.0, 1.0] {
                    for z in [-1.0, 0.0, 1.0] {
                        let key = key(cell(position) + DVec3::new(x, y, z));
                        let first = order.partition_point(|entry| entry.0 < key);
                        let inside = order[first..].iter().take_while(|entry| entry.0 == key);
                        near.vertices
                            .extend(inside.map(|entry| entry.1).filter(|&v| {
                                after.positions[v as usize].distance(position) <= distance
                            }));
                    }
                }
            }
            near.ends.push(near.vertices.len());
        }
        near
    }

    /// Vertices that have a selected one near.
    fn count(&self, selected: &[bool]) -> usize {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        let lists = starts
            .zip(&self.ends)
            .map(|(start, &end)| &self.vertices[start..end]);
        lists
            .filter(|list| list.iter().any(|&v| selected[v as usize]))
            .count()
    }
}

/// A number for a cell, the same for cells that are 2^21 apart: distances tell those from each other.
fn key(cell: DVec3) -> u64 {
    let part = |x: f64| x as i64 as u64 & 0x1F_FFFF;
    part(cell.x) | part(cell.y) << 21 | part(cell.z) << 42
}
