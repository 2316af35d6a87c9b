//! The record of an embedding: what stands in for the original when a copy is read. Some tens of kilobytes of JSON.
//!
//! What may be seen is in clear; what a reading takes is sealed under the key, together with a check of what is in clear.

use super::compare::{
    Compared, Ears, Found, Heard, Informed, Lay, Searches, options_of_original, with_host,
};
use super::loudest::Loudest;
use super::overlay::Overlay;
use super::report::{Comparison, EmbedReport, Witness};
use super::weigh::Scales;
use super::{Error, Model, RecordError, Suspect};
use crate::attack::simplify_to;
use crate::bits::Payload;
use crate::carrier::{Frames, Recorded, StoredError, take};
use crate::document::Document;
use crate::geometry::{Motion, Original};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Progress, Stage};
use crate::scene::Scene;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// What a record is called by itself.
const KIND: &str = "meshmark record";
const VERSION: u32 = 1;
/// What is sealed begins with this.
const MAGIC: &[u8; 4] = b"MMRC";
/// Faces that are kept of the original's shape: enough to see how a copy lies on it.
const FACES: usize = 1200;
/// The shape's coordinates are whole numbers up to this, along the longest side of its box.
const GRID: f64 = 65_535.0;

/// What a caller may add to a record.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RecordOptions {
    /// The owner's name. Default: none.
    pub owner: Option<String>,
    /// When the model was marked, as the caller writes it: this library knows no clock. Default: none.
    pub date: Option<String>,
}

impl RecordOptions {
    /// The same with an owner's name.
    pub fn with_owner(self, owner: impl Into<String>) -> RecordOptions {
        RecordOptions {
            owner: Some(owner.into()),
            ..self
        }
    }

    /// The same with a date.
    pub fn with_date(self, date: impl Into<String>) -> RecordOptions {
        RecordOptions {
            date: Some(date.into()),
            ..self
        }
    }
}

/// What can be seen of a record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Clear {
    kind: String,
    version: u32,
    tool: String,
    owner: Option<String>,
    date: Option<String>,
    tag: Option<String>,
    number: Option<u64>,
    strength: f64,
    host_sha256: String,
    marked_sha256: String,
    key_commitment: String,
}

#[derive(Serialize, Deserialize)]
struct Stored {
    #[serde(flatten)]
    clear: Clear,
    sealed: String,
}

impl Clear {
    /// What the sealed part is bound to.
    fn bytes(&self) -> Vec<u8> {
        serde_json::to_vec(self).unwrap_or_default()
    }
}

/// What a record names of the report of an embedding.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Marking {
    pub tag: Option<String>,
    pub number: Option<u64>,
    pub strength: f64,
    pub host_sha256: String,
    pub marked_sha256: String,
}

/// A record of an embedding, from the original and the report of marking it: JSON of some tens of kilobytes, to be kept where the
/// original may be lost. It says to anybody whose and which files it is of; only the key reads the rest.
///
/// # Errors
/// Where the original cannot be read.
pub fn record<'a>(
    original: impl Into<Model<'a>>,
    report: &EmbedReport,
    key: &Key,
    options: &RecordOptions,
) -> Result<String, Error> {
    let marking = Marking {
        tag: report.tag.clone(),
        number: report.number,
        strength: report.strength,
        host_sha256: report.host_sha256.clone(),
        marked_sha256: report.marked_sha256.clone(),
    };
    record_of(&original.into(), &marking, key, options)
}

/// The same, from what the record needs of the report.
pub(crate) fn record_of(
    model: &Model,
    marking: &Marking,
    key: &Key,
    options: &RecordOptions,
) -> Result<String, Error> {
    let scene = Scene::gather(&Document::read(model.bytes, model.files)?)?;
    let recorded = with_host(&scene, &options_of_original(), |host| {
        Recorded::new(&Frames::new(host), key)
    })?;
    let mut plain = MAGIC.to_vec();
    Shape::of(&scene.mesh).write(&mut plain);
    plain.extend(recorded.to_bytes());
    let clear = Clear {
        kind: KIND.to_owned(),
        version: VERSION,
        tool: concat!("meshmark ", env!("CARGO_PKG_VERSION")).to_owned(),
        owner: options.owner.clone().filter(|owner| !owner.is_empty()),
        date: options.date.clone().filter(|date| !date.is_empty()),
        tag: marking.tag.clone(),
        number: marking.number,
        strength: marking.strength,
        host_sha256: marking.host_sha256.clone(),
        marked_sha256: marking.marked_sha256.clone(),
        key_commitment: key.commitment(),
    };
    let sealed = STANDARD.encode(key.seal(&plain, &clear.bytes()));
    let stored = Stored { clear, sealed };
    Ok(serde_json::to_string_pretty(&stored).unwrap_or_default())
}

