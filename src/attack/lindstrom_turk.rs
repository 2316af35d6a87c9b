//! Simplification that preserves volume.

use super::collapse::{Collapse, Placement, Until};
use super::editing::Editable;
use crate::mesh::Mesh;
use glam::{DMat3, DVec3};

/// Two constraints whose planes are nearer to parallel than 1 degree say the same: the square of its sine.
const SAME: f64 = 3.046e-4;
/// Of a gradient, the part that is rounding.
const NOTHING: f64 = 1e-8;
/// What the sixth power of its length counts in an edge's cost: in planes, where all others are 0, short edges go first.
const LENGTH_WEIGHT: f64 = 1e-9;
/// What volume and borders count in the cost, as in the paper.
const WEIGHT: f64 = 0.5;

/// Simplifies until the `fraction` (0 to 1) of the edges is gone, as Lindstrom and Turk (1998), the method of the LIRIS benchmark
/// (Wang et al. 2010, with 10 to 97.5 %): each new vertex leaves the volume and the area within flat borders as they were; then it
/// takes the least change of volume of each face, and of area at each border's edge; and, where that leaves it a choice, the most
/// even triangles. Nothing is remembered of the original. Collapses that would turn a face over, or change the topology, are left
/// out. O(F log F).
pub fn simplify_volume(mesh: &Mesh, fraction: f64) -> Mesh {
    let mut collapse = Collapse::new(mesh, |_| Memoryless);
    collapse.run(Until::WithoutEdges(fraction));
    collapse.mesh()
}

struct Memoryless;

impl Placement for Memoryless {
    fn place(&self, editable: &Editable, a: u32, b: u32) -> Option<(DVec3, f64)> {
        // About the edge, so that nothing is lost far from the scene's origin.
        let origin = editable.at(a).midpoint(editable.at(b));
        let star = Star::new(editable, a, b, origin);
        let square = editable.at(a).distance_squared(editable.at(b));
        let to = star.placement(square)?;
        Some((origin + to, star.cost(to, square)))
    }

    fn merge(&mut self, _: u32, _: u32) {}
}

/// What an edge's collapse changes.
struct Star {
    /// Twice each face's area vector, and six times the volume that the face spans with the origin.
    faces: Vec<(DVec3, f64)>,
    /// Each border edge's vector, and twice the area that it spans with the origin.
    borders: Vec<(DVec3, DVec3)>,
    /// The other vertices: how many, and the sum of their positions.
    link: (f64, DVec3),
}

