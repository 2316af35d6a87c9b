//! The pieces of a scene: what may have been a model of its own, told from the surface alone.
//!
//! Parts whose boxes touch make an object: a figure and what it holds, a table's top and its
//! legs. Neither depends on where the scene lies, on names or on nodes, so pieces are the same after joining, flattening and turning.
//! An edge that more than two triangles meet at joins what was made apart: a shell on a bridge, a copy that shares some vertices. What hangs
//! together without it is read alone too.

use super::Pose;
use crate::mesh::{Edges, Mesh, Sets};
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// A piece of fewer triangles is too small to hold a mark.
const LEAST_TRIANGLES: usize = 100;

/// Parts of the most triangles, among which objects are looked for: all pairs are compared.
const MOST_PARTS: usize = 512;

/// Boxes touch where they are nearer to each other than this part of the smaller one's diagonal.
const TOUCH: f64 = 0.02;

/// Parts of an object that may have been put there, those of the largest areas: the rest of the object is read without each of them.
const LEFT_OUT: usize = 6;

/// A part that is thinner than this part of its diagonal, and wider than the next, is a sheet: a floor, a wall, a terrain. It is no
/// object with what stands on it.
const THIN: f64 = 0.1;
const WIDE: f64 = 0.3;

/// Triangles of a mesh that may have been a model.
pub type Piece = Vec<[u32; 3]>;

/// The objects of a mesh, and those of their patches that could hold a mark alone; of each, those that have most triangles first.
pub struct Pieces {
    /// None where the whole mesh is one object.
    pub objects: Vec<Piece>,
    /// What hangs together by edges of two triangles, where that is no object itself.
    pub patches: Vec<Piece>,
    /// Objects of three parts and more without one of them: what stands too near a model of several parts, or is hidden in it.
    pub rests: Vec<Piece>,
}

impl Pieces {
    /// Finds them. O(V + F + P^2), P the number of parts, at most 512.
    pub fn of(mesh: &Mesh) -> Pieces {
        let edges = Edges::new(mesh);
        let parts = parts(mesh, &edges);
        let objects = objects_of(&boxes(mesh, &parts), 1.0);
        let patches = match edges.num_non_manifold() {
            0 => edges.components(),
            _ => edges.winding().patches,
        };
        let patches_of = |object: &Vec<u32>| {
            let numbers = object.iter().flat_map(|&part| &parts[part as usize]);
            let mut patches_of = by_name(numbers.map(|&number| (patches[number as usize], number)));
            if patches_of.len() == 1 {
                patches_of.clear();
            }
            patches_of
        };
        let patches = objects.iter().flat_map(patches_of);
        let rests = objects
            .iter()
            .flat_map(|object| rests_of(object, &parts, mesh));
        Pieces {
            rests: largest(rests, mesh),
            patches: largest(patches, mesh),
            objects: largest(objects.iter().map(|object| joined(object, &parts)), mesh),
        }
    }

    /// All of them, as they are read.
    pub fn in_order(self) -> impl Iterator<Item = Piece> {
        let Pieces {
            objects,
            patches,
            rests,
        } = self;
        objects.into_iter().chain(patches).chain(rests)
    }

    /// The objects alone that stay what they are where parts lie somewhat nearer to each other or farther apart, or have fewer
    /// triangles: those of a copy are the same.
    pub fn stable_objects(mesh: &Mesh) -> Vec<Piece> {
        let parts = parts(mesh, &Edges::new(mesh));
        let boxes = boxes(mesh, &parts);
        let [tight, objects, loose] = [0.5, 1.0, 2.0].map(|slack| objects_of(&boxes, slack));
        let is_stable = |object: &&Vec<u32>| tight.contains(object) && loose.contains(object);
        let stable = objects.iter().filter(is_stable);
        largest(stable.map(|object| joined(object, &parts)), mesh)
    }
}

/// Triangles by their numbers.
type Part = Vec<u32>;

fn joined(object: &[u32], parts: &[Part]) -> Part {
    let triangles = object.iter().flat_map(|&part| &parts[part as usize]);
    triangles.copied().collect()
}

/// An object without each of its largest parts. Areas stay where triangles are made fewer.
fn rests_of(object: &[u32], parts: &[Part], mesh: &Mesh) -> Vec<Part> {
    if object.len() < 3 {
        return Vec::new();
    }
    let area = |part: &u32| {
        let part = &parts[*part as usize];
        let twice = |&number: &u32| {
            let [a, b, c] = mesh.corners(mesh.triangles[number as usize]);
            (b - a).cross(c - a).length()
        };
        part.iter().map(twice).sum::<f64>()
    };
    let mut by_area: Vec<(f64, u32)> = object.iter().map(|part| (area(part), *part)).collect();
    by_area.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let rest = |&(_, left_out): &(f64, u32)| {
        let others = object.iter().copied().filter(|&part| part != left_out);
        joined(&others.collect::<Vec<u32>>(), parts)
    };
    by_area.iter().take(LEFT_OUT).map(rest).collect()
}

