//! Reading a suspect with the original at hand.

use super::judge::Judge;
use super::overlay::Overlay;
use super::report::{Comparison, Input, Shape, Verdict, Witness};
use super::weigh::{Scales, Spoken};
use super::{EmbedOptions, Error, Model, Suspect};
use crate::bits::Payload;
use crate::carrier::{Carrier, Frames, Host, Reading, Seen};
use crate::detection::{LN_P_FOUND, LN_P_TRACE};
use crate::document::Document;
use crate::geometry::{
    LEAST_NEAR, Leeway, Observation, Original, Registration, Search, Shown, Views, kept,
};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Progress, Stage};
use crate::scene::Scene;
use std::f64::consts::LN_2;

/// What is less near than this is not read.
const LEAST_READ: f64 = 0.5;
/// A whole copy that lies on the original as closely as this lies nowhere else.
const SURE: f64 = 0.9;

/// Reads a suspect with the original: the model as it was before it was marked, as [`embed`](crate::embed) got it.
///
/// A copy is found so that is found by [`detect`](crate::detect) no more: a piece with other triangles, a mirror image, one that was stretched, smoothed
/// or simplified. The answer also says whether the suspect has the original's shape at all. Its bound holds for an original and a suspect that were there
/// before the key, or were made without it: who holds the key can make an "original" that any model seems to be a copy of (docs/SECURITY.md).
///
/// # Errors
/// Where a file cannot be read, or holds no triangles; [`Error::Cancelled`] where the suspect's progress was told to stop.
pub fn compare<'a, 'b>(
    suspect: impl Into<Suspect<'a>>,
    original: impl Into<Model<'b>>,
    key: &Key,
) -> Result<Comparison, Error> {
    Ok(compare_in(suspect.into(), &original.into(), key)?.comparison)
}

/// As [`compare`], with the suspect laid on the original, to be looked at; `None` for another shape.
///
/// # Errors
/// As [`compare`].
pub fn compare_overlaid<'a, 'b>(
    suspect: impl Into<Suspect<'a>>,
    original: impl Into<Model<'b>>,
    key: &Key,
) -> Result<(Comparison, Option<Overlay>), Error> {
    Ok(compare_in(suspect.into(), &original.into(), key)?.overlaid())
}

/// A comparison, and what it was of.
pub(super) struct Compared {
    pub comparison: Comparison,
    pub original: Mesh,
    pub suspect: Mesh,
    pub spoken: Spoken,
}

impl Compared {
    pub(super) fn overlaid(self) -> (Comparison, Option<Overlay>) {
        let Compared {
            comparison,
            original,
            suspect,
            spoken,
        } = self;
        let is_heard = comparison
            .witness
            .is_some_and(|witness| witness != Witness::Blind);
        let is_same = comparison.shape == Shape::Same;
        let motion = comparison.motion.filter(|_| is_same);
        let overlay =
            motion.map(|m| Overlay::new(&original, &suspect, m, is_heard.then_some(&spoken)));
        (comparison, overlay)
    }
}

fn compare_in(mut suspect: Suspect, model: &Model, key: &Key) -> Result<Compared, Error> {
    suspect.step(Stage::Read, 0.0)?;
    let scene = Scene::gather(&Document::read(model.bytes, model.files)?)?;
    let mesh = suspect.mesh()?;
    suspect.step(Stage::Measure, 0.0)?;
    let heard = with_host(&scene, &options_of_original(), |host| {
        hear(host, &mesh, key, &mut suspect)
    })??;
    let blind = match heard.ln_p_payload <= LN_P_FOUND {
        true => None,
        false => Some(read_blind(&mesh, key, &mut suspect)?),
    };
    suspect.step(Stage::Test, 1.0)?;
    Ok(Compared {
        comparison: conclude(&heard, blind),
        original: scene.mesh,
        suspect: mesh,
        spoken: heard.spoken,
    })
}

/// How an original may have been marked: which strength it was does not matter much, for what counts is how vertices move together.
pub(super) fn options_of_original() -> EmbedOptions {
    EmbedOptions::default()
}

