//! The surfaces that a suspect is measured as: as it is, and as it may have been before it was smoothed or its curves became
//! chords. Each is measured when it is asked for.

use super::cluster::clusters;
use super::frame::{Axes, axes_of};
use super::pitch::{LARGEST_AREA, SPIKY, SPIKY_IF_FEW, pitches_of};
use super::store::Store;
use super::strength::{FAMILIES, FIRST_FAMILY, HELD_FAMILY, OTHER_FAMILIES};
use super::stretch::Stretchable;
use super::surface::{Origin, Surface};
use crate::geometry::spectral::{self, InverseFilter};
use crate::geometry::{Pose, oriented, refined};
use crate::mesh::{Edges, Mesh};
use glam::DVec3;
use std::borrow::Cow;
use std::collections::VecDeque;
use std::ops::Range;

/// Meshes with fewer triangles than this may be simplified ones, whose chords cut off a noticeable part of the shape.
const COARSE: usize = 15_000;

/// On meshes with fewer triangles than this, smoothing moves vertices far: it takes up to half of the area, and what is undone
/// changes much with the strength.
const FEW: usize = 4_000;

/// Shares of vertices on boundaries from which on it matters whether a smoothing held them.
const MANY_ON_BOUNDARIES: f64 = 0.02;

/// What a suspect is measured in.
const STAGES: usize = 5;

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
    may_be_stretched: bool,
    ready: VecDeque<Surface>,
}

impl Surfaces {
    /// Prepares a mesh.
    pub fn new(mesh: &Mesh) -> Surfaces {
        let (mesh, boundary) = oriented(mesh);
        let pose = Pose::of_oriented(&mesh, &boundary);
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
            may_be_stretched: true,
            ready: VecDeque::new(),
        }
    }

    /// The same, for a mesh that nobody has turned since it was marked: its axes are known to be those of the unmarked one.
    pub fn facing(mut self, unmarked: &Surfaces) -> Surfaces {
        self.facing = unmarked.pose;
        self
    }

    /// Whether there is no surface to measure.
    pub fn is_empty(&self) -> bool {
        self.pose.is_none()
    }

    /// The same, taking the axes of its own frame for those that they were: where that is wrong, its mark is not found.
    pub fn facing_itself(mut self) -> Surfaces {
        self.facing = self.pose;
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
                Origin::Refined => {
                    Cow::Owned(Edges::new(&mesh).boundary(&mesh.triangles).collect())
                }
                _ => Cow::Borrowed(&self.boundary),
            };
            let area = mesh.area();
            let own = Pose::of_oriented(&mesh, &boundary).filter(|_| area <= largest)?;
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
                // Who knows how a suspect lies knows too that nobody stretched it.
                stretchable: (origin == Origin::Suspect
                    && self.facing.is_none()
                    && self.may_be_stretched)
                    .then(|| Stretchable::of(&own)),
                pitches,
                store: Store::new(&clusters(&mesh, &own, finest), finest),
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

impl Surfaces {
    /// Only the suspect as it is.
    pub fn plain(mut self) -> Surfaces {
        self.stages = 1;
        self
    }

    /// The same, where nobody stretched it either.
    pub fn untouched(self) -> Surfaces {
        Surfaces {
            may_be_stretched: false,
            ..self.plain()
        }
    }

    /// Only what undoes nothing, chords or the first kind of smoothing.
    pub fn first_kind(mut self) -> Surfaces {
        self.stages = 3;
        self
    }
}