impl Star {
    fn new(editable: &Editable, a: u32, b: u32, origin: DVec3) -> Star {
        let at = |v: u32| editable.at(v) - origin;
        let others = editable.faces_at(b).filter(|face| !face.contains(&a));
        let star: Vec<[u32; 3]> = editable.faces_at(a).chain(others).collect();
        let faces = star.iter().map(|face| {
            let [p, q, r] = face.map(at);
            ((q - p).cross(r - p), p.dot(q.cross(r)))
        });
        // Every face of an edge at either vertex is in the star.
        let mut sides: Vec<(u32, u32, bool)> = star
            .iter()
            .flat_map(|&[p, q, r]| [(p, q), (q, r), (r, p)])
            .filter(|(p, q)| [*p, *q].iter().any(|v| *v == a || *v == b))
            .map(|(p, q)| (p.min(q), p.max(q), p < q))
            .collect();
        sides.sort_unstable();
        let alone = sides.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1));
        let borders = alone.filter(|sides| sides.len() == 1).map(|sides| {
            let (low, high, ascending) = sides[0];
            let (from, to) = if ascending { (low, high) } else { (high, low) };
            (at(to) - at(from), at(to).cross(at(from)))
        });
        let mut link: Vec<u32> = star.iter().flatten().copied().collect();
        link.sort_unstable();
        link.dedup();
        link.retain(|&v| v != a && v != b);
        Star {
            faces: faces.collect(),
            borders: borders.collect(),
            link: (link.len() as f64, link.iter().map(|&v| at(v)).sum()),
        }
    }

    /// Where all that is asked for meets, in the order of the paper; `None` where it does not.
    fn placement(&self, square: f64) -> Option<DVec3> {
        let mut constraints = Constraints::default();
        let whole = self
            .borders
            .iter()
            .fold((DVec3::ZERO, DVec3::ZERO), |sum, border| {
                (sum.0 + border.0, sum.1 + border.1)
            });
        let normal = self.faces.iter().map(|face| face.0).sum();
        constraints.add(normal, self.faces.iter().map(|face| face.1).sum());
        constraints.minimise(border_gradient(whole));

        let outer = |n: DVec3| DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        let mut gradient = (DMat3::ZERO, DVec3::ZERO);
        for &(normal, volume) in &self.faces {
            gradient.0 += outer(normal) * (WEIGHT / 18.0);
            gradient.1 -= normal * (volume * WEIGHT / 18.0);
        }
        for &border in &self.borders {
            let (matrix, vector) = border_gradient(border);
            gradient.0 += matrix * (WEIGHT / 2.0 * square);
            gradient.1 += vector * (WEIGHT / 2.0 * square);
        }
        constraints.minimise(gradient);

        let (count, sum) = self.link;
        constraints.minimise((DMat3::from_diagonal(DVec3::splat(count)), -sum));
        constraints.solution()
    }

    /// The changes of volume and of area at borders, squared, in units of length to the sixth.
    fn cost(&self, to: DVec3, square: f64) -> f64 {
        let volumes = self.faces.iter().map(|&(normal, volume)| {
            let change = (normal.dot(to) - volume) / 6.0;
            change * change
        });
        let areas = self
            .borders
            .iter()
            .map(|&(along, area)| (to.cross(along) + area).length_squared() / 4.0);
        let change = volumes.sum::<f64>() + square * areas.sum::<f64>();
        WEIGHT * change + LENGTH_WEIGHT * square * square * square
    }
}

/// Half the gradient of |v x along + area|^2 in v: a matrix times v, and a vector.
fn border_gradient((along, area): (DVec3, DVec3)) -> (DMat3, DVec3) {
    let outer = DMat3::from_cols(along * along.x, along * along.y, along * along.z);
    let matrix = DMat3::from_diagonal(DVec3::splat(along.length_squared())) - outer;
    (matrix, along.cross(area))
}

/// Up to three planes: normal and, times the normal's length, offset. Later ones give way to earlier ones.
#[derive(Default)]
struct Constraints {
    planes: Vec<(DVec3, f64)>,
}

impl Constraints {
    /// Adds a plane unless the point is determined without, or nearly parallel to what determines it.
    fn add(&mut self, normal: DVec3, offset: f64) {
        let square = normal.length_squared();
        let is_new = match self.planes[..] {
            _ if square == 0.0 => false,
            [] => true,
            [(first, _)] => {
                normal.cross(first).length_squared() > SAME * square * first.length_squared()
            }
            [(first, _), (second, _)] => {
                let line = first.cross(second);
                let along = normal.dot(line);
                along * along > SAME * square * line.length_squared()
            }
            _ => false,
        };
        if is_new {
            self.planes.push((normal, offset));
        }
    }

    /// Adds what makes a quadratic form least within the planes that there are; its gradient is a symmetric matrix times the
    /// point, plus a vector.
    fn minimise(&mut self, (matrix, vector): (DMat3, DVec3)) {
        let directions: Vec<DVec3> = match self.planes[..] {
            [] => vec![DVec3::X, DVec3::Y, DVec3::Z],
            [(first, _)] => {
                let (u, v) = first.normalize().any_orthonormal_pair();
                vec![u, v]
            }
            [(first, _), (second, _)] => vec![first.cross(second).normalize()],
            _ => vec![],
        };
        let trace = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
        for direction in directions {
            let normal = matrix * direction;
            // What is less is rounding: nothing depends on the direction.
            if normal.length() > NOTHING * trace {
                self.add(normal, -vector.dot(direction));
            }
        }
    }

    fn solution(&self) -> Option<DVec3> {
        let [a, b, c] = self.planes[..] else {
            return None;
        };
        let system = DMat3::from_cols(a.0, b.0, c.0).transpose();
        let point = system.inverse() * DVec3::new(a.1, b.1, c.1);
        point.is_finite().then_some(point)
    }
}
