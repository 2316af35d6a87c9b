//! Reading a suspect with the original at hand.

use super::judge::Judge;
use super::loudest::Loudest;
use super::overlay::Overlay;
use super::report::{Comparison, Extraction, Input, Shape, Verdict, Witness};
use super::weigh::{Scales, Spoken};
use super::{EmbedOptions, Error, Model, Suspect};
use crate::bits::Payload;
use crate::carrier::{Carrier, Frames, Host, Known, Reading, Seen, Way};
use crate::detection::{LN_P_FOUND, LN_P_TRACE};
use crate::document::Document;
use crate::geometry::{
    Assembly, Kept, LEAST_NEAR, Leeway, Motion, Original, Registration, Search, Shown, Views, kept,
};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Progress, Stage};
use crate::scene::Scene;
use std::f64::consts::LN_2;

/// What is less near than this is not read.
const LEAST_READ: f64 = 0.5;
/// A whole copy that lies on the original as closely as this lies nowhere else, and what lies there as nearly need not be taken apart.
const SURE: f64 = 0.9;
/// What is less near than this as a whole is not taken apart, unless it is of several parts.
const LEAST_APART: f64 = 0.2;

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
    Ok(compare_in(suspect.into(), &original.into(), key, None)?.comparison)
}

/// Tests a suspect for one payload that was expected before it was looked at, with the original: what [`verify`](crate::verify) is to
/// [`extract`](crate::extract). It alone is charged, and not all payloads, so less has to be left of the mark. Where the suspect has another payload of
/// the key, the verdict is [`Verdict::Partial`].
///
/// # Errors
/// As [`compare`].
pub fn verify_with_original<'a, 'b>(
    suspect: impl Into<Suspect<'a>>,
    original: impl Into<Model<'b>>,
    key: &Key,
    expected: Payload,
) -> Result<Comparison, Error> {
    Ok(compare_in(suspect.into(), &original.into(), key, Some(expected))?.comparison)
}

/// As [`compare`], or as [`verify_with_original`] where a payload is expected, with the suspect laid on the original, to be looked at; `None` for
/// another shape.
///
/// # Errors
/// As [`compare`].
pub fn compare_overlaid<'a, 'b>(
    suspect: impl Into<Suspect<'a>>,
    original: impl Into<Model<'b>>,
    key: &Key,
    expected: Option<Payload>,
) -> Result<(Comparison, Option<Overlay>), Error> {
    Ok(compare_in(suspect.into(), &original.into(), key, expected)?.overlaid())
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
        // Parts were moved already.
        let motion = motion.map(|motion| match comparison.is_in_parts() {
            true => columns(&Motion::IDENTITY),
            false => motion,
        });
        let overlay =
            motion.map(|m| Overlay::new(&original, &suspect, m, is_heard.then_some(&spoken)));
        (comparison, overlay)
    }

    /// Where the original is what a record keeps of it.
    pub(super) fn overlaid_on_record(self) -> (Comparison, Option<Overlay>) {
        let (comparison, overlay) = self.overlaid();
        let recorded = overlay.map(|overlay| Overlay {
            is_recorded: true,
            ..overlay
        });
        (comparison, recorded)
    }
}

fn compare_in(
    mut suspect: Suspect,
    model: &Model,
    key: &Key,
    expected: Option<Payload>,
) -> Result<Compared, Error> {
    hear_with_original(&mut suspect, model, key, expected, None)?.compared(suspect, key, expected)
}

/// What was read with the original, or with its record, and what with.
pub(super) struct Informed {
    pub heard: Heard,
    pub original: Mesh,
    pub suspect: Mesh,
}

impl Informed {
    /// With what is read blind, where that may say more.
    pub(super) fn compared(
        self,
        mut suspect: Suspect,
        key: &Key,
        expected: Option<Payload>,
    ) -> Result<Compared, Error> {
        let blind = match self.heard.ln_p_payload <= LN_P_FOUND {
            true => None,
            false => Some(self.read_blind(key, expected, &mut suspect)?),
        };
        suspect.step(Stage::Test, 1.0)?;
        Ok(self.concluded(blind))
    }