/// Reads a suspect with the record of an embedding instead of the original: as [`compare`](crate::compare), with about half of its exponent, and
/// not where less than half of the model is left.
///
/// # Errors
/// As [`compare`](crate::compare), and [`Error::Record`] where the record was not made by [`record`] with this key, or was changed since.
pub fn compare_with_record<'a>(
    suspect: impl Into<Suspect<'a>>,
    record: &str,
    key: &Key,
) -> Result<Comparison, Error> {
    Ok(compare_in(suspect.into(), record, key, None)?.comparison)
}

/// As [`verify_with_original`](crate::verify_with_original), with the record of an embedding instead of the original.
///
/// # Errors
/// As [`compare_with_record`].
pub fn verify_with_record<'a>(
    suspect: impl Into<Suspect<'a>>,
    record: &str,
    key: &Key,
    expected: Payload,
) -> Result<Comparison, Error> {
    Ok(compare_in(suspect.into(), record, key, Some(expected))?.comparison)
}

/// As [`compare_with_record`], or as [`verify_with_record`] where a payload is expected, with the suspect laid on the recorded shape, to be looked at;
/// `None` for another shape. Where they differ by less than a record's few triangles show, it is the record that differs.
///
/// # Errors
/// As [`compare_with_record`].
pub fn compare_overlaid_with_record<'a>(
    suspect: impl Into<Suspect<'a>>,
    record: &str,
    key: &Key,
    expected: Option<Payload>,
) -> Result<(Comparison, Option<Overlay>), Error> {
    Ok(compare_in(suspect.into(), record, key, expected)?.overlaid_on_record())
}

fn compare_in(
    mut suspect: Suspect,
    record: &str,
    key: &Key,
    expected: Option<Payload>,
) -> Result<Compared, Error> {
    hear_with_record(&mut suspect, record, key, expected, None)?.compared(suspect, key, expected)
}

/// Reads a suspect with a record. `loudest` hears all that is read, where it is asked whose copies the suspect was made of.
pub(super) fn hear_with_record(
    suspect: &mut Suspect,
    record: &str,
    key: &Key,
    expected: Option<Payload>,
    loudest: Option<&mut Loudest>,
) -> Result<Informed, Error> {
    let (shape, recorded) = opened(record, key)?;
    suspect.step(Stage::Read, 0.0)?;
    let mesh = suspect.mesh()?;
    suspect.step(Stage::Measure, 0.0)?;
    let original = shape.mesh();
    let heard = hear(&original, &recorded, &mesh, key, expected, loudest, suspect)?;
    Ok(Informed {
        heard,
        original,
        suspect: mesh,
    })
}

fn hear(
    shape: &Mesh,
    recorded: &Recorded,
    suspect: &Mesh,
    key: &Key,
    expected: Option<Payload>,
    loudest: Option<&mut Loudest>,
    progress: &mut dyn Progress,
) -> Result<Heard, Error> {
    let original = Original::new(shape);
    let mut ears = Ears::new(Scales::new(key).expecting(expected), loudest);
    let mut lays: Vec<Lay> = Vec::new();
    let mut read = |mesh: &Mesh, motions: &[Motion], known: usize| {
        let mut is_settled = false;
        recorded.read(mesh, motions, key, &mut |mut way| {
            way.list = 2 * (known + way.list);
            is_settled = ears.hear(way);
            is_settled
        });
        is_settled || ears.are_loud()
    };
    let mut assembled = None;
    for found in Searches::new(&original, suspect) {
        crate::progress::step(progress, Stage::Test, 0.0)?;
        let known = lays.len();
        let is_settled = match found {
            Found::Whole(registrations) => {
                let motions: Vec<Motion> = registrations.iter().map(|r| r.motion).collect();
                lays.extend(registrations.into_iter().map(|registration| Lay {
                    registration,
                    num_parts: 1,
                    is_bent: false,
                    covered: original.covered_by(suspect, &registration.motion),
                }));
                read(suspect, &motions, known)
            }
            Found::Apart(assembly) => {
                lays.push(Lay {
                    registration: assembly.registration,
                    num_parts: assembly.num_parts,
                    is_bent: assembly.is_bent,
                    covered: original.covered_by(&assembly.mesh, &Motion::IDENTITY),
                });
                let is_settled = read(&assembly.mesh, &[Motion::IDENTITY], known);
                assembled = Some(assembly.mesh);
                is_settled
            }
        };
        if is_settled {
            break;
        }
    }
    let by_near = |a: &&Lay, b: &&Lay| a.registration.near.total_cmp(&b.registration.near);
    let scales = ears.scales.conclude();
    Ok(Heard {
        other: scales.other,
        ln_p_presence: scales.ln_p_presence,
        ln_p_payload: scales.ln_p_payload,
        payload: scales.payload,
        witness: Witness::Surface,
        first: lays.iter().max_by(by_near).copied(),
        read: lays.get(scales.list / 2).copied(),
        assembled,
        spoken: scales.spoken,
    })
}

