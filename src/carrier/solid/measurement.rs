//! What SOLID measures of a suspect without a key: its surface in small pieces, in its own frame, as it is and as it may
//! have been before it was smoothed.

use super::field::Field;
use super::flux::clusters;
use super::store::{Store, take};
use super::strength::FAMILIES;
use super::{AREAS, boundary, pitches, pose_of, search};
use crate::carrier::Reading;
use crate::geometry::spectral::{self, InverseFilter};
use crate::geometry::{Pose, oriented, refined};
use crate::key::Key;
use crate::mesh::{Edges, Mesh};
use crate::progress::{Cancelled, Progress};
use glam::DVec3;
use std::borrow::Cow;
use std::collections::VecDeque;

/// How well two successive axes of a frame are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axes {
    /// By their spreads.
    Distinct,
    /// Hardly: an attack may have changed their places.
    Exchangeable,
    /// Not at all: they may lie anywhere in their plane.
    Undetermined,
}

/// The first and the second axis; the second and the third.
pub fn axes_of(pose: &Pose) -> [Axes; 2] {
    let apart = |larger: f64, smaller: f64| match smaller / larger {
        ratio if ratio > 0.9 => Axes::Undetermined,
        ratio if ratio > 0.85 => Axes::Exchangeable,
        _ => Axes::Distinct,
    };
    let [x, y, z] = pose.spreads.to_array();
    [apart(x, y), apart(y, z)]
}

/// A filtered surface that is so many times larger has spikes, and is left out.
const SPIKY: f64 = 1.6;

/// Meshes with fewer triangles than this may be simplified ones, whose chords cut off a noticeable part of the shape.
const COARSE: usize = 15_000;

/// What a suspect is measured in.
const STAGES: usize = 4;

/// How a surface came from the suspect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// It is the suspect.
    Suspect,
    /// Chords were replaced by arcs.
    Refined,
    /// A smoothing was undone: a node of [`FAMILIES`].
    Filtered { family: u8, node: u8 },
}

/// A surface of a suspect, in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    pub(super) origin: Origin,
    /// The first and the second axis; the second and the third.
    pub(super) axes: [Axes; 2],
    pub(super) store: Store,
    /// For each pitch that it is read at, where it was made ready for many keys.
    pub(super) fields: Vec<Field>,
}

impl Surface {
    /// Takes a surface from the beginning of bytes: its origin in 2, what its axes are in 2, and its store.
    fn read(bytes: &mut &[u8]) -> Option<Surface> {
        let origin = match take(bytes)? {
            [0, 0] => Origin::Suspect,
            [1, 0] => Origin::Refined,
            [family, node] => {
                let family = family.checked_sub(2)?;
                let nodes = FAMILIES.get(usize::from(family))?.len();
                (usize::from(node) < nodes).then_some(Origin::Filtered { family, node })?
            }
        };
        let [first, second] = take(bytes)?;
        let axes = |byte: u8| {
            [Axes::Distinct, Axes::Exchangeable, Axes::Undetermined]
                .get(usize::from(byte))
                .copied()
        };
        Some(Surface {
            origin,
            axes: [axes(first)?, axes(second)?],
            store: Store::read(bytes)?,
            fields: Vec::new(),
        })
    }

    /// The pitches that a suspect is read at, if this is the suspect.
    pub(super) fn pitches(&self) -> Vec<f64> {
        let clusters = self.store.clusters();
        let area = clusters.iter().map(|cluster| cluster.weight).sum();
        pitches(area, AREAS)
            .filter(|pitch| *pitch >= self.store.pitch)
            .collect()
    }

    /// Appends the bytes.
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend(match self.origin {
            Origin::Suspect => [0, 0],
            Origin::Refined => [1, 0],
            Origin::Filtered { family, node } => [family + 2, node],
        });
        bytes.extend(self.axes.map(|axes| axes as u8));
        self.store.write(bytes);
    }
}

/// The surfaces of a suspect, measured as they are asked for: a marked one is mostly found in the first.
pub struct Surfaces {
    mesh: Mesh,
    boundary: Vec<(u32, u32)>,
    pose: Option<Pose>,
    /// The frame whose axes are followed, where it is known.
    facing: Option<Pose>,
    pitch: f64,
    area: f64,
    /// What is measured next: the suspect, the refined one, the first family, the others.
    next: usize,
    ready: VecDeque<Surface>,
}

impl Surfaces {
    /// Prepares a mesh.
    pub fn new(mesh: &Mesh) -> Surfaces {
        let (mesh, boundary) = oriented(mesh);
        let pose = pose_of(&mesh, &boundary);
        let area = mesh.area();
        let in_frame = pose.map_or(0.0, |pose| area / (pose.size * pose.size));
        let finest = pitches(in_frame, AREAS).reduce(f64::min);
        Surfaces {
            boundary,
            mesh,
            pose: pose.filter(|_| finest.is_some()),
            facing: None,
            pitch: finest.unwrap_or(0.0),
            area,
            next: 0,
            ready: VecDeque::new(),
        }
    }

    /// The same, for a mesh that nobody has turned since it was marked: its axes are known to be those of the unmarked one.
    pub fn facing(self, unmarked: &Surfaces) -> Surfaces {
        Surfaces {
            facing: unmarked.pose,
            ..self
        }
    }

