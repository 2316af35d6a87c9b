//! Runs the study.

use super::layers::{Layer, layers};
use super::note::{Read, read_note, text};
use crate::models::{Model, gathered};
use crate::seed::Seed;
use meshmark::internals::geometry::Distortion;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::paper::Barycentre;
use meshmark::internals::paper::figure_5::{
    Case, Errors, Figure5, Hosts, STRENGTH, errors, figure_5, smoothings,
};
use meshmark::internals::paper::{Preparation, Smoothing, Study, study};
use meshmark::internals::progress::ignore;
use meshmark::internals::scene::to_glb;
use meshmark::{Carrier, EmbedOptions, Strength, Verdict, detect, embed, embed_note};
use rayon::prelude::*;
use std::ops::Range;

/// What was measured on one model.
pub struct Outcome {
    pub name: String,
    pub vertices: usize,
    pub faces: usize,
    /// As the paper's: prepared by a face threshold.
    pub optimized: Study,
    /// Prepared by quadric error metrics.
    pub simplified: Study,
    /// The second with distances from the centroid of the volume instead of the paper's mean of vertices.
    pub from_volume: Figure5,
    /// Every smoothing of the second.
    pub errors: Vec<Errors>,
    pub smoothed: Vec<Smoothed>,
    /// Cells in the model as it came, after MeshSmooth 1.
    pub unprepared: Errors,
    pub layers: Vec<Layer>,
}

/// What one smoothing does to this project's marks.
pub struct Smoothed {
    pub smoothing: Smoothing,
    pub iterations: u32,
    /// RMS displacement of the vertices that were there before, as a fraction of the diagonal.
    pub moved_rel: f64,
    pub solid: Result<Read, String>,
    pub ring: Result<Read, String>,
    pub note: Result<Read, String>,
}

/// Studies a model on all cores.
pub fn outcome(model: &Model, seed: &Seed, num_keys: u32) -> Result<Outcome, String> {
    let number = seed.number(&model.name, 0) >> 32;
    let keys = number..number + u64::from(num_keys);
    let host = gathered(&model.bytes)?;
    let [optimized, simplified] = Preparation::ALL.map(|preparation| preparation.apply(&host));
    let studied = |mesh: &Mesh| study(mesh, number, num_keys, &mut ignore).map_err(said);
    let ((studies, from_volume), (errors, (smoothed, (unprepared, layers)))) = rayon::join(
        || {
            rayon::join(
                // A mesh that is small enough is left as it is by both.
                || {
                    rayon::join(
                        || (optimized != simplified).then(|| studied(&optimized)),
                        || studied(&simplified),
                    )
                },
                || figure_5(&simplified, Barycentre::Volume, keys.clone(), &mut ignore),
            )
        },
        || {
            rayon::join(
                || smoothings(&simplified, Barycentre::Vertices, keys.clone(), &mut ignore),
                || {
                    rayon::join(
                        || marks(&simplified, model, seed),
                        || {
                            rayon::join(
                                || in_cells(&host, keys.clone()),
                                || layers(&to_glb(&simplified), &model.name, seed),
                            )
                        },
                    )
                },
            )
        },
    );
    let simplified = studies.1?;
    Ok(Outcome {
        name: model.name.clone(),
        vertices: host.positions.len(),
        faces: host.triangles.len(),
        optimized: studies.0.unwrap_or_else(|| Ok(simplified.clone()))?,
        simplified,
        from_volume: from_volume.map_err(said)?,
        errors: errors.map_err(said)?,
        smoothed,
        unprepared: unprepared?,
        layers,
    })
}

fn said(error: impl std::fmt::Display) -> String {
    error.to_string()
}

fn in_cells(mesh: &Mesh, keys: Range<u64>) -> Result<Errors, String> {
    let case = Case {
        hosts: Hosts::All,
        barycentre: Barycentre::Volume,
        strength: STRENGTH,
        smoothing: Smoothing::MeshSmooth,
        iterations: 1,
    };
    let errors = errors(mesh, &case, keys, &mut ignore).map_err(said)?;
    errors.into_iter().next().ok_or_else(|| "no key".to_owned())
}

/// Marks of each sort in copies of their own, after every smoothing.
fn marks(mesh: &Mesh, model: &Model, seed: &Seed) -> Vec<Smoothed> {
    let bytes = to_glb(mesh);
    let key = seed.key(&model.name, 1);
    let payload = seed.payload(&model.name);
    let marked = |carrier: Carrier| {
        let options = EmbedOptions::default()
            .with_strength(Strength::STRONG)
            .with_carriers([carrier]);
        let embedding = embed(&bytes, payload, &key, &options);
        gathered(&embedding.map_err(said)?.model)
    };
    let text = text(seed, &model.name);
    let noted = || {
        let embedding = embed_note(&bytes, &text, &key);
        gathered(&embedding.map_err(said)?.model)
    };
    let copies = [marked(Carrier::Solid), marked(Carrier::Ring), noted()];
    let pairs = Smoothing::ALL.into_iter();
    let pairs: Vec<_> = pairs
        .flat_map(|smoothing| [(smoothing, 1), (smoothing, 2)])
        .collect();
    let read = |(smoothing, iterations): (Smoothing, u32)| {
        let suspect = |copy: &Result<Mesh, String>| {
            let copy = copy.as_ref().map_err(Clone::clone)?;
            Ok(to_glb(&smoothing.apply(copy, iterations)))
        };
        let mark = |copy| {
            suspect(copy).and_then(|bytes: Vec<u8>| {
                let read = detect(&bytes, &key, None).map_err(said)?;
                Ok(Read {
                    is_right: read.verdict == Verdict::Found
                        && read.number == Some(payload.number()),
                    ln_p: read.details().ln_p,
                })
            })
        };
        let [solid, ring, noted] = &copies;
        Smoothed {
            smoothing,
            iterations,
            moved_rel: moved(mesh, &smoothing.apply(mesh, iterations)),
            solid: mark(solid),
            ring: mark(ring),
            note: suspect(noted).and_then(|bytes| read_note(&bytes, &key, &text)),
        }
    };
    pairs.into_par_iter().map(read).collect()
}

/// RMS displacement of the vertices that both have: smoothing names new ones after them.
fn moved(before: &Mesh, after: &Mesh) -> f64 {
    let num_kept = before.positions.len().min(after.positions.len());
    Distortion::between(&before.positions[..num_kept], &after.positions[..num_kept]).rms_rel
}
