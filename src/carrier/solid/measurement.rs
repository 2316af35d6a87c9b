//! What SOLID measures of a suspect without a key: its surface in small pieces, in its own frame, as it is and as it may
//! have been before it was smoothed.

use super::field::Field;
use super::flux::clusters;
use super::store::Store;
use super::strength::{FAMILIES, FIRST_FAMILY, HELD_FAMILY, OTHER_FAMILIES};
use super::{
    AREAS, LARGEST_AREA, MOST_PITCHES, PITCHES, SPIKY, SPIKY_IF_FEW, boundary, pitches, pose_of,
    search,
};
use crate::carrier::{Reading, StoredError, possible, take};
use crate::geometry::spectral::{self, InverseFilter};
use crate::geometry::{Pose, oriented, refined};
use crate::key::Key;
use crate::mesh::{Edges, Mesh};
use crate::progress::{Cancelled, Progress};
use glam::DVec3;
use std::borrow::Cow;
use std::collections::VecDeque;
use std::ops::Range;

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

/// Meshes with fewer triangles than this may be simplified ones, whose chords cut off a noticeable part of the shape.
const COARSE: usize = 15_000;

/// On meshes with fewer triangles than this, smoothing moves vertices far: it takes up to half of the area, and what is undone
/// changes much with the strength.
const FEW: usize = 4_000;

/// Shares of vertices on boundaries from which on it matters whether a smoothing held them.
const MANY_ON_BOUNDARIES: f64 = 0.02;

/// No more tables are made once they have so many points together, of 4 bytes each.
const MOST_TABULATED: usize = 1 << 26;

/// What a suspect is measured in.
const STAGES: usize = 5;

/// The pitches that a surface of an area is read at, the finest first.
fn pitches_of(area: f64, pose: &Pose) -> Vec<f64> {
    pitches(area / (pose.size * pose.size), AREAS).collect()
}

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

impl Origin {
    fn read(bytes: [u8; 2]) -> Option<Origin> {
        match bytes {
            [0, 0] => Some(Origin::Suspect),
            [1, 0] => Some(Origin::Refined),
            [family, node] => {
                let family = family.checked_sub(2)?;
                let nodes = FAMILIES.get(usize::from(family))?.len();
                (usize::from(node) < nodes).then_some(Origin::Filtered { family, node })
            }
        }
    }
}

/// A surface of a suspect, in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    pub(super) origin: Origin,
    /// The first and the second axis; the second and the third.
    pub(super) axes: [Axes; 2],
    /// The pitches that it is read at.
    pub(super) pitches: Vec<f64>,
    /// Fine enough for all of them.
    pub(super) store: Store,
    /// For each pitch, where it was made ready for many keys.
    pub(super) fields: Vec<Field>,
}

impl Surface {
    /// Takes a surface from the beginning of bytes: its origin in 2, what its axes are in 2, a bit for each pitch, and its store.
    fn read(bytes: &mut &[u8]) -> Result<Surface, StoredError> {
        let origin = Origin::read(take(bytes)?).ok_or(StoredError::Damaged)?;
        let [first, second] = take(bytes)?;
        let axes = |byte: u8| {
            let known = [Axes::Distinct, Axes::Exchangeable, Axes::Undetermined];
            let axes = known.get(usize::from(byte)).copied();
            axes.ok_or(StoredError::Damaged)
        };
        let axes = [axes(first)?, axes(second)?];
        let [bits] = take(bytes)?;
        let is_read = |(number, pitch): (u8, f64)| (bits >> number & 1 != 0).then_some(pitch);
        let pitches: Vec<f64> = (0..).zip(PITCHES).filter_map(is_read).collect();
        // No more are charged.
        let is_possible = pitches.len() <= MOST_PITCHES && bits >> PITCHES.len() == 0;
        possible(is_possible, "a surface at more pitches than are read")?;
        let finest = *pitches.first().ok_or(StoredError::Damaged)?;
        Ok(Surface {
            origin,
            axes,
            store: Store::read(bytes, finest)?,
            pitches,
            fields: Vec::new(),
        })
    }

    /// Appends the bytes.
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend(match self.origin {
            Origin::Suspect => [0, 0],
            Origin::Refined => [1, 0],
            Origin::Filtered { family, node } => [family + 2, node],
        });
        bytes.extend(self.axes.map(|axes| axes as u8));
        let bit = |own: &f64| 1u8 << PITCHES.partition_point(|pitch| pitch < own);
        bytes.push(self.pitches.iter().map(bit).sum());
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
    /// The suspect's.
    pitches: Vec<f64>,
    area: f64,
    /// What is measured next: the suspect, the refined one, the first family, the others, those that held boundaries.
    next: usize,
    stages: usize,
    ready: VecDeque<Surface>,
}

impl Surfaces {
    /// Prepares a mesh.
    pub fn new(mesh: &Mesh) -> Surfaces {
        let (mesh, boundary) = oriented(mesh);
        let pose = pose_of(&mesh, &boundary);
        let area = mesh.area();
        let pitches = pose.map_or(Vec::new(), |pose| pitches_of(area, &pose));
        Surfaces {
            boundary,
            mesh,
            pose: pose.filter(|_| !pitches.is_empty()),
            facing: None,
            pitches,
            area,
            next: 0,
            stages: STAGES,
            ready: VecDeque::new(),
        }
    }