/// Does something with a scene as a host.
pub(super) fn with_host<T>(
    scene: &Scene,
    options: &EmbedOptions,
    then: impl FnOnce(&Host) -> T,
) -> Result<T, Error> {
    let parts = scene.parts();
    let leeway = Leeway::new(&scene.mesh, &parts, options.bounds()?);
    Ok(then(&Host {
        mesh: &scene.mesh,
        leeway: &leeway,
        admissible: &scene.admissible,
        rms_rel: options.strength.rms_rel(),
        hidden: options.strength.is_hidden(),
        share: 1.0,
        on_top: None,
    }))
}

/// What was read with the original, or with its record.
pub(super) struct Heard {
    pub ln_p_presence: f64,
    pub ln_p_payload: f64,
    pub payload: Option<Payload>,
    pub witness: Witness,
    /// The likeliest way in which the suspect lies on the original, and the one that was read.
    pub first: Option<Lay>,
    pub read: Option<Lay>,
    /// What windows said for the mark.
    pub spoken: Spoken,
}

/// How a suspect lies on the original.
#[derive(Clone, Copy)]
pub(super) struct Lay {
    pub registration: Registration,
    pub covered: f64,
}

/// The same, and what is seen of it.
struct Lying<'a> {
    registration: Registration,
    shown: Shown<'a>,
    kept: Option<Vec<Observation>>,
}

impl Lying<'_> {
    fn lay(&self) -> Lay {
        Lay {
            registration: self.registration,
            covered: self.shown.covered(),
        }
    }
}

/// Reads with the original, search after search, until it is sure.
fn hear(
    host: &Host,
    suspect: &Mesh,
    key: &Key,
    progress: &mut dyn Progress,
) -> Result<Heard, Error> {
    let original = Original::new(host.mesh);
    let views = Views::new(host.mesh);
    let frames = Frames::new(host);
    let mut reader = None;
    let mut scales = Scales::new(key);
    let mut first: Option<Lay> = None;
    let mut lyings: Vec<Lying> = Vec::new();
    // A half for reading without the original; and each search has a third of the other half, whether it is made or not.
    let ln_num_searches = LN_2 + libm::log(Search::ALL.len() as f64);
    for search in Search::ALL {
        let known = lyings.len();
        for registration in original.registrations(suspect, search) {
            let is_near = registration.near >= LEAST_READ;
            let shown = || Shown::new(&original, &views, suspect, &registration.motion);
            if let Some(shown) = is_near.then(shown).flatten() {
                let kept = kept(&original, suspect, &registration.motion);
                lyings.push(Lying {
                    registration,
                    shown,
                    kept,
                });
            }
        }
        let new = &lyings[known..];
        if let Some(lying) = new.first()
            && first.is_none_or(|first| first.registration.near < lying.registration.near)
        {
            first = Some(lying.lay());
        }
        let observe: Vec<_> = new.iter().flat_map(views_of).collect();
        let seen: Vec<&Seen> = observe.iter().map(|observe| &**observe).collect();
        let mut is_settled = false;
        if !seen.is_empty() {
            let reader = reader.get_or_insert_with(|| frames.with_key(key));
            reader.read(&seen, progress, &mut |mut way| {
                way.list += 2 * known;
                way.ln_num_tests += ln_num_searches;
                is_settled = scales.hear(&way);
                is_settled
            })?;
        }
        let is_sure = |lying: &Lying| {
            lying.registration.exact > SURE && lying.shown.covered() > SURE && known == 0
        };
        if is_settled || new.first().is_some_and(is_sure) {
            break;
        }
    }
    Ok(Heard {
        ln_p_presence: scales.ln_p_presence,
        ln_p_payload: scales.ln_p_payload,
        payload: scales.payload,
        witness: match scales.list % 2 {
            0 => Witness::Surface,
            _ => Witness::Vertices,
        },
        first,
        read: lyings.get(scales.list / 2).map(Lying::lay),
        spoken: scales.spoken,
    })
}

