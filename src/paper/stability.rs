//! Section III.A, host vertex selection: the paper's two vectors, stabilities in decreasing order and the vertices that they belong to.

use crate::geometry::{
    collapse_costs, curvature_integrals, dihedrals, face_areas, fitted_curvature,
    normal_deviations, outward, vertex_normals,
};
use crate::mesh::{Edges, Mesh, Rings};
use crate::order::order_by;
use crate::random::Random;
use glam::DVec3;

/// A vertex is an error of topology where its nearest neighbour is farther away than so many mean edges of the mesh. The paper
/// names the criterion and no number.
const TOO_FAR: f64 = 8.0;

/// What stability is judged by. The paper names criteria and no weights: all three are interpretations of it. A vertex's score is
/// the weighted mean of its ranks by each criterion's magnitude, so no criterion's units matter.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum Ranking {
    /// All that the paper names, at its word: Gaussian and mean curvature by differential geometry and by quadrics, the largest
    /// and the mean dihedral angle, the largest deviation of normals, and, twice, the cost of the cheapest collapse.
    Literal,
    /// The same with curvature integrated over the vertex's cell instead of at a point, so that it does not grow where a mesh is
    /// refined: K A, H sqrt(A); without the mean dihedral angle.
    Integrated,
    /// The cost of the cheapest collapse alone (Garland and Heckbert 1997): the best predictor of who is found again.
    Collapse,
}

impl Ranking {
    /// Every ranking.
    pub const ALL: [Ranking; 3] = [Ranking::Literal, Ranking::Integrated, Ranking::Collapse];

    /// The name that scripts and pages use.
    pub fn name(self) -> &'static str {
        match self {
            Ranking::Literal => "literal",
            Ranking::Integrated => "integrated",
            Ranking::Collapse => "collapse",
        }
    }

    /// The ranking of a name.
    pub fn from_name(name: &str) -> Option<Ranking> {
        Self::ALL.into_iter().find(|ranking| ranking.name() == name)
    }
}

/// Vertices and their stabilities, the most stable first; of equals the one of the lower index.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stability {
    /// Vertices. Those that have no neighbour, or none that is near, are not among them.
    pub order: Vec<u32>,
    /// Their stabilities: 0 to 1 inside, and -1 to 0, so last, where an edge at the vertex has another number of faces than two.
    pub stability: Vec<f64>,
}

impl Stability {
    /// Those in concave regions and those elsewhere, each in the same order: a region is concave at a vertex where furrows turn
    /// the surface by more than ridges. The companion of the paper embeds in rough concave regions. The mesh has to be wound
    /// outwards.
    pub fn split(&self, mesh: &Mesh) -> [Stability; 2] {
        let mut turns = vec![0.0; mesh.positions.len()];
        for dihedral in dihedrals(mesh, &Edges::new(mesh), &face_areas(mesh)) {
            dihedral
                .ends
                .iter()
                .for_each(|&v| turns[v as usize] += dihedral.angle);
        }
        [true, false].map(|concave| {
            let pairs = self.order.iter().zip(&self.stability);
            let (order, stability) = pairs
                .filter(|&(&v, _)| (turns[v as usize] < 0.0) == concave)
                .unzip();
            Stability { order, stability }
        })
    }
}

/// Ranks the vertices of a mesh. O(V log V).
pub fn rank(mesh: &Mesh, ranking: Ranking) -> Stability {
    let edges = Edges::new(mesh);
    let rings = edges.rings(mesh.positions.len());
    let costs = collapse_costs(mesh, &rings);
    let mut score = Score::default();
    if ranking == Ranking::Collapse {
        score.add(1.0, &costs);
    } else {
        score.add(2.0, &costs);
        if edges.pairs().all(|pair| pair.agree) {
            score.add_shape(mesh, &edges, &rings, ranking);
        } else {
            let turned = Mesh {
                triangles: outward(mesh),
                ..mesh.clone()
            };
            score.add_shape(&turned, &Edges::new(&turned), &rings, ranking);
        }
    }
    let scores = score.mean();
    let near = near(mesh, &rings);
    let score = |v: u32| {
        let score = scores[v as usize];
        if rings.is_closed(v as usize) {
            score
        } else {
            score - 1.0
        }
    };
    let kept: Vec<u32> = (0..mesh.positions.len() as u32)
        .filter(|&v| near[v as usize])
        .collect();
    let order: Vec<u32> = order_by(kept.iter().map(|&v| decreasing(score(v))))
        .into_iter()
        .map(|(_, place)| kept[place as usize])
        .collect();
    Stability {
        stability: order.iter().map(|&v| score(v)).collect(),
        order,
    }
}