    /// Reads without the original, at half of the probability of a false alarm.
    fn read_blind(
        &self,
        key: &Key,
        expected: Option<Payload>,
        progress: &mut dyn Progress,
    ) -> Result<Blind, Error> {
        let judge = Judge::new(key, expected, Input::Model).one_of(2);
        let mut readings = Carrier::STANDARD.map(|_| Default::default());
        let lies = self.heard.first.is_some_and(|lay| lay.lies());
        for carrier in Carrier::QUICKEST_FIRST {
            let is_settled = |reading: &Reading| judge.is_settled(reading);
            readings[carrier as usize] = match lies {
                true => {
                    carrier.read_beside(&self.suspect, &self.original, key, &is_settled, progress)
                }
                false => carrier.read_until(&self.suspect, key, &is_settled, progress),
            }?;
        }
        Ok(Blind::of(&judge.conclude(&readings)))
    }

    /// What is said of it. Of a suspect that was taken apart, what is shown is the parts where they lie.
    pub(super) fn concluded(self, blind: Option<Blind>) -> Compared {
        let comparison = conclude(&self.heard, blind);
        let assembled = self.heard.assembled.filter(|_| comparison.is_in_parts());
        Compared {
            comparison,
            original: self.original,
            suspect: assembled.unwrap_or(self.suspect),
            spoken: self.heard.spoken,
        }
    }
}

/// Reads a suspect with the original. `loudest` hears all that is read, where it is asked whose copies the suspect was made of.
pub(super) fn hear_with_original(
    suspect: &mut Suspect,
    model: &Model,
    key: &Key,
    expected: Option<Payload>,
    loudest: Option<&mut Loudest>,
) -> Result<Informed, Error> {
    suspect.step(Stage::Read, 0.0)?;
    let scene = Scene::gather(&Document::read(model.bytes, model.files)?)?;
    let mesh = suspect.mesh()?;
    suspect.step(Stage::Measure, 0.0)?;
    let heard = with_host(&scene, &options_of_original(), |host| {
        hear(host, &mesh, key, expected, loudest, suspect)
    })??;
    Ok(Informed {
        heard,
        original: scene.mesh,
        suspect: mesh,
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
    /// Another payload than the expected one, which speaks louder, and its bound.
    pub other: Option<(Payload, f64)>,
    pub witness: Witness,
    /// The likeliest way in which the suspect lies on the original, and the one that was read.
    pub first: Option<Lay>,
    pub read: Option<Lay>,
    /// The suspect's parts where they lie, where it was taken apart.
    pub assembled: Option<Mesh>,
    /// What windows said for the mark.
    pub spoken: Spoken,
}

/// How a suspect lies on the original.
#[derive(Clone, Copy)]
pub(super) struct Lay {
    /// The whole, or the largest of its parts.
    pub registration: Registration,
    pub num_parts: usize,
    pub is_bent: bool,
    pub covered: f64,
}

impl Lay {
    /// Whether the suspect lies there, and not only better than elsewhere.
    fn lies(&self) -> bool {
        self.registration.near >= LEAST_NEAR
    }
}

/// The same, and what is seen of it.
pub(super) struct Lying<'a> {
    registration: Registration,
    num_parts: usize,
    is_bent: bool,
    shown: Shown<'a>,
    kept: Option<Kept>,
}

impl<'a> Lying<'a> {
    /// A suspect that a motion takes onto the original, or parts of one that lie there already; `None` where too little does.
    fn new(
        (original, views): (&'a Original, &'a Views),
        (mesh, motion): (&Mesh, &Motion),
        registration: Registration,
        (num_parts, is_bent): (usize, bool),
    ) -> Option<Lying<'a>> {
        Some(Lying {
            registration,
            num_parts,
            is_bent,
            shown: Shown::new(original, views, mesh, motion)?,
            kept: kept(original, mesh, motion),
        })
    }

    fn lay(&self) -> Lay {
        Lay {
            registration: self.registration,
            num_parts: self.num_parts,
            is_bent: self.is_bent,
            covered: self.shown.covered(),
        }
    }
}

/// Who hears what is read: the scales, and where it is asked whose copies the suspect was made of, the loudest ways.
pub(super) struct Ears<'a> {
    pub scales: Scales,
    loudest: Option<&'a mut Loudest>,
}

