//! What a model can hold: it is marked with a key that is nobody's, and nothing is kept of that.

use super::marking::{WITHOUT_PAYLOAD, hold};
use super::{EmbedOptions, Error, Model, Strength};
use crate::bits::Payload;
use crate::key::Key;
use serde::Serialize;

/// What a mark in a model can say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Holds {
    /// The model cannot be marked.
    Nothing,
    /// Whose the model is.
    Presence,
    /// That, and 48 bits.
    Payload,
}

/// What a model can hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Capacity {
    /// What a mark in it can say.
    pub holds: Holds,
    /// The preset that it takes: `balanced`, or `strong` where that holds more.
    pub strength: Option<&'static str>,
    /// Why it holds no more, in words.
    pub reason: Option<String>,
}

/// Tries what a model can hold, at the balanced strength and then at the strong one. Another key may fare a little better or worse. It
/// takes as long as an embedding without its forecast, and twice as long where balanced is not enough.
///
/// # Errors
/// As [`embed`](crate::embed), but for models that can hold nothing: that is an answer.
pub fn capacity<'a>(model: impl Into<Model<'a>>) -> Result<Capacity, Error> {
    let mut model = model.into();
    let key = Key::from_bytes(&[0; Key::BYTES])?;
    let payload = Payload::from_number(0)?;
    let mut most = Capacity {
        holds: Holds::Nothing,
        strength: None,
        reason: None,
    };
    for name in ["balanced", "strong"] {
        let strength = Strength::from_name(name).unwrap_or(Strength::BALANCED);
        let options = EmbedOptions::default().with_strength(strength);
        let holds = match hold(&mut model, payload, &key, &options) {
            Err(refusal) if refusal.is_of_the_model() => {
                most.reason.get_or_insert(refusal.to_string());
                Holds::Nothing
            }
            held => match held?.payload {
                Some(_) => Holds::Payload,
                None => Holds::Presence,
            },
        };
        if holds > most.holds {
            let reason = (holds == Holds::Presence).then(|| WITHOUT_PAYLOAD.to_owned());
            most = Capacity {
                holds,
                strength: Some(name),
                reason,
            };
        }
        if holds == Holds::Payload {
            break;
        }
    }
    Ok(most)
}
