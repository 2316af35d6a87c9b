//! Three ways to find the hosts again: by their indices, by ranking again, by the original.

use super::chain::{Chain, Received};
use super::run_length::Channel;
use super::spherical::Spherical;
use super::stability::{Ranking, rank};
use crate::geometry::{Pose, Surface};
use crate::mesh::Mesh;
use glam::{DMat3, DVec3};

/// Hosts that are known by name come in their order.
const IN_ORDER: Channel = Channel {
    insertion: 0.0,
    deletion: 0.0,
};

/// What is hoped of a second ranking.
const NEARLY_IN_ORDER: Channel = Channel {
    insertion: 0.05,
    deletion: 0.05,
};

/// A vertex stands for the surface in a direction that it is off by less than this share of its triangle's size.
const OFF: f64 = 0.25;

/// Vertices by which turns of an original are compared.
const SAMPLES: usize = 400;

/// Rounds of the search for the point of a surface in a direction.
const ROUNDS: usize = 30;

impl Chain<'_> {
    /// The paper's way: where each host went is known. `hosts` gives its index in the suspect, in the order of embedding; `None`
    /// for those that are lost.
    pub fn read_traced(
        &self,
        suspect: &Mesh,
        hosts: &[Option<u32>],
        step: f64,
    ) -> Option<Received> {
        self.read_at(suspect, hosts.iter().copied(), step, IN_ORDER)
    }

    /// The blind way of the paper: the suspect's own ranking is taken for that of the host mesh. It is not: the mark itself
    /// changes the order, and a permutation is nothing that a code against losses and gains could mend.
    pub fn read_ranked(&self, suspect: &Mesh, ranking: Ranking, step: f64) -> Option<Received> {
        let hosts = rank(suspect, ranking).order.into_iter().map(Some);
        self.read_at(suspect, hosts, step, NEARLY_IN_ORDER)
    }

    fn read_at(
        &self,
        suspect: &Mesh,
        hosts: impl Iterator<Item = Option<u32>>,
        step: f64,
        channel: Channel,
    ) -> Option<Received> {
        let spherical = Spherical::of(suspect, self.barycentre)?;
        let point = |host: Option<u32>| suspect.positions.get(host? as usize).copied();
        Some(self.read(&spherical, hosts.map(point), step, channel))
    }

    /// Eq. 1 with k = c || k': the original and its hosts are given. The suspect is turned, scaled and moved to lie as the original
    /// does, by the frames of both, and each host's distance is where the suspect's surface is in the host's direction.
    pub fn read_with_original(
        &self,
        suspect: &Mesh,
        original: &Mesh,
        hosts: &[u32],
        step: f64,
    ) -> Option<Received> {
        let spherical = Spherical::of(original, self.barycentre)?;
        let aligned = aligned(suspect, original)?;
        let surface = Surface::new(&aligned);
        let point = |&host: &u32| {
            let &from = original.positions.get(host as usize)?;
            in_direction(&aligned, &surface, &spherical, from)
        };
        Some(self.read(&spherical, hosts.iter().map(point), step, IN_ORDER))
    }
}

/// The suspect where the original is: of the four ways in which frames fit, the one in which the original's vertices are nearest.
fn aligned(suspect: &Mesh, original: &Mesh) -> Option<Mesh> {
    let (from, to) = (Pose::of_surface(suspect)?, Pose::of_surface(original)?);
    let every = original.positions.len().div_ceil(SAMPLES).max(1);
    let distance = |mesh: &Mesh| {
        let surface = Surface::new(mesh);
        let samples = original.positions.iter().step_by(every);
        let nearest = samples.filter_map(|&point| Some(surface.nearest(point)?.distance));
        nearest.sum::<f64>()
    };
    let turned = Pose::HALF_TURNS.map(|turn| moved(suspect, &from, &to, turn));
    let candidates = turned.into_iter().map(|mesh| (distance(&mesh), mesh));
    candidates
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, mesh)| mesh)
}

fn moved(mesh: &Mesh, from: &Pose, to: &Pose, turn: DVec3) -> Mesh {
    let linear = to.axes * DMat3::from_diagonal(turn) * from.axes.transpose();
    let linear = linear * (to.size / from.size);
    let place = |&p: &DVec3| to.centre + linear * (p - from.centre);
    mesh.with_positions(mesh.positions.iter().map(place).collect())
}

/// The point of a surface in the direction of a point near it: alternately the nearest of the surface and the nearest of the ray,
/// or a vertex met on the way that lies next to the ray. Hosts are peaks, where the surface next to them lies lower.
fn in_direction(
    mesh: &Mesh,
    surface: &Surface,
    spherical: &Spherical,
    from: DVec3,
) -> Option<DVec3> {
    let direction = (from - spherical.origin).try_normalize()?;
    let off = |point: DVec3| (point - spherical.origin).reject_from(direction).length();
    let mut at = from;
    let mut vertex = (OFF, None);
    for _ in 0..ROUNDS {
        let nearest = surface.nearest(at)?;
        let corners = mesh.corners(mesh.triangles[nearest.triangle as usize]);
        let [a, b, c] = corners;
        let size = (b - a).cross(c - a).length().sqrt();
        for corner in corners {
            if off(corner) < vertex.0 * size {
                vertex = (off(corner) / size, Some(corner));
            }
        }
        let along = (nearest.point - spherical.origin).dot(direction);
        at = spherical.origin + direction * along;
    }
    Some(vertex.1.unwrap_or(at))
}