/// Those that have enough triangles and are not the whole mesh.
fn largest(pieces: impl Iterator<Item = Part>, mesh: &Mesh) -> Vec<Piece> {
    let sizes = LEAST_TRIANGLES..mesh.triangles.len();
    let mut pieces: Vec<Part> = pieces
        .filter(|piece| sizes.contains(&piece.len()))
        .collect();
    pieces.sort_by_key(|piece| Reverse(piece.len()));
    pieces.iter().map(|piece| corners(piece, mesh)).collect()
}

fn corners(part: &[u32], mesh: &Mesh) -> Piece {
    let numbers = part.iter();
    numbers
        .map(|&number| mesh.triangles[number as usize])
        .collect()
}

/// The triangles of each part, most first, no more parts than are compared; of equally many in the order of their first triangles.
fn parts(mesh: &Mesh, edges: &Edges) -> Vec<Part> {
    let mut parts = by_name(
        edges
            .components()
            .into_iter()
            .zip(0..mesh.triangles.len() as u32),
    );
    parts.sort_by_key(|part| Reverse(part.len()));
    parts.truncate(MOST_PARTS);
    parts
}

/// The numbers of each name, names rising.
fn by_name(named: impl Iterator<Item = (u32, u32)>) -> Vec<Part> {
    let mut parts: BTreeMap<u32, Part> = BTreeMap::new();
    for (name, number) in named {
        parts.entry(name).or_default().push(number);
    }
    parts.into_values().collect()
}

/// The box about each part; none where it has no area.
fn boxes(mesh: &Mesh, parts: &[Part]) -> Vec<Option<Enclosing>> {
    let boxed = |part: &Part| Enclosing::of(mesh.part(corners(part, mesh)));
    parts.iter().map(boxed).collect()
}

/// The parts of each object, by their places. `slack` multiplies the limits, and is 1 but where it is asked whether they matter.
fn objects_of(boxes: &[Option<Enclosing>], slack: f64) -> Vec<Vec<u32>> {
    let mut sets = Sets::new(boxes.len());
    for (second, smaller) in (0..).zip(boxes) {
        for (first, larger) in (0..second).zip(boxes) {
            if let (Some(a), Some(b)) = (larger, smaller)
                && a.belongs_with(b, slack)
            {
                sets.join(first, second);
            }
        }
    }
    by_name((0..boxes.len() as u32).map(|part| (sets.find(part), part)))
}

/// A box about a part, along the part's own axes: it turns with the part.
struct Enclosing {
    num_triangles: usize,
    centre: DVec3,
    axes: [DVec3; 3],
    /// Half of the sides.
    halves: [f64; 3],
}

impl Enclosing {
    fn of(part: Mesh) -> Option<Enclosing> {
        let pose = Pose::of(&part)?;
        let axes = [pose.axes.x_axis, pose.axes.y_axis, pose.axes.z_axis];
        let along = |axis: DVec3| {
            let places = part
                .positions
                .iter()
                .map(|position| (*position - pose.centre).dot(axis));
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
                (low.min(place), high.max(place))
            })
        };
        let ranges = axes.map(along);
        let middle = |axis: usize| axes[axis] * ((ranges[axis].0 + ranges[axis].1) / 2.0);
        Some(Enclosing {
            num_triangles: part.triangles.len(),
            centre: pose.centre + middle(0) + middle(1) + middle(2),
            axes,
            halves: ranges.map(|(low, high)| (high - low) / 2.0),
        })
    }

    fn diagonal(&self) -> f64 {
        2.0 * DVec3::from_array(self.halves).length()
    }

    fn is_sheet(&self, slack: f64) -> bool {
        let mut sides = self.halves.map(|half| 2.0 * half / self.diagonal());
        sides.sort_by(f64::total_cmp);
        sides[0] < THIN * slack.sqrt() && sides[1] > WIDE
    }

    /// Whether two parts are of one object: they touch, and the larger one is no floor under the smaller one and no bare box about it.
    fn belongs_with(&self, other: &Enclosing, slack: f64) -> bool {
        let (larger, smaller) = match self.diagonal() >= other.diagonal() {
            true => (self, other),
            false => (other, self),
        };
        larger.num_triangles as f64 >= LEAST_TRIANGLES as f64 * slack
            && !larger.is_sheet(slack)
            && self.is_within(other, TOUCH * slack * smaller.diagonal())
    }

    /// Whether no plane keeps the boxes farther apart than a distance (the separating axes of Gottschalk et al. 1996).
    fn is_within(&self, other: &Enclosing, distance: f64) -> bool {
        let apart = other.centre - self.centre;
        let reach = |of: &Enclosing, axis: DVec3| -> f64 {
            of.axes
                .iter()
                .zip(of.halves)
                .map(|(own, half)| own.dot(axis).abs() * half)
                .sum()
        };
        let crossed = self
            .axes
            .iter()
            .flat_map(|a| other.axes.iter().map(move |b| a.cross(*b)));
        let candidates = self.axes.iter().chain(&other.axes).copied().chain(crossed);
        candidates
            .filter_map(DVec3::try_normalize)
            .all(|axis| apart.dot(axis).abs() <= reach(self, axis) + reach(other, axis) + distance)
    }
}
