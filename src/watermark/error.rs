//! Every way in which a pipeline can fail.

use crate::bits::PayloadError;
use crate::carrier::CarrierError;
use crate::code::TextError;
use crate::document::DocumentError;
use crate::evidence::EvidenceError;
use crate::key::KeyError;
use crate::progress::Cancelled;
use crate::scene::SceneError;

/// What would help a model that is refused. It was tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Advice {
    /// All carriers.
    AllCarriers,
    /// The strong strength.
    Strong,
    /// The balanced strength.
    Balanced,
    /// Nothing that can be chosen.
    Nothing,
}

impl std::fmt::Display for Advice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Advice::AllCarriers => "with all carriers it can be marked",
            Advice::Strong => "at the strong strength it can be marked",
            Advice::Balanced => "at the balanced strength it can be marked",
            Advice::Nothing => "no carrier and no strength up to strong helps",
        })
    }
}

/// Why a text is no record that can be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// Something else.
    #[error("this is no record: one is the JSON that `embed` wrote beside the marked file")]
    NotARecord,
    /// Of a later version.
    #[error("the record has version {0}, and this program reads version 1: use a newer one")]
    Version(u32),
    /// Of another key.
    #[error(
        "the record was made with another key: check the owner's name, the passphrase and the title of the work; with the original no record is needed"
    )]
    OtherKey,
    /// Changed, or cut short.
    #[error(
        "the record is not as it was written, in what is sealed or in what is in clear: use another copy of it, or the original"
    )]
    Damaged,
}

impl RecordError {
    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            RecordError::NotARecord => "record.not-a-record",
            RecordError::Version(_) => "record.version",
            RecordError::OtherKey => "record.other-key",
            RecordError::Damaged => "record.damaged",
        }
    }
}

/// The version of plans that is written and read.
pub(super) const PLAN_VERSION: u16 = 1;

/// Why bytes are not a plan.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Something else.
    #[error("this is not a plan for copies")]
    NotPlan,
    /// A plan of another version.
    #[error(
        "this plan was made by another version (format {0}); this one reads format {PLAN_VERSION}: prepare the model again"
    )]
    Version(u16),
    /// Cut short or damaged.
    #[error("the plan is damaged: prepare the model again")]
    Damaged,
}

impl PlanError {
    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            PlanError::NotPlan => "plan.not-plan",
            PlanError::Version(_) => "plan.version",
            PlanError::Damaged => "plan.damaged",
        }
    }
}

/// Why nothing was embedded, measured or read. "No mark found" is a result, not an error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file cannot be read, or cannot be read safely.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The file holds nothing that a mark could be in.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The model cannot hold the mark.
    #[error(transparent)]
    Carrier(#[from] CarrierError),
    /// The key was refused.
    #[error(transparent)]
    Key(#[from] KeyError),
    /// The payload was refused.
    #[error(transparent)]
    Payload(#[from] PayloadError),
    /// The text of a note was refused.
    #[error(transparent)]
    Text(#[from] TextError),
    /// The evidence cannot be read.
    #[error(transparent)]
    Evidence(#[from] EvidenceError),
    /// The record cannot be read.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The plan cannot be read.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A strength outside its range.
    #[error(
        "strength is a fraction of the diagonal from 0.00001 to 0.01, or subtle, balanced or strong; not {0}"
    )]
    Strength(String),
    /// A largest movement that is no positive number.
    #[error("the largest movement is a positive number of scene units, not {0}")]
    MaxMovement(String),
    /// No carrier was chosen.
    #[error("no carrier was chosen")]
    NoCarrier,
    /// LOCAL is to be used without SOLID.
    #[error("LOCAL holds no payload: name the carrier solid beside it")]
    NoSolid,
    /// LOCAL is to be used in copies of a plan.
    #[error("LOCAL cannot be in the copies of a plan: name the carriers solid and ring alone")]
    NotInCopies,
    /// The model holds a mark without a payload only.
    #[error("the model is too small to hold a number, so its copies cannot be told apart")]
    NoCopies,
    /// The marked model was read back, and its mark was not found: nothing was written.
    #[error(
        "the mark could not be read back from the marked model, so nothing was returned{}",
        if *has_axes { "" } else { ": its shape looks alike from several sides" }
    )]
    Unreadable {
        /// Whether the shape has axes of its own.
        has_axes: bool,
    },
    /// The model is refused for what it is.
    #[error("{refusal}; {advice}")]
    Refused {
        /// Why: what came nearest.
        refusal: Box<Error>,
        /// What would help.
        advice: Advice,
    },
    /// The model was read back, and its note was not found: nothing was written.
    #[error(
        "the note could not be read back from the model, so nothing was returned: its vertices are too few in too many \
         directions, or they cannot move as they should; a shorter note or another key may do"
    )]
    NoteUnreadable,
    /// The caller asked to stop; nothing was changed.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Error {
    /// Whether the model is refused for what it is, not for what was asked.
    pub(super) fn is_of_the_model(&self) -> bool {
        match self {
            Error::Carrier(refusal) => !matches!(refusal, CarrierError::Cancelled(_)),
            Error::Unreadable { .. } => true,
            _ => false,
        }
    }

    /// The stable code of this error.
    pub fn code(&self) -> &'static str {
        match self {
            Error::Document(error) => error.code(),
            Error::Scene(error) => error.code(),
            Error::Carrier(error) => error.code(),
            Error::Key(error) => error.code(),
            Error::Payload(error) => error.code(),
            Error::Text(error) => error.code(),
            Error::Evidence(error) => error.code(),
            Error::Record(error) => error.code(),
            Error::Plan(error) => error.code(),
            Error::Strength(_) => "options.strength",
            Error::MaxMovement(_) => "options.max-movement",
            Error::NoCopies => "copies.no-number",
            Error::NoCarrier => "options.no-carrier",
            Error::NoSolid => "options.no-solid",
            Error::NotInCopies => "options.not-in-copies",
            Error::Unreadable { .. } => "watermark.unreadable",
            Error::Refused { refusal, .. } => refusal.code(),
            Error::NoteUnreadable => "note.unreadable",
            Error::Cancelled(_) => "aborted",
        }
    }

    /// Where in the document, as a JSON pointer (RFC 6901).
    pub fn pointer(&self) -> Option<&str> {
        match self {
            Error::Document(error) => error.pointer(),
            Error::Scene(SceneError::Document(error)) => error.pointer(),
            _ => None,
        }
    }
}