impl<'a> Ears<'a> {
    pub(super) fn new(scales: Scales, loudest: Option<&'a mut Loudest>) -> Ears<'a> {
        Ears { scales, loudest }
    }

    /// Hears a way of reading, and says whether no other need be heard.
    pub(super) fn hear(&mut self, mut way: Way) -> bool {
        way.ln_num_tests += ln_num_searches();
        let is_settled = self.scales.hear(&way);
        match &mut self.loudest {
            Some(loudest) => {
                loudest.hear(way);
                false
            }
            None => is_settled,
        }
    }

    /// The same of a way with rings. Whose copies the suspect was made of is asked of windows alone: a ring shows how near a symbol is, and not by how
    /// much of a step.
    pub(super) fn hear_rings(&mut self, mut way: Way) -> bool {
        way.ln_num_tests += ln_num_searches();
        self.scales.hear(&way) && self.loudest.is_none()
    }

    /// Whether all that was heard of the ways to lie on the original says enough of buyers.
    pub(super) fn are_loud(&self) -> bool {
        self.loudest
            .as_ref()
            .is_some_and(|loudest| loudest.are_loud())
    }
}

/// Where a suspect may lie on an original: search after search, and taken apart. Knows no key.
///
/// What lies there for the most part, but not as a whole, is taken apart at once, and where that explains it, no mirror image of a piece is searched for; what
/// lies less well is taken apart at last.
pub(super) struct Searches<'a> {
    original: &'a Original<'a>,
    suspect: &'a Mesh,
    searches: std::slice::Iter<'static, Search>,
    starts: Vec<Registration>,
    is_whole: bool,
    /// Whether parts explain it.
    is_explained: bool,
    is_over: bool,
}

/// What a search found.
pub(super) enum Found {
    /// Ways in which the whole may lie, the likeliest first, of those that are worth reading.
    Whole(Vec<Registration>),
    /// Parts, each where it lies.
    Apart(Assembly),
}

impl<'a> Searches<'a> {
    pub(super) fn new(original: &'a Original<'a>, suspect: &'a Mesh) -> Searches<'a> {
        Searches {
            original,
            suspect,
            searches: Search::ALL.iter(),
            starts: Vec::new(),
            is_whole: true,
            is_explained: false,
            is_over: false,
        }
    }

    /// How much of the suspect lies there in the best way.
    fn near(&self) -> f64 {
        let nears = self.starts.iter().map(|start| start.near);
        nears.fold(0.0, f64::max)
    }

    fn apart(&mut self) -> Option<Found> {
        self.is_whole = false;
        let near = self.near();
        let may_have_parts =
            near < SURE && (near >= LEAST_APART || Original::has_large_parts(self.suspect));
        if !may_have_parts {
            return None;
        }
        let assembly = self.original.assembled(self.suspect, &self.starts)?;
        self.is_explained = assembly.registration.near >= SURE;
        Some(Found::Apart(assembly))
    }
}

impl Iterator for Searches<'_> {
    type Item = Found;

    fn next(&mut self) -> Option<Found> {
        if self.is_over {
            return None;
        }
        let is_next = self.searches.as_slice().first() == Some(&Search::Mirrored);
        let is_mostly_there = self.is_whole && (LEAST_NEAR..SURE).contains(&self.near());
        if is_next
            && is_mostly_there
            && let Some(found) = self.apart()
        {
            return Some(found);
        }
        let needed = |search: &&Search| !(self.is_explained && **search == Search::Mirrored);
        let Some(search) = self.searches.next().filter(needed) else {
            return if self.is_whole { self.apart() } else { None };
        };
        let registrations = self.original.registrations(self.suspect, *search);
        self.starts.extend(&registrations);
        let near = registrations.into_iter().filter(|r| r.near >= LEAST_READ);
        Some(Found::Whole(near.collect()))
    }
}

/// The same with what is seen of the suspect in each way. A whole copy that lies there so well lies nowhere else.
pub(super) struct Lyings<'a> {
    searches: Searches<'a>,
    views: &'a Views,
    is_first: bool,
    /// The parts where they lie, where it was taken apart.
    assembled: Option<Mesh>,
}

impl<'a> Lyings<'a> {
    pub(super) fn new(
        original: &'a Original<'a>,
        views: &'a Views,
        suspect: &'a Mesh,
    ) -> Lyings<'a> {
        Lyings {
            searches: Searches::new(original, suspect),
            views,
            is_first: true,
            assembled: None,
        }
    }
}

