//! What people and programs are told. The fields' names in camel case are JavaScript's: see `src/wasm/types.d.ts`.

use crate::carrier::Carrier;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

/// The answer to "does this model carry this key's mark?".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Verdict {
    /// A payload was read, and the chance of that without the key is at most 1e-9.
    Found,
    /// A mark of this key is there, and the chance of that without the key is at most 1e-9. It holds no payload, or none that can be
    /// read.
    Present,
    /// Something of this key is there, but not enough.
    Partial,
    /// No evidence of this key, which does not prove that the model is not its owner's.
    None,
    /// The model has too little geometry to answer.
    CannotCheck,
}

impl Verdict {
    /// The verdict in words for a person.
    pub fn sentence(self) -> &'static str {
        match self {
            Verdict::Found => "Your mark was found.",
            Verdict::Present => "Your mark is there, without a payload that can be read.",
            Verdict::Partial => "A mark fits partly.",
            Verdict::None => {
                "No evidence of this key. This does not prove that the model is not yours."
            }
            Verdict::CannotCheck => "Cannot check.",
        }
    }
}

/// What one carrier says.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct CarrierReading {
    /// Which carrier.
    pub name: Carrier,
    /// Natural logarithm of the bound of the false-positive probability, this carrier's choices charged; at most 0.
    pub ln_p: f64,
    /// The payload as a tag, where one was read (or, in a test of an expected one, where it fits).
    pub tag: Option<String>,
    /// The payload as a number.
    pub number: Option<u64>,
    /// Which piece of the model it was read in, alone, where it was not the whole: 1 is the first. Objects come before their parts, and
    /// what has more triangles before what has fewer.
    pub piece: Option<usize>,
    /// Weighted agreement of the symbols with that payload: 1 is perfect, 0 is chance.
    pub agreement: f64,
    /// Distinct addresses that were there to be read.
    pub addresses: usize,
    /// How many of them are this key's.
    pub owned_addresses: usize,
}

/// What was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Input {
    /// A model, measured here.
    Model,
    /// Evidence: what somebody says that they measured of a model.
    Evidence,
}

/// A reading with a key.
///
/// What may be said of it to anybody are the fields that can be seen. What else there is follows the key, and is
/// [`details`](Self::details): as JSON it is there where the verdict is found or present, else only after [`with_details`](Self::with_details).
/// `Debug` prints it always.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Extraction {
    /// The answer.
    pub verdict: Verdict,
    /// What was read.
    pub input: Input,
    /// The answer in words.
    pub sentence: &'static str,
    /// Why it is not `found`: words without a number that follows the key.
    pub reason: Option<String>,
    /// What a mark that is there does not prove, where it proves less than others.
    pub caution: Option<&'static str>,
    /// Which piece of the suspect it was found in, alone, where that was not the whole and the suspect is at hand.
    pub found_in: Option<FoundIn>,
    /// The payload as a tag, where it is found.
    pub tag: Option<String>,
    /// The payload as a number, where it is found.
    pub number: Option<u64>,
    pub(super) details: Details,
    pub(super) shows_details: bool,
}

/// A piece of a model, as people find it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct FoundIn {
    /// The name of the node that shows most of it, or of the next above that has one.
    pub name: Option<String>,
    /// Its connected parts.
    pub parts: usize,
    /// Those of the whole model.
    pub of_parts: usize,
}

/// What follows the key in a reading.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Details {
    /// Natural logarithm of the bound of the false-positive probability, every choice charged; at most 0.
    pub ln_p: f64,
    /// Agreement of the carrier that speaks loudest.
    pub agreement: f64,
    /// Every carrier's own reading.
    pub carriers: Vec<CarrierReading>,
}

impl Extraction {
    /// What follows the key: for its owner, and for nobody who may ask about suspects of their own making.
    ///
    /// They say of a suspect with one address whether the key owns it, and of one with many at which features they agree better. Some
    /// thousands of such answers are enough to make a suspect in which the mark is found (docs/SECURITY.md).
    pub fn details(&self) -> &Details {
        &self.details
    }

