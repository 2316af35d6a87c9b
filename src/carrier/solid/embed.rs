//! Embedding in one frame: which pitch, step and limit hold the mark.

use super::frame::is_determined;
use super::lattice::Lattice;
use super::pitch::pitches_to_embed;
use super::quantizer::steps_for;
use super::rounds::{Attempt, Choice, Ground, Rounds, dither};
use crate::carrier::{Carrier, CarrierError, Host, Mark, Needs};
use crate::geometry::diagonal;
use crate::progress::{Cancelled, Progress, Stage, step};
use glam::{DMat3, DVec3};

/// No vertex moves more than so many times the RMS limit, and less where its freedom is less than is typical. The second is
/// for models in which a few vertices hold up large parts.
pub(super) const CLAMPS: [f64; 2] = [3.0, 6.0];

/// Windows that a vertex can serve: it has three freedoms. Of 28 models with few vertices none held more than 0.7 nats for a vertex, so a
/// mark of so many nats needs as many vertices at least.
const WINDOWS_PER_VERTEX: usize = 3;

/// 62 would do for the payload, a chance of 10^-9 and the tests, and the decoder is right from 75 to 80 on; 29 would do for a chance of
/// 10^-9 and the tests.
const NEEDS: Needs = Needs {
    sturdy: 125.0,
    payload: 90.0,
    presence: 45.0,
};

/// The same where a detector has to scan: the pilots are spent on that, and two thirds of the symbols are left to testify.
const NEEDS_SCANNED: Needs = Needs {
    sturdy: 188.0,
    payload: 135.0,
    presence: 67.0,
};

/// What is below this part of the needed exponent after every step of a limit is given the whole limit at once, and is given up with that: of
/// 66 models that were tried, on the way to enough none was below 0.47 of it. What is below the second part after some rounds of an attempt,
/// ends the attempt. Surfaces of long needles, whose rounds take a second, so end in some seconds.
const HOPEFUL: f64 = 0.25;
const BEGUN: f64 = 1.0 / 32.0;

/// Steps smaller than the strength's own are tried until the exponent is so many times what a sturdy mark needs, so many in all; and still
/// smaller ones until the mark is sturdy: where parts and triangles leave vertices less room than the strength, they hold more.
const ENOUGH: f64 = 1.2;
const STEPS_TRIED: usize = 4;

/// A mark in one frame.
pub struct InFrame {
    pub displacement: Vec<DVec3>,
    pub exponent: f64,
    pub needs: Needs,
    /// How another message is embedded there.
    pub choice: Choice,
}

/// Gives the host the mark in its own frame. It has to reach what is `worth` it of the exponents that are needed.
pub fn embed_in_frame(
    host: &Host,
    mark: &Mark,
    worth: fn(&Needs) -> f64,
    progress: &mut dyn Progress,
) -> Result<InFrame, CarrierError> {
    let num_vertices = host.mesh.positions.len();
    let none = |available| CarrierError::TooFewAddresses {
        carrier: Carrier::Solid,
        needed: WINDOWS_PER_VERTEX * worth(&NEEDS) as usize,
        available,
        vertices: num_vertices,
    };
    if (num_vertices as f64) < worth(&NEEDS) {
        return Err(none(WINDOWS_PER_VERTEX * num_vertices));
    }
    let ground = ground(host).ok_or_else(|| none(0))?;
    step(progress, Stage::Embed, 0.0)?;
    let candidates: Vec<f64> = pitches_to_embed(ground.area()).collect();
    let whole = host.share * host.rms_rel * diagonal(&ground.mesh.positions);
    let needs = match is_determined(&ground.pose) {
        true => NEEDS,
        false => NEEDS_SCANNED,
    };
    let embedder = Embedder {
        host,
        lattice: &Lattice::of(mark.key),
        mark,
        ground: &ground,
        enough: ENOUGH * needs.sturdy,
        sturdy: needs.sturdy,
    };
    let mut best = Attempt::default();
    // What is seen is better than no mark: a hidden one gets more of the limit until there is one.
    let least = if host.hidden { ground.typical } else { 1.0 };
    let shares = std::iter::successors(Some(least), |share| Some(2.0 * share));
    let hidden = shares
        .take_while(|share| *share < 1.0)
        .map(|share| (share, CLAMPS[0]));
    let mut tried = 0.0;
    for (share, clamp) in hidden.chain(CLAMPS.map(|clamp| (1.0, clamp))) {
        let is_hopeful = tried == 0.0 || best.exponent >= HOPEFUL * worth(&needs);
        if best.exponent > needs.sturdy || (tried == 1.0 && !is_hopeful) {
            break;
        }
        if is_hopeful || share == 1.0 {
            let limit = whole * share;
            embedder.at_pitches(&candidates, clamp, limit, &mut best, progress)?;
            tried = share;
        }
    }
    step(progress, Stage::Embed, 1.0)?;
    let needed = worth(&needs);
    if best.exponent < needed {
        return Err(CarrierError::TooWeak {
            carrier: Carrier::Solid,
            reached: best.exponent,
            needed,
        });
    }
    Ok(InFrame {
        displacement: best.displacement,
        exponent: best.exponent,
        needs,
        choice: best.choice,
    })
}

/// A host in its own frame.
pub fn ground(host: &Host) -> Option<Ground> {
    Ground::of(host, CLAMPS[0])
}

struct Embedder<'a> {
    host: &'a Host<'a>,
    mark: &'a Mark<'a>,
    lattice: &'a Lattice,
    ground: &'a Ground,
    /// An exponent that needs no further attempt.
    enough: f64,
    /// What a sturdy mark needs.
    sturdy: f64,
}

impl Embedder<'_> {
    /// Embeds with one pitch after the other until the best of all attempts is enough.
    fn at_pitches(
        &self,
        pitches: &[f64],
        clamp: f64,
        limit: f64,
        best: &mut Attempt,
        progress: &mut dyn Progress,
    ) -> Result<(), Cancelled> {
        for &pitch in pitches {
            if best.exponent <= self.enough {
                let choice = Choice {
                    pitch,
                    clamp,
                    limit,
                    ..Choice::default()
                };
                self.at_pitch(choice, best, progress)?;
            }
        }
        Ok(())
    }

    /// Embeds with a pitch, and with smaller steps until the best of all attempts is enough.
    fn at_pitch(
        &self,
        choice: Choice,
        best: &mut Attempt,
        progress: &mut dyn Progress,
    ) -> Result<(), Cancelled> {
        let placement = self.lattice.placed(DMat3::IDENTITY, choice.pitch);
        let mut active = self.ground.windows(&placement);
        if active.is_empty() {
            return Ok(());
        }
        dither(&mut active, self.lattice, self.mark.codeword);
        let rounds = Rounds {
            host: self.host,
            ground: self.ground,
            placement: &placement,
            problem: &self.ground.problem(&placement, &active),
            active: &active,
        };
        let steps = steps_for(choice.limit / diagonal(&self.ground.mesh.positions));
        let mut multipliers = vec![0.0; active.len()];
        for (number, &step) in steps.iter().enumerate() {
            if number >= STEPS_TRIED && best.exponent >= self.sturdy {
                break;
            }
            let choice = Choice { step, ..choice };
            let begun = BEGUN * NEEDS.sturdy;
            let attempt = rounds.attempt(choice, begun, &mut multipliers, progress)?;
            if attempt.exponent > best.exponent {
                *best = attempt;
            }
            if best.exponent > self.enough {
                break;
            }
        }
        Ok(())
    }
}
