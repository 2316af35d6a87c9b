//! A suspect laid on its original: where they agree, what was changed, what was cut away, and which places speak for the mark.

use super::weigh::Spoken;
use crate::geometry::{Motion, Surface, diagonal, open_sides};
use crate::mesh::Mesh;
use glam::{DMat3, DVec3};

/// Surfaces that are farther from each other than this share of the diagonal have nothing to do with each other.
const FARTHEST: f64 = 0.012;
/// What is nearer than this to where the other one ends belongs to it.
const TOUCHING: f64 = 2e-4;
/// The scale of a map ends where this share of its values does: a few that are larger would leave no colours for the rest.
const SCALED: f64 = 0.98;
/// No scale ends below this share of the diagonal: what is less is the rounding of files.
const LEAST_SCALE: f32 = 1e-5;
/// Directions to look from: so many steps about the vertical axis.
const TURNS: u32 = 8;

/// A suspect laid on its original, to be looked at. For the owner of the key: `evidence` follows it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Overlay {
    /// Whether the original is what a record keeps of it: some 1200 triangles, from which a copy differs a little everywhere.
    pub is_recorded: bool,
    /// The original, in its scene units: what a record keeps of it, where the comparison had no more.
    pub original: Sheet,
    /// The suspect, moved to where it lies on the original, turned over where it is a mirror image.
    pub suspect: Sheet,
    /// For each vertex of the original, how far away the suspect is, as a share of the original's diagonal; infinite where nothing of the
    /// suspect is near: it was cut away, or moved by more than 0.012.
    pub differences: Vec<f32>,
    /// The same for each vertex of the suspect: infinite where it has what the original has not.
    pub additions: Vec<f32>,
    /// A round number up to where nearly all finite differences go: the end of a scale.
    pub most_difference: f32,
    /// For each vertex of the original, what a window there adds to the exponent on the average, in nats: above 0 it speaks for the mark. `None`
    /// where the mark was not read with the original.
    pub evidence: Option<Vec<f32>>,
    /// Up to where nearly all evidence goes; 0 where there is none.
    pub most_evidence: f32,
    /// The original's diagonal, in its scene units.
    pub diagonal: f64,
    /// From where the suspect is seen well: a direction of unit length, away from the model.
    pub from: [f64; 3],
}

/// Triangles to be drawn.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sheet {
    /// V positions.
    pub positions: Vec<[f32; 3]>,
    /// F triples of indices.
    pub triangles: Vec<[u32; 3]>,
}

impl Sheet {
    fn of(mesh: &Mesh) -> Sheet {
        Sheet {
            positions: mesh.positions.iter().map(|p| single(*p)).collect(),
            triangles: mesh.triangles.clone(),
        }
    }
}

impl Overlay {
    pub(super) fn new(
        original: &Mesh,
        suspect: &Mesh,
        motion: [[f64; 3]; 4],
        spoken: Option<&Spoken>,
    ) -> Overlay {
        let [x, y, z, shift] = motion.map(DVec3::from_array);
        let motion = Motion {
            linear: DMat3::from_cols(x, y, z),
            translation: shift,
        };
        let moved = motion.of_mesh(suspect);
        let diagonal = diagonal(&original.positions);
        let differences = distances(original, &moved, diagonal);
        let evidence = spoken.map(|spoken| evidence(original, &differences, spoken));
        Overlay {
            is_recorded: false,
            additions: distances(&moved, original, diagonal),
            most_difference: round(end_of(&differences).max(LEAST_SCALE)),
            most_evidence: evidence.as_deref().map_or(0.0, end_of),
            evidence,
            differences,
            diagonal,
            from: from(original, &moved).to_array(),
            original: Sheet::of(original),
            suspect: Sheet::of(&moved),
        }
    }
}

