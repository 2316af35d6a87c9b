//! Embedding another message where one was embedded before: what does not depend on the message is kept.

use super::embed::ground;
use super::lattice::{Lattice, Placement};
use super::objects::{Chosen, Marked, vertices_of};
use super::pitch::pitches_to_embed;
use super::problem::Problem;
use super::rounds::{Choice, Ground, Rounds, dither};
use super::window::Window;
use crate::carrier::{Host, Mark};
use crate::geometry::{Leeway, Pieces};
use crate::key::Key;
use crate::mesh::Admissible;
use glam::{DMat3, DVec3};

/// A host, ready for any message under one key.
pub struct Prepared {
    frames: Vec<Frame>,
}

/// One frame that is marked.
struct Frame {
    /// None for the whole.
    object: Option<Object>,
    ground: Ground,
    placement: Placement,
    problem: Problem<'static>,
    /// Without dithers: those follow the message.
    active: Vec<Window>,
    choice: Choice,
}

/// An object of a scene.
struct Object {
    vertices: Vec<u32>,
    admissible: Admissible,
    leeway: Leeway<'static>,
}

impl Prepared {
    /// Looks at a host as an embedding did that chose these. What cannot be there is left out.
    pub fn new(host: &Host, key: &Key, chosen: &[Chosen]) -> Prepared {
        let lattice = Lattice::of(key);
        let mut scene = Marked::new(host);
        let objects = match chosen.iter().any(|frame| frame.object.is_some()) {
            true => Pieces::stable_objects(host.mesh),
            false => Vec::new(),
        };
        let mut frames = Vec::new();
        for Chosen { object, choice } in chosen {
            let Some(number) = object else {
                frames.extend(Frame::new(host, &lattice, None, choice));
                continue;
            };
            let Some(object) = objects.get(*number as usize) else {
                continue;
            };
            let vertices = vertices_of(object);
            let mesh = host.mesh.part(object.iter().copied());
            let admissible = scene.admissible_in(&vertices);
            scene.decide(&vertices, &vec![DVec3::ZERO; vertices.len()]);
            let leeway = host.leeway.of(&mesh, &vertices);
            let own = Host {
                mesh: &mesh,
                leeway: &leeway,
                admissible: &admissible,
                ..*host
            };
            let object = Object {
                vertices,
                admissible: admissible.clone(),
                leeway: leeway.clone().into_owned(),
            };
            frames.extend(Frame::new(&own, &lattice, Some(object), choice));
        }
        Prepared { frames }
    }

    /// Whether it is objects that are marked.
    pub fn is_in_objects(&self) -> bool {
        self.frames.iter().any(|frame| frame.object.is_some())
    }

    /// The displacement of all vertices of the same host that gives it a mark.
    pub fn again(&self, host: &Host, mark: &Mark, is_thorough: bool) -> Vec<DVec3> {
        let lattice = Lattice::of(mark.key);
        let mut scene = Marked::new(host);
        for frame in &self.frames {
            match &frame.object {
                None => scene.displacement = frame.again(host, &lattice, mark, is_thorough),
                Some(object) => {
                    let own = Host {
                        mesh: &frame.ground.mesh,
                        leeway: &object.leeway,
                        admissible: &object.admissible,
                        ..*host
                    };
                    let displacement = frame.again(&own, &lattice, mark, is_thorough);
                    scene.decide(&object.vertices, &displacement);
                }
            }
        }
        scene.displacement
    }
}

impl Frame {
    fn new(
        host: &Host,
        lattice: &Lattice,
        object: Option<Object>,
        choice: &Choice,
    ) -> Option<Frame> {
        let ground = ground(host)?;
        let placement = lattice.placed(DMat3::IDENTITY, choice.pitch);
        // A plan may be anybody's bytes: a finer lattice has as many windows as it likes.
        let is_fit = pitches_to_embed(ground.area()).any(|pitch| pitch == choice.pitch);
        if !is_fit {
            return None;
        }
        let active = ground.windows(&placement);
        if active.is_empty() {
            return None;
        }
        Some(Frame {
            problem: ground.problem(&placement, &active).into_owned(),
            object,
            placement,
            active,
            choice: *choice,
            ground,
        })
    }

    fn again(&self, host: &Host, lattice: &Lattice, mark: &Mark, is_thorough: bool) -> Vec<DVec3> {
        let mut active = self.active.clone();
        dither(&mut active, lattice, mark.codeword);
        let rounds = Rounds {
            host,
            ground: &self.ground,
            placement: &self.placement,
            problem: &self.problem,
            active: &active,
        };
        rounds.again(&self.choice, is_thorough)
    }
}