impl<'a> Iterator for Lyings<'a> {
    type Item = Vec<Lying<'a>>;

    fn next(&mut self) -> Option<Vec<Lying<'a>>> {
        let at = (self.searches.original, self.views);
        let suspect = self.searches.suspect;
        let found: Vec<Lying> = match self.searches.next()? {
            Found::Whole(registrations) => {
                let registrations = registrations.into_iter();
                let lying = |r: Registration| Lying::new(at, (suspect, &r.motion), r, (1, false));
                registrations.filter_map(lying).collect()
            }
            Found::Apart(Assembly {
                mesh,
                num_parts,
                is_bent,
                registration,
            }) => {
                let parts = (&mesh, &Motion::IDENTITY);
                let lying = Lying::new(at, parts, registration, (num_parts, is_bent));
                self.assembled = Some(mesh);
                lying.into_iter().collect()
            }
        };
        let is_first = self.is_first;
        self.is_first &= found.is_empty();
        if is_first {
            let is_sure =
                |lying: &Lying| lying.registration.exact > SURE && lying.shown.covered() > SURE;
            self.searches.is_over |= found.first().is_some_and(is_sure);
        }
        Some(found)
    }
}

/// Reads with the original, search after search, until it is sure.
fn hear(
    host: &Host,
    suspect: &Mesh,
    key: &Key,
    expected: Option<Payload>,
    loudest: Option<&mut Loudest>,
    progress: &mut dyn Progress,
) -> Result<Heard, Error> {
    let original = Original::new(host.mesh);
    let views = Views::new(host.mesh);
    let frames = Frames::new(host);
    let known_rings = Known::new(host);
    let mut reader = None;
    let mut ears = Ears::new(Scales::new(key).expecting(expected), loudest);
    let mut first: Option<Lay> = None;
    let mut lyings: Vec<Lying> = Vec::new();
    let mut searched = Lyings::new(&original, &views, suspect);
    for new in &mut searched {
        let known = lyings.len();
        first = nearer(first, &new);
        lyings.extend(new);
        let observe: Vec<_> = lyings[known..].iter().flat_map(views_of).collect();
        let seen: Vec<&Seen> = observe.iter().map(|observe| &**observe).collect();
        let rings = Rings::new(known_rings.as_ref(), &lyings[known..], known, key);
        let mut is_settled = false;
        if !seen.is_empty() {
            let reader = reader.get_or_insert_with(|| frames.with_key(key));
            reader.read(&seen, progress, &mut |mut way| {
                way.list += 2 * known;
                way.ln_num_tests += Rings::LN_NUM_SHARES;
                let beside = rings.beside(&way);
                is_settled = ears.hear(way) || beside.is_some_and(|way| ears.hear_rings(way));
                is_settled
            })?;
        }
        is_settled = is_settled || rings.alone().any(|way| ears.hear_rings(way));
        if is_settled || ears.are_loud() {
            break;
        }
    }
    let assembled = searched.assembled;
    let scales = ears.scales.conclude();
    Ok(Heard {
        other: scales.other,
        ln_p_presence: scales.ln_p_presence,
        ln_p_payload: scales.ln_p_payload,
        payload: scales.payload,
        witness: match scales.list % 2 {
            0 => Witness::Surface,
            _ => Witness::Vertices,
        },
        first,
        read: lyings.get(scales.list / 2).map(Lying::lay),
        assembled,
        spoken: scales.spoken,
    })
}

/// What a key reads of the rings whose vertices a suspect kept, in each of some ways to lie on the original. They are two more ways to look at it: beside
/// the windows as its vertices show them, and alone.
pub(super) struct Rings {
    ways: Vec<Option<Way>>,
    /// The number of the first way to lie.
    first: usize,
}

impl Rings {
    /// Of all ways to look at a suspect, those without rings have a half of the probability.
    pub(super) const LN_NUM_SHARES: f64 = LN_2;

    pub(super) fn new(known: Option<&Known>, lyings: &[Lying], first: usize, key: &Key) -> Rings {
        let read = |lying: &Lying| known?.read(&lying.kept.as_ref()?.positions, key);
        Rings {
            ways: lyings.iter().map(read).collect(),
            first,
        }
    }

