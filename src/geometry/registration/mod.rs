//! Registration: how a suspect lies on an original, whole or a piece of it, turned, scaled, sheared or mirrored. Knows no key.
//!
//! | file | idea |
//! |---|---|
//! | `moments` | where a whole copy may lie |
//! | `points` | what stands for a suspect |
//! | `features` | where a piece may lie |
//! | `icp` | from nearly right to right |
//! | `bent` | a part that bends |
//! | `apart` | a suspect whose parts lie in ways of their own |
//!
//! Points of the suspect are held against the original, and not the other way round: so it does not matter how much was cut off.

mod apart;
mod bent;
mod features;
mod icp;
mod moments;
mod points;

use super::{Motion, Surface, diagonal};
use crate::mesh::Mesh;
pub use apart::Assembly;
use features::Look;
use glam::DVec3;
use icp::{Freedom, refined};
use points::{MIRROR, Points};
use std::cell::OnceCell;

/// Points that candidates are scored on, that they are refined on, and that the last steps are made on.
const SCORED: usize = 400;
const REFINED: usize = 700;
const LAST: usize = 6000;
/// Points that features are taken from.
const CLOUD: usize = 30_000;
/// As shares of the diagonal: near enough for a candidate, and for a registration.
const COARSE: f64 = 0.03;
const FINE: f64 = 0.006;
/// Near enough to be this side of a symmetric shape and not the other.
const EXACT: f64 = 0.0015;
/// Candidates that are refined.
const FOLLOWED: usize = 5;
/// A share of near points with which nothing more is looked for; whole copies, and pieces.
const CLEAR: f64 = 0.85;
/// By how much more a motion may stretch one way than another, and the least share of the original's area that it may leave of a suspect.
const MOST_STRETCHED: f64 = 4.0;
const LEAST_AREA: f64 = 0.02;
/// Hypotheses that are kept, and how much less near than the best they may be.
const KEPT: usize = 3;
const NEARLY: f64 = 0.12;
/// What is less near than this after the last steps on few points is not tried on all: it is not read as it is.
const HOPELESS: f64 = 0.35;
/// Rounds on all points of what was brought near on a few: after each round what is left is a small part of what was.
const LAST_ROUNDS: usize = 5;
/// How far a candidate and the last steps may take a suspect, as shares of the diagonal: what does not lie there shrinks, or is flattened, until it does.
const FARTHEST: [f64; 2] = [0.15, 0.1];
/// What is less near than this lies on no original.
pub const LEAST_NEAR: f64 = 0.6;

/// An original that suspects are held against.
pub struct Original<'a> {
    /// Its mesh.
    pub mesh: &'a Mesh,
    /// The same in a tree.
    pub surface: Surface<'a>,
    /// The diagonal of its box.
    pub diagonal: f64,
    area: f64,
    points: Points,
    looks: OnceCell<Vec<Look>>,
}

/// Where a suspect is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Where it is, and where its moments lead: for whole copies, mirrored or not, and affine images of them.
    Quick,
    /// Where what the surface looks like leads: for pieces.
    Pieces,
    /// The same for mirror images of pieces.
    Mirrored,
}

impl Search {
    /// Every search, the quickest first.
    pub const ALL: [Search; 3] = [Search::Quick, Search::Pieces, Search::Mirrored];
}

/// How a suspect may lie on an original.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registration {
    /// Takes the suspect onto the original.
    pub motion: Motion,
    /// The share of the suspect's surface that lies on the original then, normals agreeing: 0 to 1.
    pub near: f64,
    /// The same, nearer: what tells the sides of a symmetric shape.
    pub exact: f64,
}

impl Registration {
    fn score(&self) -> f64 {
        self.near + 0.2 * self.exact
    }
}