/// How far each vertex of a mesh is from another mesh, as a share of the diagonal; infinite where that is far away, or ends before it.
fn distances(mesh: &Mesh, other: &Mesh, diagonal: f64) -> Vec<f32> {
    let surface = Surface::new(other);
    let open = open_sides(other);
    let distance = |p: &DVec3| {
        let nearest = surface.nearest(*p);
        let nearest = nearest.map(|n| (n.distance / diagonal, n.is_at_boundary(&open)));
        match nearest {
            Some((distance, false)) if distance <= FARTHEST => distance as f32,
            Some((distance, true)) if distance <= TOUCHING => distance as f32,
            _ => f32::INFINITY,
        }
    };
    mesh.positions.iter().map(distance).collect()
}

/// The mean of what the windows about each vertex say, the nearer the more; 0 where the suspect is not.
fn evidence(mesh: &Mesh, differences: &[f32], spoken: &Spoken) -> Vec<f32> {
    let mut windows = spoken.windows.clone();
    windows.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x));
    let square = spoken.radius * spoken.radius;
    let at = |p: &DVec3| {
        let first = windows.partition_point(|(centre, _)| centre.x < p.x - spoken.radius);
        let (mut sum, mut weights) = (0.0, 0.0);
        let near = windows[first..].iter();
        for (centre, exponent) in near.take_while(|(centre, _)| centre.x <= p.x + spoken.radius) {
            let weight = 1.0 - centre.distance_squared(*p) / square;
            if weight > 0.0 {
                sum += weight * weight * exponent;
                weights += weight * weight;
            }
        }
        if weights > 0.0 { sum / weights } else { 0.0 }
    };
    let all = mesh.positions.iter().zip(differences);
    all.map(|(p, difference)| match difference.is_finite() {
        true => at(p) as f32,
        false => 0.0,
    })
    .collect()
}

/// The value below which nearly all lie that are neither 0 nor infinite; 0 of none.
fn end_of(values: &[f32]) -> f32 {
    let is_one = |value: &f32| value.is_finite() && *value > 0.0;
    let mut values: Vec<f32> = values.iter().copied().filter(is_one).collect();
    let place = (values.len() as f64 * SCALED) as usize;
    match values.is_empty() {
        true => 0.0,
        false => *values.select_nth_unstable_by(place, f32::total_cmp).1,
    }
}

/// The next round number: 1, 2 or 5, and zeros.
fn round(number: f32) -> f32 {
    let mut unit = 1e-6f32;
    while 10.0 * unit < number {
        unit *= 10.0;
    }
    let rounds = [1.0, 2.0, 5.0, 10.0].map(|times| times * unit);
    rounds.into_iter().find(|n| *n >= number).unwrap_or(number)
}

/// From where a suspect is seen: before what is left of it, and from a little above.
fn from(original: &Mesh, suspect: &Mesh) -> DVec3 {
    let ahead = DVec3::new(0.55, 0.35, 1.0).normalize();
    let (mut area, mut facing, mut centre) = (0.0, DVec3::ZERO, DVec3::ZERO);
    for &triangle in &suspect.triangles {
        let [a, b, c] = suspect.corners(triangle);
        let normal = (b - a).cross(c - a) / 2.0;
        area += normal.length();
        facing += normal;
        centre += (a + b + c) / 3.0 * normal.length();
    }
    let low = original.positions.iter().copied().reduce(DVec3::min);
    let high = original.positions.iter().copied().reduce(DVec3::max);
    let (Some(low), Some(high)) = (low, high) else {
        return ahead;
    };
    if area == 0.0 {
        return ahead;
    }
    let size = (high - low).length().max(f64::MIN_POSITIVE);
    let wanted = facing / area + 2.0 * (centre / area - (low + high) / 2.0) / size;
    let turned = |turn: u32| {
        let angle = f64::from(turn) * std::f64::consts::TAU / f64::from(TURNS);
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        DVec3::new(
            cos * ahead.x + sin * ahead.z,
            ahead.y,
            cos * ahead.z - sin * ahead.x,
        )
    };
    let mut best = ahead;
    // The first direction is kept unless another is clearly better.
    for direction in (1..TURNS).map(turned) {
        let gain = if best == ahead { 0.1 } else { 0.0 };
        if direction.dot(wanted) > best.dot(wanted) + gain {
            best = direction;
        }
    }
    best
}

fn single(p: DVec3) -> [f32; 3] {
    p.to_array().map(|x| x as f32)
}