    /// The same reading, whose JSON has the details whatever the verdict is: see [`details`](Self::details).
    pub fn with_details(mut self) -> Extraction {
        self.shows_details = true;
        self
    }
}

/// By hand, for what serde derives for fields that are sometimes there takes 1 KB of the wasm module, by gzip.
impl Serialize for Extraction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let num_details = if self.shows_details { 3 } else { 0 };
        let mut fields = serializer.serialize_struct("Extraction", 8 + num_details)?;
        fields.serialize_field("verdict", &self.verdict)?;
        fields.serialize_field("input", &self.input)?;
        fields.serialize_field("sentence", &self.sentence)?;
        fields.serialize_field("reason", &self.reason)?;
        fields.serialize_field("caution", &self.caution)?;
        fields.serialize_field("foundIn", &self.found_in)?;
        fields.serialize_field("tag", &self.tag)?;
        fields.serialize_field("number", &self.number)?;
        if self.shows_details {
            fields.serialize_field("lnP", &self.details.ln_p)?;
            fields.serialize_field("agreement", &self.details.agreement)?;
            fields.serialize_field("carriers", &self.details.carriers)?;
        }
        fields.end()
    }
}

/// Whether a suspect is of an original's shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Shape {
    /// Most of the suspect lies on the original: it is a copy of it, or of a piece of it, whoever marked it.
    Same,
    /// It lies nowhere on the original, as a whole.
    Other,
}

/// What told of a mark where the original was at hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Witness {
    /// How the suspect's surface differs from the original's.
    Surface,
    /// Where the vertices went that it kept.
    Vertices,
    /// The suspect alone, as [`detect`](crate::detect) reads it.
    Blind,
}

/// A suspect that was read with the original at hand.
///
/// Numbers about the shape follow no key where the mark is not found; `lnP` does, and is in the JSON as [`Extraction`]'s details are.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Comparison {
    /// The answer about the mark. Never [`Verdict::CannotCheck`].
    pub verdict: Verdict,
    /// The answer about the shape.
    pub shape: Shape,
    /// Both in words.
    pub sentence: &'static str,
    /// The payload as a tag, where it is found. Where another one was expected, the verdict is [`Verdict::Partial`].
    pub tag: Option<String>,
    /// The payload as a number, likewise.
    pub number: Option<u64>,
    /// What told of the mark, where it is found or present.
    pub witness: Option<Witness>,
    /// The share of the suspect's surface that lies on the original, 0 to 1.
    pub near: f64,
    /// The share of the original's surface that the suspect shows, 0 to 1.
    pub covered: f64,
    /// Whether the suspect is a mirror image.
    pub is_mirrored: bool,
    /// In how many parts the suspect lies there, each moved by itself: 1 where it lies as a whole, 0 where it lies nowhere.
    pub num_parts: usize,
    /// Whether it, or a part of it, had to be bent to lie there: it is in another pose.
    pub is_bent: bool,
    /// What takes the suspect, or the largest of its parts, onto the original, or some of it where it was bent: three columns of a linear map, and a shift in
    /// the original's scene units. `None` where it lies nowhere.
    pub motion: Option<[[f64; 3]; 4]>,
    pub(super) ln_p: f64,
    pub(super) shows_ln_p: bool,
}

impl Comparison {
    /// Natural logarithm of the bound of the false-positive probability, every choice charged; at most 0. It follows the key: see
    /// [`Extraction::details`].
    pub fn ln_p(&self) -> f64 {
        self.ln_p
    }

    /// Whether the suspect was taken apart or bent, so that its parts lie where they are moved, and it does not as a whole.
    pub(super) fn is_in_parts(&self) -> bool {
        self.num_parts > 1 || self.is_bent
    }

    /// The same comparison, whose JSON has `lnP` whatever the verdict is.
    pub fn with_details(mut self) -> Comparison {
        self.shows_ln_p = true;
        self
    }
}

impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let num_details = usize::from(self.shows_ln_p);
        let mut fields = serializer.serialize_struct("Comparison", 12 + num_details)?;
        fields.serialize_field("verdict", &self.verdict)?;
        fields.serialize_field("shape", &self.shape)?;
        fields.serialize_field("sentence", &self.sentence)?;
        fields.serialize_field("tag", &self.tag)?;
        fields.serialize_field("number", &self.number)?;
        fields.serialize_field("witness", &self.witness)?;
        fields.serialize_field("near", &self.near)?;
        fields.serialize_field("covered", &self.covered)?;
        fields.serialize_field("isMirrored", &self.is_mirrored)?;
        fields.serialize_field("numParts", &self.num_parts)?;
        fields.serialize_field("isBent", &self.is_bent)?;
        fields.serialize_field("motion", &self.motion)?;
        if self.shows_ln_p {
            fields.serialize_field("lnP", &self.ln_p)?;
        }
        fields.end()
    }
}

/// What an embedding did.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct EmbedReport {
    /// The payload as a tag; `None` for the one number that has none, and for a mark without a payload.
    pub tag: Option<String>,
    /// The payload as a number; `None` for a mark without a payload, which a model gets that is too small to hold one.
    pub number: Option<u64>,
    /// Welded vertices of the scene.
    pub vertices: usize,
    /// How many of them moved.
    pub moved_vertices: usize,
    /// Diagonal of the host's bounding box, in scene units.
    pub diagonal: f64,
    /// RMS displacement over all vertices, as a fraction of that diagonal.
    pub rms_rel: f64,
    /// Maximum displacement, as a fraction of that diagonal.
    pub max_rel: f64,
    /// The same in scene units: metres, where the file keeps to glTF's.
    pub max_movement: f64,
    /// The farthest that a vertex went from where the mean movement of its part, what hangs together by edges, would have taken it, as a
    /// fraction of the part's own diagonal. At most 0.01 at the subtle and balanced strengths, 0.02 at the strong one.
    pub worst_part_rel: f64,
    /// The largest angle, in degrees, by which a triangle turned that is no sliver. At most 10 at the subtle and balanced strengths, 20 at
    /// the strong one; none turns over.
    pub worst_turn_degrees: f64,
    /// Whether rounding positions as web pipelines do takes the mark: the forecast `web` is red.
    pub is_fragile: bool,
    /// Pairs of triangles of one part that cut each other now, and neither did nor touched before: none.
    pub new_intersections: usize,
    /// What its owner should know, in sentences: that the mark is fragile, that it holds no payload, that it may be seen, what is strewn far from
    /// the model.
    pub warnings: Vec<String>,
    /// The strength that was asked for.
    pub strength: f64,
    /// The meshes that no scene shows, and whether they were marked, each alone.
    pub unshown: Vec<Unshown>,
    /// The output, read again from its bytes.
    pub read_back: Extraction,
    /// What the mark is likely to survive.
    pub forecast: Vec<Forecast>,
    /// SHA-256 of the main file before.
    pub host_sha256: String,
    /// SHA-256 of the main file after.
    pub marked_sha256: String,
}

/// A mesh that no scene shows: a level of detail, or what is left over.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Unshown {
    /// Its place in the file's list of meshes.
    pub mesh: usize,
    /// Whether it was marked. Else it is as it was: too small, or it shares its positions with what is shown.
    pub is_marked: bool,
}

/// How a mark is likely to stand an attack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Level {
    /// It is found with a wide margin: twice the exponent that is needed, eight times where half of the triangles are gone or more.
    Green,
    /// It is found, but the margin is small, or says little: of such a shape other simplifiers leave less.
    Amber,
    /// It is not found.
    Red,
}

/// One attack, and what was left of the mark after it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Forecast {
    /// Which attack: `none`, `web`, `noise`, `quantize`, `smooth`, `simplify-30`, `simplify-50`, `simplify-70` or `crop`.
    pub attack: &'static str,
    /// What is likely.
    pub level: Level,
    /// Natural logarithm of the bound that the mark reached.
    pub ln_p: f64,
}