impl<'a> Original<'a> {
    /// Prepares an original.
    pub fn new(mesh: &'a Mesh) -> Original<'a> {
        Original {
            mesh,
            surface: Surface::new(mesh),
            diagonal: diagonal(&mesh.positions),
            area: mesh.area(),
            points: Points::of(mesh, LAST, 1),
            looks: OnceCell::new(),
        }
    }

    /// What it looks like, for pieces: made when it is needed.
    fn looks(&self) -> &[Look] {
        self.looks.get_or_init(|| {
            let cloud = Points::of(self.mesh, CLOUD, 2);
            features::looks_of_original(&cloud, self.area)
        })
    }

    /// The ways in which a suspect may lie on this original, likeliest first. They depend on the two surfaces alone.
    pub fn registrations(&self, suspect: &Mesh, search: Search) -> Vec<Registration> {
        let points = Points::of(suspect, LAST, 3);
        if points.positions.len() < LAST / 2 {
            return Vec::new();
        }
        let area = suspect.area();
        let mut found = Found::new(self, &points, area);
        if search == Search::Quick {
            let mut whole = vec![Motion::IDENTITY];
            whole.extend(moments::by_axes(&points, &self.points));
            found.follow(whole, Freedom::Similarity);
            if found.best() < CLEAR {
                let affine = moments::by_fourth_moments(&points, &self.points);
                found.follow(affine, Freedom::Affine);
            }
            return found.conclude();
        }
        let mut cloud = Points::of(suspect, CLOUD / 2, 4);
        if search == Search::Mirrored {
            cloud = cloud.mirrored();
        }
        let mut motions = self.by_features(&cloud, area);
        if search == Search::Mirrored {
            motions.iter_mut().for_each(|m| m.linear *= MIRROR);
        }
        found.follow(motions, Freedom::Similarity);
        found.conclude()
    }

    /// Motions by features at every radius.
    fn by_features(&self, cloud: &Points, area: f64) -> Vec<Motion> {
        let look = features::look_of_suspect(cloud, area);
        let looks = self.looks().iter().zip(5..);
        looks
            .flat_map(|(original, seed)| look.onto(original, seed))
            .collect()
    }

    /// The share of this original that a suspect covers when it is moved, 0 to 1.
    pub fn covered_by(&self, suspect: &Mesh, motion: &Motion) -> f64 {
        let moved = motion.of_mesh(suspect);
        let surface = Surface::new(&moved);
        let few = self.points.fewer(10 * SCORED / 4);
        let is_near = |p: &&DVec3| surface.nearest_within(**p, FINE * self.diagonal).is_some();
        few.positions.iter().filter(is_near).count() as f64 / few.positions.len().max(1) as f64
    }

    fn scored(&self, points: &Points, motion: Motion) -> Registration {
        let [near, exact] = self.nears(points, &motion, [FINE, EXACT]);
        Registration {
            motion,
            near,
            exact,
        }
    }

    /// The shares of points that lie as near to the original as each of some distances, the farthest first, when they are moved. Distances are shares of its
    /// diagonal.
    fn nears<const N: usize>(
        &self,
        points: &Points,
        motion: &Motion,
        distances: [f64; N],
    ) -> [f64; N] {
        let mut counts = [0; N];
        let turned = motion.linear.inverse().transpose();
        if !turned.is_finite() {
            return [0.0; N];
        }
        let farthest = distances[0] * self.diagonal;
        for (p, n) in points.positions.iter().zip(&points.normals) {
            let at = motion.of(*p);
            let Some((foot, plane)) = self.surface.foot(at, farthest) else {
                continue;
            };
            if (turned * *n).normalize_or_zero().dot(plane) > 0.5 {
                let distance = foot.distance(at);
                let pairs = counts.iter_mut().zip(distances);
                pairs.for_each(|(count, d)| *count += usize::from(distance < d * self.diagonal));
            }
        }
        counts.map(|count| count as f64 / points.positions.len().max(1) as f64)
    }
}

/// What was found of a suspect so far.
struct Found<'a> {
    original: &'a Original<'a>,
    /// Of the suspect.
    area: f64,
    all: &'a Points,
    scored: Points,
    refined: Points,
    kept: Vec<Registration>,
}