    /// The same, for a mesh that nobody has turned since it was marked: its axes are known to be those of the unmarked one.
    pub fn facing(mut self, unmarked: &Surfaces) -> Surfaces {
        self.facing = unmarked.pose;
        self
    }

    fn has_few(&self) -> bool {
        self.mesh.triangles.len() < FEW
    }

    /// The surface as the filter of the family leaves it that held boundaries, where many vertices lie on them.
    fn filtered_inside(&self) -> Vec<(Origin, Cow<'_, Mesh>)> {
        let mut moves = vec![true; self.mesh.positions.len()];
        for &(from, to) in &self.boundary {
            moves[from as usize] = false;
            moves[to as usize] = false;
        }
        let num_held = moves.iter().filter(|moves| !**moves).count();
        if (num_held as f64) < MANY_ON_BOUNDARIES * moves.len() as f64 {
            return Vec::new();
        }
        self.filtered(HELD_FAMILY, &moves)
    }

    /// The surface as the filters of some families leave it, whose smoothing moved some vertices.
    fn filtered(&self, families: Range<usize>, moves: &[bool]) -> Vec<(Origin, Cow<'_, Mesh>)> {
        let has_few = self.has_few();
        let nodes = families.flat_map(|family| {
            let nodes = FAMILIES[family].nodes(has_few);
            nodes.map(move |node| (family as u8, node as u8))
        });
        let nodes: Vec<(u8, u8)> = nodes.collect();
        let filter = |&(family, node): &(u8, u8)| FAMILIES[usize::from(family)].filter(node.into());
        let filters: Vec<InverseFilter> = nodes.iter().map(filter).collect();
        let rings = Edges::new(&self.mesh).rings(self.mesh.positions.len());
        let filtered = spectral::filtered(&self.mesh.positions, &rings, &filters, moves);
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
            2 => self.filtered(FIRST_FAMILY, &vec![true; self.mesh.positions.len()]),
            3 => self.filtered(OTHER_FAMILIES, &vec![true; self.mesh.positions.len()]),
            _ => self.filtered_inside(),
        };
        let largest = self.area * if self.has_few() { SPIKY_IF_FEW } else { SPIKY };
        let in_own_frame = |(origin, mesh): (Origin, Cow<Mesh>)| {
            let boundary = match origin {
                Origin::Refined => Cow::Owned(boundary(&mesh)),
                _ => Cow::Borrowed(&self.boundary),
            };
            let area = mesh.area();
            let own = pose_of(&mesh, &boundary).filter(|_| area <= largest)?;
            // Where there are many triangles it is noise that makes a filtered surface larger.
            let pitches = if self.has_few() {
                pitches_of(area, &own)
            } else {
                self.pitches.clone()
            };
            let finest = *pitches.first()?;
            if area > LARGEST_AREA * (finest * own.size) * (finest * own.size) {
                return None;
            }
            let own = own.aligned_with(self.facing.as_ref().unwrap_or(pose));
            Some(Surface {
                origin,
                axes: match self.facing {
                    Some(_) => [Axes::Distinct; 2],
                    None => axes_of(&own),
                },
                pitches,
                store: Store::new(&clusters(&mesh, &own, finest), finest),
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
        while self.ready.is_empty() && self.next < self.stages {
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
    /// Where tables would take more than half a gigabyte together, the surfaces that come last have none, and are read as for one key.
    ///
    /// What is between the table's points is interpolated, with an RMS error below 2 % of a quantizer's step. No key has a part in
    /// that: the bound of what is read is exact.
    pub fn for_many_keys(mut self) -> Measurement {
        let mut num_points = 0;
        for surface in &mut self.surfaces {
            let clusters = surface.store.clusters();
            for &pitch in &surface.pitches {
                if num_points < MOST_TABULATED {
                    let field = Field::new(&clusters, pitch);
                    num_points += field.len();
                    surface.fields.push(field);
                }
            }
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

    /// A measurement from its bytes.
    ///
    /// # Errors
    /// Where they are none, or hold numbers that no surface gives.
    pub fn from_bytes(mut bytes: &[u8]) -> Result<Measurement, StoredError> {
        let mut surfaces = Vec::new();
        while !bytes.is_empty() {
            surfaces.push(Surface::read(&mut bytes)?);
        }
        // Each surface is charged once.
        let is_first = |surface: &Surface| surface.origin == Origin::Suspect;
        let in_order = |pair: &[Surface]| pair[0].origin < pair[1].origin;
        possible(
            surfaces.first().is_none_or(is_first),
            "surfaces without the suspect's own",
        )?;
        possible(
            surfaces.windows(2).all(in_order),
            "surfaces out of order or twice",
        )?;
        Ok(Measurement { surfaces })
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

impl Surfaces {
    /// Only the suspect as it is.
    pub fn plain(mut self) -> Surfaces {
        self.stages = 1;
        self
    }

    /// Only what undoes nothing, chords or the first kind of smoothing.
    pub fn first_kind(mut self) -> Surfaces {
        self.stages = 3;
        self
    }

    /// The soft symbols of a key: no more surfaces are measured than it takes to find its mark.
    pub fn read(self, key: &Key, progress: &mut dyn Progress) -> Result<Reading, Cancelled> {
        search::read(&mut self.map(Cow::Owned), key, progress)
    }
}
