//! What a scene shows, counted before any of it is loaded: a small file may show the same bytes many times.

use super::{IN_A_TAB, MAX_ELEMENTS, MAX_PARTS, MAX_TRIANGLES, SceneError};
use crate::document::{Document, DocumentError, MAX_UNBACKED, Mesh};
use std::collections::BTreeSet;

/// What helps against too much of what can be seen.
const DIVIDE: &str = if IN_A_TAB {
    "the command line takes more than a browser tab; or make several files of the scene, or show fewer instances"
} else {
    "make several files of the scene, or show fewer instances"
};

/// What helps against too much of nothing.
const LEAVE_OUT: &str = "each of them is the same point, so leave them out";

/// What all nodes show together, every instance counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Mesh parts with triangles: primitives, each as often as a node shows it.
    pub parts: u64,
    /// Elements of their position accessors, each accessor once a node.
    pub elements: u64,
    /// Their triangles, degenerate ones included.
    pub triangles: u64,
    /// Of the elements, and of the triangles' indices, those that are stored nowhere.
    pub unbacked: u64,
}

impl Count {
    /// Counts what nodes show, by the mesh of each. Reads no element. O(parts of the document + nodes), log factors aside.
    pub fn new(
        document: &Document,
        shown: impl Iterator<Item = usize>,
    ) -> Result<Count, DocumentError> {
        let of_mesh = |(index, mesh)| Count::of_mesh(document, index, mesh);
        let meshes: Vec<Count> = document
            .meshes()
            .iter()
            .enumerate()
            .map(of_mesh)
            .collect::<Result<_, _>>()?;
        let shown = shown.filter_map(|mesh| meshes.get(mesh));
        Ok(shown.fold(Count::default(), |sum, count| sum.plus(count)))
    }

    /// What one node shows of a mesh.
    fn of_mesh(document: &Document, index: usize, mesh: &Mesh) -> Result<Count, DocumentError> {
        let mut count = Count::default();
        let mut seen = BTreeSet::new();
        for (part, primitive) in mesh.primitives.iter().enumerate() {
            let triangles = document.num_triangles(index, part) as u64;
            let Some(accessor) = primitive.position.filter(|_| triangles > 0) else {
                continue;
            };
            let is_new = seen.insert(accessor);
            let unbacked = primitive
                .indices
                .into_iter()
                .chain(is_new.then_some(accessor));
            count = count.plus(&Count {
                parts: 1,
                elements: if is_new {
                    document.num_positions(accessor)? as u64
                } else {
                    0
                },
                triangles,
                unbacked: unbacked
                    .map(|accessor| document.num_unbacked(accessor) as u64)
                    .fold(0, u64::saturating_add),
            });
        }
        Ok(count)
    }

    fn plus(&self, other: &Count) -> Count {
        Count {
            parts: self.parts.saturating_add(other.parts),
            elements: self.elements.saturating_add(other.elements),
            triangles: self.triangles.saturating_add(other.triangles),
            unbacked: self.unbacked.saturating_add(other.unbacked),
        }
    }

    /// Holds the counts against the limits.
    ///
    /// # Errors
    ///
    /// [`SceneError::TooLarge`] for the first count that is beyond its limit.
    pub fn check(&self) -> Result<(), SceneError> {
        // What is nothing first, for it may be counted as triangles or vertices too.
        let limited = [
            (
                "vertices and indices without data",
                self.unbacked,
                MAX_UNBACKED,
                LEAVE_OUT,
            ),
            ("triangles", self.triangles, MAX_TRIANGLES, DIVIDE),
            ("vertices", self.elements, MAX_ELEMENTS, DIVIDE),
            ("mesh parts", self.parts, MAX_PARTS, DIVIDE),
        ];
        let mut beyond = limited.into_iter();
        match beyond.find(|(_, value, limit, _)| value > limit) {
            Some((what, value, limit, advice)) => Err(SceneError::TooLarge {
                what,
                value,
                limit,
                advice,
            }),
            None => Ok(()),
        }
    }
}