/// The vertices in decreasing order of stability, equals at random: by index the original vertices, which come first in every
/// smoothed mesh, would win every tie.
pub fn ranked(mesh: &Mesh, ranking: Ranking, seed: u64) -> Vec<u32> {
    let names = Random::new(seed).permutation(mesh.positions.len());
    let mut renamed = Mesh {
        positions: mesh.positions.clone(),
        triangles: mesh
            .triangles
            .iter()
            .map(|triangle| triangle.map(|vertex| names[vertex as usize]))
            .collect(),
    };
    let mut vertices = vec![0; names.len()];
    for (vertex, (&name, &position)) in (0..).zip(names.iter().zip(&mesh.positions)) {
        renamed.positions[name as usize] = position;
        vertices[name as usize] = vertex;
    }
    let order = rank(&renamed, ranking).order;
    order
        .into_iter()
        .map(|name| vertices[name as usize])
        .collect()
}

/// The weighted mean of ranks.
#[derive(Default)]
struct Score {
    weight: f64,
    sum: Vec<f64>,
}

impl Score {
    fn add(&mut self, weight: f64, criterion: &[f64]) {
        self.weight += weight;
        self.sum.resize(criterion.len(), 0.0);
        let ranks = ranks(criterion);
        self.sum
            .iter_mut()
            .zip(ranks)
            .for_each(|(sum, rank)| *sum += weight * rank);
    }

    fn mean(self) -> Vec<f64> {
        self.sum.iter().map(|sum| sum / self.weight).collect()
    }

    /// What depends on which side is out.
    fn add_shape(&mut self, mesh: &Mesh, edges: &Edges, rings: &Rings, ranking: Ranking) {
        let (areas, normals) = (face_areas(mesh), vertex_normals(mesh));
        let discrete = curvature_integrals(mesh, rings, &normals);
        let fitted = fitted_curvature(mesh, rings, &normals);
        if ranking == Ranking::Literal {
            let pointwise = discrete.curvature();
            for criterion in [
                &pointwise.gaussian,
                &pointwise.mean,
                &fitted.gaussian,
                &fitted.mean,
            ] {
                self.add(1.0, criterion);
            }
        } else {
            let with_area = |values: &[f64], of: fn(f64, f64) -> f64| -> Vec<f64> {
                let pairs = values.iter().zip(&discrete.area);
                pairs.map(|(&value, &area)| of(value, area)).collect()
            };
            let over_root = |integral: f64, area: f64| {
                if area > 0.0 {
                    integral / area.sqrt()
                } else {
                    0.0
                }
            };
            self.add(1.0, &discrete.gaussian);
            self.add(1.0, &with_area(&discrete.mean, over_root));
            self.add(
                1.0,
                &with_area(&fitted.gaussian, |value, area| value * area),
            );
            self.add(
                1.0,
                &with_area(&fitted.mean, |value, area| value * area.sqrt()),
            );
        }
        let [largest, mean] = dihedral_angles(mesh, edges, &areas);
        self.add(1.0, &largest);
        if ranking == Ranking::Literal {
            self.add(1.0, &mean);
        }
        self.add(1.0, &normal_deviations(mesh, &areas, &normals));
    }
}

/// The largest and the mean dihedral angle at each vertex, without signs.
fn dihedral_angles(mesh: &Mesh, edges: &Edges, areas: &[DVec3]) -> [Vec<f64>; 2] {
    let mut largest = vec![0.0f64; mesh.positions.len()];
    let mut mean = vec![(0.0, 0.0); mesh.positions.len()];
    for dihedral in dihedrals(mesh, edges, areas) {
        let angle = dihedral.angle.abs();
        for vertex in dihedral.ends.map(|end| end as usize) {
            largest[vertex] = largest[vertex].max(angle);
            mean[vertex] = (mean[vertex].0 + angle, mean[vertex].1 + 1.0);
        }
    }
    let mean = mean
        .into_iter()
        .map(|(sum, count)| if count > 0.0 { sum / count } else { 0.0 });
    [largest, mean.collect()]
}

/// Places of values in increasing order, 0 to 1; equal values share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    // Magnitudes, whose bits are in their order.
    let order = order_by(values.iter().map(|value| value.abs().to_bits()));
    let last = values.len().saturating_sub(1).max(1) as f64;
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for equal in order.chunk_by(|a, b| a.0 == b.0) {
        let middle = first as f64 + (equal.len() - 1) as f64 / 2.0;
        equal
            .iter()
            .for_each(|&(_, v)| ranks[v as usize] = middle / last);
        first += equal.len();
    }
    ranks
}

/// A key that falls as the value rises.
fn decreasing(value: f64) -> u64 {
    let bits = value.to_bits();
    if value.is_sign_negative() {
        bits
    } else {
        !bits & u64::MAX >> 1
    }
}

/// Whether each vertex has a neighbour that is not too far.
fn near(mesh: &Mesh, rings: &Rings) -> Vec<bool> {
    let nearest = |v: usize| {
        let position = mesh.positions[v];
        let neighbours = rings
            .neighbours(v)
            .iter()
            .map(|&n| mesh.positions[n as usize]);
        neighbours
            .map(|n| n.distance(position))
            .fold(f64::INFINITY, f64::min)
    };
    let limit = TOO_FAR * mesh.mean_edge();
    (0..mesh.positions.len())
        .map(|v| nearest(v) <= limit)
        .collect()
}