/// What a record holds, if it is one of this key and as it was written.
fn opened(record: &str, key: &Key) -> Result<(Shape, Recorded), RecordError> {
    let stored: Stored = serde_json::from_str(record).map_err(|_| RecordError::NotARecord)?;
    let clear = &stored.clear;
    if clear.kind != KIND {
        return Err(RecordError::NotARecord);
    }
    if clear.version != VERSION {
        return Err(RecordError::Version(clear.version));
    }
    if clear.key_commitment != key.commitment() {
        return Err(RecordError::OtherKey);
    }
    let sealed = STANDARD.decode(&stored.sealed);
    let sealed = sealed.map_err(|_| RecordError::Damaged)?;
    let plain = key.unseal(&sealed, &clear.bytes());
    let plain = plain.ok_or(RecordError::Damaged)?;
    contents(&plain).map_err(|_| RecordError::Damaged)
}

fn contents(mut bytes: &[u8]) -> Result<(Shape, Recorded), StoredError> {
    if take(&mut bytes)? != *MAGIC {
        return Err(StoredError::Damaged);
    }
    let shape = Shape::read(&mut bytes)?;
    let recorded = Recorded::read_bytes(&mut bytes)?;
    match bytes {
        [] => Ok((shape, recorded)),
        _ => Err(StoredError::Damaged),
    }
}

/// The original's shape with few faces, on a grid.
struct Shape {
    low: DVec3,
    unit: f64,
    positions: Vec<[u16; 3]>,
    triangles: Vec<[u16; 3]>,
}

impl Shape {
    fn of(mesh: &Mesh) -> Shape {
        let few = match mesh.triangles.len() > FACES {
            true => simplify_to(mesh, FACES),
            false => mesh.clone(),
        };
        // What cannot be simplified, many small parts, is kept as far as numbers of 16 bits go.
        let most = few.triangles.iter().take_while({
            let largest = |t: &[u32; 3]| t.iter().all(|v| *v <= u32::from(u16::MAX));
            move |t: &&[u32; 3]| largest(t)
        });
        let few = few.part(most.copied());
        let low = few.positions.iter().fold(DVec3::INFINITY, |a, p| a.min(*p));
        let high = few
            .positions
            .iter()
            .fold(DVec3::NEG_INFINITY, |a, p| a.max(*p));
        let unit = ((high - low).max_element() / GRID).max(f64::MIN_POSITIVE);
        let rounded = |p: &DVec3| ((*p - low) / unit).round().to_array().map(|x| x as u16);
        Shape {
            low,
            unit,
            positions: few.positions.iter().map(rounded).collect(),
            triangles: few.triangles.iter().map(|t| t.map(|v| v as u16)).collect(),
        }
    }

    fn mesh(&self) -> Mesh {
        let position = |p: &[u16; 3]| self.low + DVec3::from_array(p.map(f64::from)) * self.unit;
        Mesh {
            positions: self.positions.iter().map(position).collect(),
            triangles: self.triangles.iter().map(|t| t.map(u32::from)).collect(),
        }
    }

    /// The corner and the unit of the grid, the numbers of vertices and of triangles, then both.
    fn write(&self, bytes: &mut Vec<u8>) {
        let [x, y, z] = self.low.to_array();
        for number in [x, y, z, self.unit] {
            bytes.extend(number.to_le_bytes());
        }
        for list in [&self.positions, &self.triangles] {
            bytes.extend((list.len() as u32).to_le_bytes());
        }
        for number in self.positions.iter().chain(&self.triangles).flatten() {
            bytes.extend(number.to_le_bytes());
        }
    }

    fn read(bytes: &mut &[u8]) -> Result<Shape, StoredError> {
        let mut numbers = [0.0; 4];
        for number in &mut numbers {
            *number = f64::from_le_bytes(take(bytes)?);
        }
        let [x, y, z, unit] = numbers;
        let mut lens = [0usize; 2];
        for len in &mut lens {
            *len = u32::from_le_bytes(take(bytes)?) as usize;
        }
        let mut list = |len: usize| -> Result<Vec<[u16; 3]>, StoredError> {
            if len > bytes.len() / 6 {
                return Err(StoredError::Damaged);
            }
            let mut list = Vec::with_capacity(len);
            for _ in 0..len {
                let [a, b, c, d, e, f] = take(bytes)?;
                list.push([[a, b], [c, d], [e, f]].map(u16::from_le_bytes));
            }
            Ok(list)
        };
        let (positions, triangles) = (list(lens[0])?, list(lens[1])?);
        let is_known = |v: &u16| usize::from(*v) < positions.len();
        let is_finite = numbers.iter().all(|x| x.is_finite());
        match is_finite && unit > 0.0 && triangles.iter().flatten().all(is_known) {
            true => Ok(Shape {
                low: DVec3::new(x, y, z),
                unit,
                positions,
                triangles,
            }),
            false => Err(StoredError::Damaged),
        }
    }
}
