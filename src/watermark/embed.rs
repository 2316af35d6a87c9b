//! Embedding: a marked model, and the report of it.

use super::error::Advice;
use super::forecast::{forecast, is_fragile};
use super::marking::{Held, Marked, Recipe, WITHOUT_PAYLOAD, hold};
use super::{EmbedOptions, EmbedReport, Error, Extraction, Model, Strength};
use crate::bits::Payload;
use crate::carrier::Carrier;
use crate::detection::{LN_P_FOUND, union};
use crate::digest::sha256;
use crate::document::{Document, Files, Written};
use crate::geometry::{Bounds, Deformation, Distortion, diagonal};
use crate::key::Key;
use crate::scene::Scene;

/// A marked model.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Embedding {
    /// The main file: as the host's, but for positions and the bounds of their accessors.
    pub model: Vec<u8>,
    /// The external buffers that changed.
    pub files: Files,
    /// What was done, and what was read back.
    pub report: EmbedReport,
}

/// Marks a model with a payload under a key.
///
/// A carrier that the model is too small or too regular for is left out, if another can be used.
///
/// The marked bytes are read back and tested before they are returned.
///
/// # Errors
/// Where the model cannot be read or no carrier can be used; [`Error::Unreadable`] where the mark cannot be found again in the marked
/// bytes; [`Error::Cancelled`] where its progress was told to stop. Nothing is returned then.
pub fn embed<'a>(
    model: impl Into<Model<'a>>,
    payload: Payload,
    key: &Key,
    options: &EmbedOptions,
) -> Result<Embedding, Error> {
    embed_in(model.into(), payload, key, options).map(|(embedding, _)| embedding)
}

/// The same, and how it was done.
pub(super) fn embed_in(
    mut model: Model,
    payload: Payload,
    key: &Key,
    options: &EmbedOptions,
) -> Result<(Embedding, Recipe), Error> {
    if options.carriers.is_empty() {
        return Err(Error::NoCarrier);
    }
    if options.asked().is_some() && !options.carriers.contains(&Carrier::Solid) {
        return Err(Error::NoSolid);
    }
    let Held {
        payload,
        marked:
            Marked {
                host,
                parts,
                marked,
                written,
                unshown,
                strays,
                num_cuts,
                recipe,
            },
        read_back,
    } = match hold(&mut model, payload, key, options) {
        Err(refusal) if refusal.is_of_the_model() => {
            return Err(advised(refusal, &mut model, payload, key, options)?);
        }
        held => held?,
    };
    let distortion = Distortion::between(&host.positions, &marked.positions);
    let deformation = Deformation::between(&host, &parts, &marked.positions);
    let forecast = forecast(&host, &marked, &read_back, key, payload, &mut model)?;
    let is_fragile = is_fragile(&forecast);
    let about_asked = options
        .asked()
        .and_then(|asked| about_asked(asked, &recipe, &read_back));
    let report = EmbedReport {
        tag: payload.and_then(Payload::tag),
        number: payload.map(Payload::number),
        vertices: host.positions.len(),
        moved_vertices: distortion.num_moved,
        diagonal: diagonal(&host.positions),
        rms_rel: distortion.rms_rel,
        max_rel: distortion.max_rel,
        max_movement: distortion.max_rel * diagonal(&host.positions),
        worst_part_rel: deformation.worst_part,
        worst_turn_degrees: deformation.worst_turn,
        new_intersections: num_cuts,
        is_fragile,
        warnings: warnings(&deformation, payload, is_fragile)
            .into_iter()
            .chain(strays)
            .chain(unpacked(&written))
            .chain(larger(&model, &written))
            .chain(about_asked)
            .collect(),
        strength: options.strength.rms_rel(),
        unshown,
        read_back,
        forecast,
        host_sha256: sha256(model.bytes),
        marked_sha256: sha256(&written.model),
    };
    let embedding = Embedding {
        model: written.model,
        files: written.files,
        report,
    };
    Ok((embedding, recipe))
}

