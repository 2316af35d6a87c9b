//! What a caller may choose.

use super::Error;
use crate::carrier::Carrier;
use crate::geometry::Bounds;

/// Options of [`embed`](super::embed).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EmbedOptions {
    /// Default: [`Strength::BALANCED`].
    pub strength: Strength,
    /// Which carriers to use, in any order; repetitions do not matter. LOCAL, where it is compiled, needs SOLID beside it. Default: SOLID and
    /// RING.
    pub carriers: Vec<Carrier>,
    /// How far a vertex may go at most, in scene units: metres, where the file keeps to glTF's. Positive. Default: as the strength allows.
    pub max_movement: Option<f64>,
}

impl Default for EmbedOptions {
    fn default() -> Self {
        EmbedOptions {
            strength: Strength::BALANCED,
            carriers: Carrier::STANDARD.to_vec(),
            max_movement: None,
        }
    }
}

impl EmbedOptions {
    /// The same with a strength.
    pub fn with_strength(self, strength: Strength) -> EmbedOptions {
        EmbedOptions { strength, ..self }
    }

    /// How far vertices may go.
    ///
    /// # Errors
    /// [`Error::MaxMovement`] where that is no positive number.
    pub(super) fn bounds(&self) -> Result<Bounds, Error> {
        let bounds = self.strength.bounds();
        match self.max_movement {
            None => Ok(bounds),
            Some(most) if most > 0.0 => Ok(Bounds { most, ..bounds }),
            Some(other) => Err(Error::MaxMovement(other.to_string())),
        }
    }

    /// The same with a largest movement, in scene units.
    pub fn with_max_movement(self, max_movement: f64) -> EmbedOptions {
        EmbedOptions {
            max_movement: Some(max_movement),
            ..self
        }
    }

    /// A carrier that comes beside SOLID, and is read where it is asked for.
    pub(super) fn asked(&self) -> Option<Carrier> {
        let asked = |carrier: &&Carrier| !Carrier::STANDARD.contains(carrier);
        self.carriers.iter().find(asked).copied()
    }

    /// The same with these carriers alone.
    pub fn with_carriers(self, carriers: impl IntoIterator<Item = Carrier>) -> EmbedOptions {
        EmbedOptions {
            carriers: carriers.into_iter().collect(),
            ..self
        }
    }
}

/// Limit of the RMS displacement over all vertices, as a fraction of the bounding box's diagonal. A carrier that needs
/// less takes less: RING's step is a fraction of an edge, so on dense meshes it stays far below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    rms_rel: f64,
    hidden: bool,
}

impl Strength {
    /// 0.02 % of the diagonal, or less where that would be seen.
    pub const SUBTLE: Strength = Strength::hidden(0.0002);
    /// 0.04 % of the diagonal, or less where that would be seen.
    pub const BALANCED: Strength = Strength::hidden(0.0004);
    /// 0.08 % of the diagonal, seen or not.
    pub const STRONG: Strength = Strength::whole(0.0008);

    const fn hidden(rms_rel: f64) -> Strength {
        Strength {
            rms_rel,
            hidden: true,
        }
    }

    const fn whole(rms_rel: f64) -> Strength {
        Strength {
            rms_rel,
            hidden: false,
        }
    }

    /// A strength from 0.00001 to 0.01, spent whole whether it is seen or not.
    ///
    /// # Errors
    /// [`Error::Strength`] for any other number.
    pub fn new(rms_rel: f64) -> Result<Strength, Error> {
        if (1e-5..=1e-2).contains(&rms_rel) {
            Ok(Strength::whole(rms_rel))
        } else {
            Err(Error::Strength(rms_rel.to_string()))
        }
    }

    /// A strength as a plan holds it.
    pub(super) fn stored(rms_rel: f64, hidden: bool) -> Result<Strength, Error> {
        Ok(Strength {
            hidden,
            ..Strength::new(rms_rel)?
        })
    }

    /// A preset by its name: subtle, balanced or strong.
    pub fn from_name(name: &str) -> Option<Strength> {
        match name {
            "subtle" => Some(Strength::SUBTLE),
            "balanced" => Some(Strength::BALANCED),
            "strong" => Some(Strength::STRONG),
            _ => None,
        }
    }

    /// How far a vertex may go by its part and its triangles. What is stronger than strong may go farther in proportion, for somebody
    /// insists.
    fn bounds(self) -> Bounds {
        if self.hidden {
            return Bounds::HIDDEN;
        }
        Bounds::STRONG.times((self.rms_rel / Strength::STRONG.rms_rel).max(1.0))
    }

    /// The fraction.
    pub fn rms_rel(self) -> f64 {
        self.rms_rel
    }

    /// Whether surfaces that are too smooth to hide it are given less.
    pub fn is_hidden(self) -> bool {
        self.hidden
    }
}

impl std::str::FromStr for Strength {
    type Err = Error;

    /// A preset's name or a number.
    ///
    /// # Errors
    /// [`Error::Strength`] for anything else.
    fn from_str(text: &str) -> Result<Strength, Error> {
        match Strength::from_name(text) {
            Some(preset) => Ok(preset),
            None => text
                .parse()
                .map_err(|_| Error::Strength(text.to_owned()))
                .and_then(Strength::new),
        }
    }
}