    /// Alone, in a half of a half.
    pub(super) fn alone(&self) -> impl Iterator<Item = Way> {
        let charge = libm::log(self.ways.len() as f64) + 2.0 * LN_2;
        let all = (self.first..).zip(&self.ways);
        all.filter_map(move |(lying, rings)| {
            let rings = rings.clone()?;
            Some(Way {
                ln_num_tests: charge,
                list: 2 * lying + 1,
                ..rings
            })
        })
    }

    /// Beside windows, charged as these; `None` where they are seen by the surface, or no ring was kept.
    pub(super) fn beside(&self, windows: &Way) -> Option<Way> {
        let rings = self.ways[windows.list / 2 - self.first].as_ref()?;
        (windows.list % 2 == 1).then(|| Way {
            places: [&windows.places[..], &rings.places].concat(),
            ..*windows
        })
    }
}

/// What each search is charged: a half of the probability is for reading without the original; and each search, and the parts of a suspect that is taken
/// apart, share the other half, whether they are made or not.
pub(super) fn ln_num_searches() -> f64 {
    LN_2 + libm::log(Search::ALL.len() as f64 + 1.0)
}

fn nearer(first: Option<Lay>, new: &[Lying]) -> Option<Lay> {
    let new = new.first().map(Lying::lay);
    match (first, new) {
        (Some(first), Some(new)) if first.registration.near >= new.registration.near => Some(first),
        (first, new) => new.or(first),
    }
}

/// The two ways to look at a suspect that lies on the original: at its surface, and at the vertices that it kept.
pub(super) fn views_of<'a>(lying: &'a Lying) -> [Box<Seen<'a>>; 2] {
    [
        Box::new(|radius| lying.shown.observations(radius)),
        Box::new(|_| match &lying.kept {
            Some(kept) => kept.observations.clone(),
            None => Vec::new(),
        }),
    ]
}

pub(super) struct Blind {
    verdict: Verdict,
    number: Option<u64>,
    ln_p: f64,
}

impl Blind {
    pub(super) fn of(read: &Extraction) -> Blind {
        Blind {
            verdict: read.verdict,
            number: read.number,
            ln_p: read.details().ln_p,
        }
    }
}

/// One answer. What is said of the shape follows no key, unless the mark is found.
pub(super) fn conclude(heard: &Heard, blind: Option<Blind>) -> Comparison {
    let own = match heard {
        _ if heard.ln_p_payload <= LN_P_FOUND => (Verdict::Found, heard.ln_p_payload),
        _ if heard.other.is_some() => (Verdict::Partial, heard.ln_p_presence),
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
            let other = heard.other.filter(|(_, ln_p)| *ln_p <= LN_P_FOUND);
            let payload = payload.or(other.map(|(other, _)| other));
            (own.0, own.1, payload, heard.witness)
        }
    };
    let is_read = is_said(verdict) && witness != Witness::Blind;
    let lay = if is_read { heard.read } else { heard.first };
    let is_same = is_read || lay.is_some_and(|lay| lay.lies());
    let shape = if is_same { Shape::Same } else { Shape::Other };
    Comparison {
        verdict,
        shape,
        sentence: match verdict == Verdict::Partial && heard.other.is_some() {
            true => "The model carries a mark of this key, but with another payload.",
            false => sentence(verdict, shape),
        },
        tag: payload.and_then(Payload::tag),
        number: payload.map(Payload::number),
        witness: is_said(verdict).then_some(witness),
        near: lay.map_or(0.0, |lay| lay.registration.near),
        covered: lay.map_or(0.0, |lay| lay.covered),
        num_parts: lay.map_or(0, |lay| lay.num_parts),
        is_bent: lay.is_some_and(|lay| lay.is_bent),
        is_mirrored: lay.is_some_and(|lay| lay.registration.motion.is_mirrored()),
        motion: lay.map(|lay| columns(&lay.registration.motion)),
        ln_p,
        shows_ln_p: is_said(verdict),
    }
}

fn columns(motion: &Motion) -> [[f64; 3]; 4] {
    let [x, y, z] = motion.linear.to_cols_array_2d();
    [x, y, z, motion.translation.to_array()]
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