/// A refusal, with what would help: that is tried. Where the file's numbers are too coarse, they are the reason.
fn advised(
    refusal: Error,
    model: &mut Model,
    payload: Payload,
    key: &Key,
    options: &EmbedOptions,
) -> Result<Error, Error> {
    let document = Document::read(model.bytes, model.files)?;
    if let Some(coarse) = Scene::gather(&document)?.coarse(&document) {
        return Ok(coarse.into());
    }
    drop(document);
    let all = EmbedOptions::default().with_strength(options.strength);
    let is_given = |carrier: &Carrier| options.carriers.contains(carrier);
    let has_all = all.carriers.iter().all(is_given);
    let asked = options.strength.rms_rel();
    let at = |strength: Strength| options.clone().with_strength(strength);
    let (balanced, strong) = (Strength::BALANCED, Strength::STRONG);
    // Less movement can help too: what a strong mark deforms may be what its frame is found by.
    let ways = [
        (!has_all, Advice::AllCarriers, all),
        (asked < strong.rms_rel(), Advice::Strong, at(strong)),
        (asked > balanced.rms_rel(), Advice::Balanced, at(balanced)),
    ];
    let mut advice = Advice::Nothing;
    for (is_another, way, options) in ways {
        if is_another && helps(model, payload, key, &options)? {
            advice = way;
            break;
        }
    }
    Ok(Error::Refused {
        refusal: Box::new(refusal),
        advice,
    })
}

/// Whether the model can be marked with these options.
fn helps(
    model: &mut Model,
    payload: Payload,
    key: &Key,
    options: &EmbedOptions,
) -> Result<bool, Error> {
    match hold(model, payload, key, options) {
        Err(other) if other.is_of_the_model() => Ok(false),
        held => held.map(|_| true),
    }
}

/// What is said of a carrier that was asked for and is not there.
fn about_asked(asked: Carrier, recipe: &Recipe, read_back: &Extraction) -> Option<String> {
    let name = asked.name().to_uppercase();
    if recipe.shown.iter().all(|used| used.carrier != asked) {
        return Some(format!(
            "{name} was left out: too few places of the model are salient enough to be found again in a piece of it"
        ));
    }
    let mut carriers = read_back.details().carriers.iter();
    let is_read = carriers.any(|read| {
        read.name == asked && union(read.ln_p, -libm::log(asked.share())) <= LN_P_FOUND
    });
    (!is_read).then(|| {
        format!(
            "{name} is in the model, but is not found in it as it is: mark the model without it"
        )
    })
}

/// What is said of a model that is not compressed as its host was.
pub(super) fn unpacked(written: &Written) -> Vec<String> {
    let extensions = written.unpacked.iter();
    let words = extensions.map(|name| {
        format!("the host is compressed ({name}), and the copy is not: compress it again, and check what comes of it")
    });
    words.collect()
}

/// A compressed copy may be so much larger than its host before the report says so.
const LARGER: f64 = 0.03;

/// What is said of a compressed copy that is noticeably larger than its host.
fn larger(host: &Model, written: &Written) -> Option<String> {
    // The bounds of a small plain model may take more digits, which is no codec's doing.
    if !written.is_packed {
        return None;
    }
    let changed = |files: &Files| -> usize {
        let buffers = written.files.keys().filter_map(|name| files.get(name));
        buffers.map(|buffer| buffer.len()).sum()
    };
    let before = host.bytes.len() + changed(host.files);
    let after = written.model.len() + changed(&written.files);
    let growth = after as f64 / before as f64 - 1.0;
    (growth > LARGER).then(|| {
        format!(
            "the copy is {:.1} % larger than its host: where vertices lie in a regular way a codec needs few bytes, and a mark disturbs that",
            100.0 * growth
        )
    })
}

/// What its owner should know of a mark: that it holds no payload, that the usual steps of a web pipeline take it, and what may be seen
/// of it, which is more than the strong strength's deformation.
fn warnings(deformation: &Deformation, payload: Option<Payload>, is_fragile: bool) -> Vec<String> {
    let bounds = Bounds::STRONG;
    let mut warnings = Vec::new();
    if payload.is_none() {
        warnings.push(WITHOUT_PAYLOAD.to_owned());
    }
    if is_fragile {
        warnings.push(
            "the mark is fragile: rounding positions as web pipelines do takes it, so only copies as they are will show it".to_owned(),
        );
    }
    if deformation.worst_part > 2.0 * bounds.part {
        warnings.push(format!(
            "a part of the model is deformed by {:.1} % of its own size: look at it, or take a smaller strength",
            100.0 * deformation.worst_part
        ));
    }
    if deformation.worst_turn > bounds.turn {
        warnings.push(format!(
            "a triangle turned by {:.0} degrees: look at it, or take a smaller strength",
            deformation.worst_turn
        ));
    }
    warnings
}
