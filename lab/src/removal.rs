//! The least of an attack that removes a mark, and what it costs.

use crate::case::Case;
use meshmark::internals::attack::{noise, quantize, similarity, simplify, smooth_inside, warp};
use meshmark::internals::geometry::Quality;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::to_glb;
use meshmark::{Verdict, extract, measure};
use serde::{Deserialize, Serialize};
use std::iter::successors;

/// An attack that can be as strong as one likes.
pub struct Means {
    pub name: &'static str,
    pub unit: &'static str,
    /// Weakest first.
    levels: Vec<f64>,
    apply: fn(&Mesh, f64, u64) -> Mesh,
}

/// What removed a mark.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Removal {
    pub model: String,
    pub strength: String,
    pub means: String,
    /// The weakest level that did, and what it made of the model; none if not even the strongest did.
    pub weakest: Option<(f64, Quality)>,
}

pub fn means() -> Vec<Means> {
    let means = |name, unit, levels, apply| Means {
        name,
        unit,
        levels,
        apply,
    };
    vec![
        means("noise", " %", ladder(0.1, 10.0), |m, x, seed| {
            noise(m, x / 100.0, seed)
        }),
        means("Laplacian", " times", ladder(10.0, 2000.0), |m, x, _| {
            smooth_inside(m, 0.1, x as u32)
        }),
        means(
            "quantize",
            " bits",
            (3..=10).rev().map(f64::from).collect(),
            |m, x, _| quantize(m, x as u32),
        ),
        means(
            "simplify to one face of",
            "",
            ladder(2.0, 500.0),
            |m, x, _| simplify(m, 1.0 - 1.0 / x),
        ),
        means(
            "warp of wavelength 5 %",
            " % RMS",
            ladder(0.02, 2.0),
            |m, x, seed| warp(m, 0.05, x / 100.0, seed),
        ),
        means(
            "warp of wavelength 10 %",
            " % RMS",
            ladder(0.02, 2.0),
            |m, x, seed| warp(m, 0.1, x / 100.0, seed),
        ),
    ]
}

/// Levels of equal ratio, a quarter more each.
fn ladder(from: f64, to: f64) -> Vec<f64> {
    successors(Some(from), |level| Some(level * 1.25))
        .take_while(|&level| level <= to)
        .collect()
}

/// The weakest level at which the mark is not found any more, by bisection: as if what is stronger always removed more.
pub fn removal(case: &Case, means: &Means) -> Result<Removal, String> {
    let marked = &case.marked.as_ref().map_err(Clone::clone)?.mesh;
    let purpose = format!("{}, removal by {}", case.purpose, means.name);
    let seed = case.seed.number(&purpose, 0);
    let attacked = |place: usize| (means.apply)(marked, means.levels[place], seed);
    let is_found = |place: usize| {
        let suspect = similarity(&attacked(place), seed);
        // A model without geometry is no copy any more.
        measure(&to_glb(&suspect))
            .is_ok_and(|evidence| extract(&evidence, &case.key).verdict == Verdict::Found)
    };
    let (mut found, mut removed) = (0, means.levels.len());
    while found < removed {
        let middle = (found + removed) / 2;
        if is_found(middle) {
            found = middle + 1;
        } else {
            removed = middle;
        }
    }
    let weakest = means.levels.get(removed).map(|&level| {
        let quality = Quality::between(marked, &attacked(removed));
        (level, quality)
    });
    Ok(Removal {
        model: case.model.name.clone(),
        strength: case.strength_name.to_owned(),
        means: means.name.to_owned(),
        weakest,
    })
}
