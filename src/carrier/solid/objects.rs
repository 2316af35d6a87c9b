//! Embedding in a scene: each of its objects has the mark in its own frame, and keeps it when it is taken out.

use super::embed::{InFrame, embed_in_frame};
use super::frame::has_axes;
use super::rounds::Choice;
use crate::carrier::{Carrier, CarrierError, Embedded, Host, Mark, Needs};
use crate::geometry::{Piece, Pieces};
use crate::mesh::{Admissible, Orbit};
use crate::progress::Progress;
use glam::DVec3;

/// The share of a scene's vertices that has to be in marked objects. Where it is not, the scene is marked as one.
const ENOUGH: f64 = 0.5;

/// So many objects in a row that cannot hold a sturdy mark, and no further one is tried: each takes as long as to refuse a model, and those that follow are smaller.
const IN_VAIN: usize = 8;

/// What an embedding chose for one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chosen {
    /// Which of the scene's stable objects it is; none for the whole.
    pub object: Option<u32>,
    /// With what.
    pub choice: Choice,
}

/// Gives the host the mark: each of its objects, where it has several that can hold a sturdy one, else the whole.
pub fn embed(
    host: &Host,
    mark: &Mark,
    progress: &mut dyn Progress,
) -> Result<Embedded, CarrierError> {
    let objects = Pieces::stable_objects(host.mesh);
    let mut scene = Marked::new(host);
    for (number, object) in (0..).zip(objects) {
        if scene.num_in_vain < IN_VAIN {
            scene.mark(number, object, mark, progress)?;
        }
    }
    let is_enough = scene.num_marked as f64 >= ENOUGH * host.mesh.positions.len() as f64;
    match (scene.embedded(), is_enough) {
        (Some(scene), true) => Ok(scene),
        (scene, _) => match (
            embed_in_frame(host, mark, |needs| needs.presence, progress),
            scene,
        ) {
            (Err(CarrierError::Cancelled(cancelled)), _) => Err(cancelled.into()),
            (Ok(whole), Some(scene)) => {
                let whole = embedded(whole);
                Ok(if whole.is_sturdy() { whole } else { scene })
            }
            (_, Some(scene)) => Ok(scene),
            (whole, None) => whole.map(embedded),
        },
    }
}

/// A host that is marked as a whole.
fn embedded(whole: InFrame) -> Embedded {
    Embedded {
        displacement: whole.displacement,
        carrier: Carrier::Solid,
        exponent: whole.exponent,
        needs: whole.needs,
        chosen: vec![Chosen {
            object: None,
            choice: whole.choice,
        }],
    }
}

/// A scene of which some objects are marked.
pub struct Marked<'a> {
    host: &'a Host<'a>,
    pub displacement: Vec<DVec3>,
    /// Vertices whose displacement is decided: those of marked objects, and what is tied to them.
    is_decided: Vec<bool>,
    /// Vertices of marked objects.
    num_marked: usize,
    /// What the object that holds most reaches, and needs.
    best: Option<(f64, Needs)>,
    chosen: Vec<Chosen>,
    /// Objects that were tried since the last that holds a mark.
    num_in_vain: usize,
}

impl<'a> Marked<'a> {
    pub fn new(host: &'a Host) -> Marked<'a> {
        let num_vertices = host.mesh.positions.len();
        let mut is_decided = vec![false; num_vertices];
        for &vertex in &host.admissible.fixed {
            is_decided[vertex as usize] = true;
        }
        Marked {
            host,
            displacement: vec![DVec3::ZERO; num_vertices],
            is_decided,
            num_marked: 0,
            best: None,
            chosen: Vec::new(),
            num_in_vain: 0,
        }
    }

    fn embedded(self) -> Option<Embedded> {
        let (exponent, needs) = self.best?;
        Some(Embedded {
            displacement: self.displacement,
            carrier: Carrier::Solid,
            exponent,
            needs,
            chosen: self.chosen,
        })
    }

    /// Marks an object, where it can hold a sturdy mark. One that is an instance of a marked one holds its mark already.
    fn mark(
        &mut self,
        number: u32,
        object: Piece,
        mark: &Mark,
        progress: &mut dyn Progress,
    ) -> Result<(), CarrierError> {
        let vertices = vertices_of(&object);
        let mesh = self.host.mesh.part(object);
        let num_moved = vertices
            .iter()
            .filter(|&&vertex| self.displacement[vertex as usize] != DVec3::ZERO)
            .count();
        if 2 * num_moved > vertices.len() {
            self.num_marked += vertices.len();
            return Ok(());
        }
        // A detector scans for axes in one piece at most.
        if !has_axes(&mesh) {
            return Ok(());
        }
        let admissible = self.admissible_in(&vertices);
        let leeway = self.host.leeway.of(&mesh, &vertices);
        let host = Host {
            mesh: &mesh,
            leeway: &leeway,
            admissible: &admissible,
            ..*self.host
        };
        match embed_in_frame(&host, mark, |needs| needs.sturdy, progress) {
            Ok(object) => {
                self.num_in_vain = 0;
                self.decide(&vertices, &object.displacement);
                self.num_marked += vertices.len();
                self.chosen.push(Chosen {
                    object: Some(number),
                    choice: object.choice,
                });
                if self.best.is_none_or(|(most, _)| object.exponent > most) {
                    self.best = Some((object.exponent, object.needs));
                }
                Ok(())
            }
            Err(CarrierError::Cancelled(cancelled)) => Err(cancelled.into()),
            _ => {
                self.num_in_vain += 1;
                Ok(())
            }
        }
    }

    /// What an object's vertices may do, by their places among its own.
    pub fn admissible_in(&self, vertices: &[u32]) -> Admissible {
        let place = |vertex: u32| {
            vertices
                .binary_search(&vertex)
                .ok()
                .map(|place| place as u32)
        };
        let orbits = self.host.admissible.orbits.iter().map(|orbit| Orbit {
            members: orbit
                .members
                .iter()
                .filter_map(|&(vertex, map)| Some((place(vertex)?, map)))
                .collect(),
        });
        let is_decided = |(_, vertex): &(u32, &u32)| self.is_decided[**vertex as usize];
        Admissible {
            orbits: orbits.filter(|orbit| orbit.members.len() > 1).collect(),
            fixed: (0..)
                .zip(vertices)
                .filter(is_decided)
                .map(|(place, _)| place)
                .collect(),
        }
    }

    /// Moves an object's vertices, and what is tied to them.
    pub fn decide(&mut self, vertices: &[u32], displacement: &[DVec3]) {
        for (&vertex, &d) in vertices.iter().zip(displacement) {
            let vertex = vertex as usize;
            if !self.is_decided[vertex] {
                self.displacement[vertex] = d;
                self.is_decided[vertex] = true;
            }
        }
        for orbit in &self.host.admissible.orbits {
            let of_object = orbit
                .members
                .iter()
                .find(|(vertex, _)| vertices.binary_search(vertex).is_ok());
            if let Some(&(vertex, map)) = of_object {
                let shared = map.inverse() * self.displacement[vertex as usize];
                for &(vertex, map) in &orbit.members {
                    self.displacement[vertex as usize] = map * shared;
                    self.is_decided[vertex as usize] = true;
                }
            }
        }
    }
}

/// The vertices of an object, ascending.
pub fn vertices_of(object: &Piece) -> Vec<u32> {
    let mut vertices: Vec<u32> = object.iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}
