//! What is checked: a model, or a surface that came in another format.

use super::{Error, Model};
use crate::document::Document;
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress, Stage, step};
use crate::scene::Scene;
use std::ops::ControlFlow;

/// What is checked. A model does it, and a reference to its bytes; a [`Surface`] is what a file of any other format comes to.
pub struct Suspect<'a>(Kind<'a>);

enum Kind<'a> {
    Model(Model<'a>),
    Surface(Surface<'a>),
}

/// Positions, and triangles between them by index: what a reader of .obj, .stl, .ply or any other format gives. Units and axes do
/// not matter, nor whether triangles share their vertices; that they are not mirrored does, and which side of them is outside.
///
/// ```
/// use meshmark::{Key, Surface, Verdict, detect};
///
/// # fn main() -> Result<(), meshmark::Error> {
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let answer = detect(Surface::new(&positions, &[[0, 1, 2]]), &Key::from_bytes(&[1; 32])?, None)?;
/// assert_ne!(answer.verdict, Verdict::Found);
/// # Ok(())
/// # }
/// ```
pub struct Surface<'a> {
    positions: &'a [[f64; 3]],
    triangles: &'a [[u32; 3]],
    progress: Option<&'a mut dyn Progress>,
}

impl<'a> Surface<'a> {
    /// A surface; what its triangles do not use does not matter.
    pub fn new(positions: &'a [[f64; 3]], triangles: &'a [[u32; 3]]) -> Surface<'a> {
        Surface {
            positions,
            triangles,
            progress: None,
        }
    }

    /// The same, watched: `progress` hears how far the work is, and can end it.
    pub fn with_progress(self, progress: &'a mut dyn Progress) -> Surface<'a> {
        Surface {
            progress: Some(progress),
            ..self
        }
    }
}

impl Suspect<'_> {
    /// The mesh that is looked at.
    pub(super) fn mesh(&self) -> Result<Mesh, Error> {
        Ok(match &self.0 {
            Kind::Model(model) => Scene::gather(&Document::read(model.bytes, model.files)?)?.mesh,
            Kind::Surface(surface) => Scene::surface(surface.positions, surface.triangles)?,
        })
    }

    /// What a model calls some of its vertices.
    pub(super) fn name_of(&self, vertices: &[u32]) -> Option<String> {
        let Kind::Model(model) = &self.0 else {
            return None;
        };
        let document = Document::read(model.bytes, model.files).ok()?;
        let scene = Scene::gather(&document).ok()?;
        scene.name_of(&document, vertices).map(str::to_owned)
    }

    /// Says how far the work is.
    pub(super) fn step(&mut self, stage: Stage, fraction: f64) -> Result<(), Cancelled> {
        step(self, stage, fraction)
    }
}

impl<'a> From<Model<'a>> for Suspect<'a> {
    fn from(model: Model<'a>) -> Suspect<'a> {
        Suspect(Kind::Model(model))
    }
}

impl<'a> From<Surface<'a>> for Suspect<'a> {
    fn from(surface: Surface<'a>) -> Suspect<'a> {
        Suspect(Kind::Surface(surface))
    }
}

impl<'a, B: AsRef<[u8]> + ?Sized> From<&'a B> for Suspect<'a> {
    fn from(bytes: &'a B) -> Suspect<'a> {
        Model::from(bytes).into()
    }
}

impl Progress for Suspect<'_> {
    fn report(&mut self, stage: Stage, fraction: f64) -> ControlFlow<()> {
        match &mut self.0 {
            Kind::Model(model) => model.report(stage, fraction),
            Kind::Surface(Surface {
                progress: Some(progress),
                ..
            }) => progress.report(stage, fraction),
            Kind::Surface(_) => ControlFlow::Continue(()),
        }
    }
}