impl<'a> Found<'a> {
    fn new(original: &'a Original, all: &'a Points, area: f64) -> Found<'a> {
        Found {
            original,
            area,
            all,
            scored: all.fewer(SCORED),
            refined: all.fewer(REFINED),
            kept: Vec::new(),
        }
    }

    fn best(&self) -> f64 {
        self.kept.iter().map(|kept| kept.near).fold(0.0, f64::max)
    }

    /// Scores candidates, and refines the best.
    fn follow(&mut self, candidates: Vec<Motion>, freedom: Freedom) {
        let few = self.scored.fewer(SCORED / 4);
        let mut scored: Vec<(f64, Motion)> = candidates
            .into_iter()
            .map(|motion| (self.original.nears(&few, &motion, [COARSE])[0], motion))
            .collect();
        scored.sort_by(|a, b| b.0.total_cmp(&a.0));
        scored.truncate(8 * FOLLOWED);
        for (score, motion) in &mut scored {
            [*score] = self.original.nears(&self.scored, motion, [COARSE]);
        }
        scored.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut followed: Vec<Motion> = Vec::new();
        for (_, motion) in scored {
            let is_new = followed
                .iter()
                .all(|other| self.differs(other, &motion, 0.02));
            if is_new && followed.len() < FOLLOWED {
                followed.push(motion);
            }
        }
        let d = self.original.diagonal;
        for candidate in followed {
            let motion = refined(
                &self.refined,
                &self.original.surface,
                candidate,
                freedom,
                15,
                [0.1 * d, 0.01 * d],
                0.003 * d,
            );
            if !self.differs(&candidate, &motion, FARTHEST[0]) && self.is_possible(&motion) {
                self.kept.push(self.original.scored(&self.scored, motion));
            }
        }
    }

    /// Whether a motion leaves of the suspect what can be told from a point or a sheet: these lie on anything.
    fn is_possible(&self, motion: &Motion) -> bool {
        let Some((stretch, _)) = motion.stretch_and_turn() else {
            return false;
        };
        let areas = motion.linear.inverse().transpose() * motion.linear.determinant();
        let normals = self.scored.normals.iter();
        let mean = normals.clone().map(|n| (areas * *n).length()).sum::<f64>();
        let area = self.area * mean / normals.len().max(1) as f64;
        stretch[0] <= MOST_STRETCHED * stretch[2] && area >= LEAST_AREA * self.original.area
    }

    /// Whether two motions take the suspect to different places.
    fn differs(&self, a: &Motion, b: &Motion, share: f64) -> bool {
        let points = &self.scored.positions;
        let square = |p: &DVec3| a.of(*p).distance_squared(b.of(*p));
        let mean = points.iter().map(square).sum::<f64>() / points.len().max(1) as f64;
        mean.sqrt() > share * self.original.diagonal
    }

    /// The best that differ, brought as near as can be.
    fn conclude(self) -> Vec<Registration> {
        let mut all = self.kept.clone();
        all.sort_by(|a, b| b.score().total_cmp(&a.score()));
        let best = self.best();
        let mut kept: Vec<Registration> = Vec::new();
        for candidate in all {
            let is_new =
                |other: &Registration| self.differs(&other.motion, &candidate.motion, 0.005);
            if candidate.near > best - NEARLY && kept.len() < KEPT && kept.iter().all(is_new) {
                kept.push(candidate);
            }
        }
        let finish = |kept: Registration| match self.finished(&kept, &self.refined, [4, 8]) {
            hopeless if hopeless.near < HOPELESS => hopeless,
            nearly => self.finished(&nearly, self.all, [0, LAST_ROUNDS]),
        };
        let mut finished: Vec<Registration> = kept.into_iter().map(finish).collect();
        finished.sort_by(|a, b| b.score().total_cmp(&a.score()));
        finished
    }

    /// The last steps, on so many points: in so many rounds as a similarity, and then as an affine map.
    fn finished(
        &self,
        kept: &Registration,
        points: &Points,
        [similar, affine]: [usize; 2],
    ) -> Registration {
        let (d, surface) = (self.original.diagonal, &self.original.surface);
        let mut motion = kept.motion;
        for (freedom, rounds) in [(Freedom::Similarity, similar), (Freedom::Affine, affine)] {
            let reach = [0.012 * d, 0.006 * d];
            let moved = refined(points, surface, motion, freedom, rounds, reach, 0.001 * d);
            // What lies there in part may shrink or be flattened until it lies there well.
            if !self.differs(&kept.motion, &moved, FARTHEST[1]) && self.is_possible(&moved) {
                motion = moved;
            }
        }
        self.original.scored(points, motion)
    }
}