/// The two ways to look at a suspect that lies on the original: at its surface, and at the vertices that it kept.
fn views_of<'a>(lying: &'a Lying) -> [Box<Seen<'a>>; 2] {
    [
        Box::new(|radius| lying.shown.observations(radius)),
        Box::new(|_| lying.kept.clone().unwrap_or_default()),
    ]
}

/// Reads without the original, at half of the probability of a false alarm.
pub(super) fn read_blind(
    mesh: &Mesh,
    key: &Key,
    progress: &mut dyn Progress,
) -> Result<Blind, Error> {
    let judge = Judge::new(key, None, Input::Model).one_of(2);
    let mut readings = Carrier::STANDARD.map(|_| Default::default());
    for carrier in Carrier::QUICKEST_FIRST {
        let is_settled = |reading: &Reading| judge.is_settled(reading);
        readings[carrier as usize] = carrier.read_until(mesh, key, &is_settled, progress)?;
    }
    let read = judge.conclude(&readings);
    Ok(Blind {
        verdict: read.verdict,
        number: read.number,
        ln_p: read.details().ln_p,
    })
}

pub(super) struct Blind {
    verdict: Verdict,
    number: Option<u64>,
    ln_p: f64,
}

/// One answer. What is said of the shape follows no key, unless the mark is found.
pub(super) fn conclude(heard: &Heard, blind: Option<Blind>) -> Comparison {
    let own = match heard {
        _ if heard.ln_p_payload <= LN_P_FOUND => (Verdict::Found, heard.ln_p_payload),
        _ if heard.ln_p_presence <= LN_P_FOUND => (Verdict::Present, heard.ln_p_presence),
        _ if heard.ln_p_presence.min(heard.ln_p_payload) <= LN_P_TRACE => (
            Verdict::Partial,
            heard.ln_p_presence.min(heard.ln_p_payload),
        ),
        _ => (Verdict::None, heard.ln_p_presence.min(heard.ln_p_payload)),
    };
    let rank = |verdict: Verdict| match verdict {
        Verdict::Found => 3,
        Verdict::Present => 2,
        Verdict::Partial => 1,
        _ => 0,
    };
    let is_said = |verdict: Verdict| rank(verdict) >= 2;
    let (verdict, ln_p, payload, witness) = match blind {
        Some(blind) if rank(blind.verdict) > rank(own.0) => (
            blind.verdict,
            blind.ln_p,
            blind.number.and_then(|n| Payload::from_number(n).ok()),
            Witness::Blind,
        ),
        _ => {
            let payload = heard.payload.filter(|_| own.0 == Verdict::Found);
            (own.0, own.1, payload, heard.witness)
        }
    };
    let is_read = is_said(verdict) && witness != Witness::Blind;
    let lay = if is_read { heard.read } else { heard.first };
    let is_same = is_read || lay.is_some_and(|lay| lay.registration.near >= LEAST_NEAR);
    let shape = if is_same { Shape::Same } else { Shape::Other };
    Comparison {
        verdict,
        shape,
        sentence: sentence(verdict, shape),
        tag: payload.and_then(Payload::tag),
        number: payload.map(Payload::number),
        witness: is_said(verdict).then_some(witness),
        near: lay.map_or(0.0, |lay| lay.registration.near),
        covered: lay.map_or(0.0, |lay| lay.covered),
        is_mirrored: lay.is_some_and(|lay| lay.registration.motion.is_mirrored()),
        motion: lay.map(|lay| {
            let motion = lay.registration.motion;
            let [x, y, z] = motion.linear.to_cols_array_2d();
            [x, y, z, motion.translation.to_array()]
        }),
        ln_p,
        shows_ln_p: is_said(verdict),
    }
}

fn sentence(verdict: Verdict, shape: Shape) -> &'static str {
    match (verdict, shape) {
        (Verdict::Found | Verdict::Present, _) => verdict.sentence(),
        (Verdict::Partial, _) => "A mark fits partly.",
        (_, Shape::Same) => {
            "The shape is the original's, or a piece of it, but your mark is not in it."
        }
        (_, Shape::Other) => "This is another shape than the original, and your mark is not in it.",
    }
}