    /// The surface as the filters of some families leave it.
    fn filtered(&self, families: std::ops::Range<usize>) -> Vec<(Origin, Cow<'_, Mesh>)> {
        let nodes = families.flat_map(|family| {
            (0..FAMILIES[family].len()).map(move |node| (family as u8, node as u8))
        });
        let nodes: Vec<(u8, u8)> = nodes.collect();
        let filter = |&(family, node): &(u8, u8)| FAMILIES[usize::from(family)].filter(node.into());
        let filters: Vec<InverseFilter> = nodes.iter().map(filter).collect();
        let rings = Edges::new(&self.mesh).rings(self.mesh.positions.len());
        let filtered = spectral::filtered(&self.mesh.positions, &rings, &filters);
        let surface = |((family, node), positions): ((u8, u8), Vec<DVec3>)| {
            let mesh = self.mesh.with_positions(positions);
            (Origin::Filtered { family, node }, Cow::Owned(mesh))
        };
        nodes.into_iter().zip(filtered).map(surface).collect()
    }

    /// Measures what comes next: one surface or, for smoothing shares most of the work, all of some families.
    fn measure(&self, stage: usize, pose: &Pose) -> VecDeque<Surface> {
        let found: Vec<(Origin, Cow<Mesh>)> = match stage {
            0 => vec![(Origin::Suspect, Cow::Borrowed(&self.mesh))],
            1 if self.mesh.triangles.len() < COARSE => {
                vec![(Origin::Refined, Cow::Owned(refined(&self.mesh)))]
            }
            1 => Vec::new(),
            2 => self.filtered(0..1),
            _ => self.filtered(1..FAMILIES.len()),
        };
        let largest = SPIKY * self.area;
        let in_own_frame = |(origin, mesh): (Origin, Cow<Mesh>)| {
            let boundary = match origin {
                Origin::Refined => Cow::Owned(boundary(&mesh)),
                _ => Cow::Borrowed(&self.boundary),
            };
            let own = pose_of(&mesh, &boundary).filter(|_| mesh.area() <= largest)?;
            let own = own.aligned_with(self.facing.as_ref().unwrap_or(pose));
            Some(Surface {
                origin,
                axes: match self.facing {
                    Some(_) => [Axes::Distinct; 2],
                    None => axes_of(&own),
                },
                store: Store::new(&clusters(&mesh, &own, self.pitch), self.pitch),
                fields: Vec::new(),
            })
        };
        found.into_iter().filter_map(in_own_frame).collect()
    }
}

impl Iterator for Surfaces {
    type Item = Surface;

    fn next(&mut self) -> Option<Surface> {
        let pose = self.pose?;
        while self.ready.is_empty() && self.next < STAGES {
            self.ready = self.measure(self.next, &pose);
            self.next += 1;
        }
        self.ready.pop_front()
    }
}

/// Key-free measurement of a mesh: all its surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    surfaces: Vec<Surface>,
}

impl Measurement {
    /// Measures a mesh.
    pub fn new(mesh: &Mesh) -> Measurement {
        Surfaces::new(mesh).collect()
    }

    /// The same measurement, made ready to be read with many keys: what each surface shows at any place is tabulated. That takes up
    /// to seconds and some 60 MB a surface. A key then costs about half on surfaces whose tables are small, and no less where they
    /// are too large for the processor's cache.
    ///
    /// What is between the table's points is interpolated, with an RMS error below 2 % of a quantizer's step. No key has a part in
    /// that: the bound of what is read is exact.
    pub fn for_many_keys(mut self) -> Measurement {
        let pitches = self.surfaces.first().map_or(Vec::new(), Surface::pitches);
        for surface in &mut self.surfaces {
            let clusters = surface.store.clusters();
            let field = |&pitch: &f64| Field::new(&clusters, pitch);
            surface.fields = pitches.iter().map(field).collect();
        }
        self
    }

    /// The soft symbols of a key.
    pub fn read(&self, key: &Key, progress: &mut dyn Progress) -> Result<Reading, Cancelled> {
        search::read(&mut self.surfaces.iter().map(Cow::Borrowed), key, progress)
    }

    /// The measurement as bytes: its surfaces one after the other.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.surfaces
            .iter()
            .for_each(|surface| surface.write(&mut bytes));
        bytes
    }

    /// A measurement from its bytes; `None` if they are not such.
    pub fn from_bytes(mut bytes: &[u8]) -> Option<Measurement> {
        let mut surfaces = Vec::new();
        while !bytes.is_empty() {
            surfaces.push(Surface::read(&mut bytes)?);
        }
        // Each surface is charged once, and all are read at the suspect's pitches: forged evidence may not say otherwise.
        let is_first = |surface: &Surface| surface.origin == Origin::Suspect;
        let in_order = |pair: &[Surface]| {
            pair[0].origin < pair[1].origin && pair[0].store.pitch == pair[1].store.pitch
        };
        let is_sound = surfaces.first().is_none_or(is_first) && surfaces.windows(2).all(in_order);
        is_sound.then_some(Measurement { surfaces })
    }
}

/// Some of the surfaces of a suspect make a measurement too: one that knows of fewer attacks.
impl FromIterator<Surface> for Measurement {
    fn from_iter<I: IntoIterator<Item = Surface>>(surfaces: I) -> Measurement {
        Measurement {
            surfaces: surfaces.into_iter().collect(),
        }
    }
}

/// Surfaces until the first kind of smoothing has been undone.
pub const FIRST_FAMILY: usize = 2 + FAMILIES[0].len();

impl Surfaces {
    /// The soft symbols of a key from up to so many surfaces: no more are measured than it takes to find its mark.
    pub fn read(
        self,
        most: usize,
        key: &Key,
        progress: &mut dyn Progress,
    ) -> Result<Reading, Cancelled> {
        search::read(&mut self.take(most).map(Cow::Owned), key, progress)
    }
}
