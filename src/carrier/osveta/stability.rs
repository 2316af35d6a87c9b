//! The paper's two vectors: stabilities in decreasing order, and the vertices that they belong to.

use crate::geometry::collapse_costs;
use crate::mesh::{Edges, Mesh, Rings};
use crate::order::order_by;

/// A vertex is an error of topology where its nearest neighbour is farther away than so many mean edges of the mesh. The paper
/// names the criterion and no number.
const TOO_FAR: f64 = 8.0;

/// What stability is judged by.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum Ranking {
    /// The cost of the cheapest collapse alone (Garland and Heckbert 1997): the best predictor of who is found again.
    Collapse,
}

impl Ranking {
    /// Every ranking.
    pub const ALL: [Ranking; 1] = [Ranking::Collapse];

    /// The name that scripts and pages use.
    pub fn name(self) -> &'static str {
        match self {
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

/// Ranks the vertices of a mesh. O(V log V).
pub fn rank(mesh: &Mesh, ranking: Ranking) -> Stability {
    let rings = Edges::new(mesh).rings(mesh.positions.len());
    let criteria = match ranking {
        Ranking::Collapse => [(1.0, collapse_costs(mesh, &rings))],
    };
    let total: f64 = criteria.iter().map(|(weight, _)| weight).sum();
    let mut scores = vec![0.0; mesh.positions.len()];
    for (weight, values) in &criteria {
        let shares = ranks(values).into_iter().map(|rank| rank * weight / total);
        scores
            .iter_mut()
            .zip(shares)
            .for_each(|(score, share)| *score += share);
    }
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
    // Scores are at least -1, so the bits of what they lack are in their order.
    let order: Vec<u32> = order_by(kept.iter().map(|&v| (1.0 - score(v)).to_bits()))
        .into_iter()
        .map(|(_, place)| kept[place as usize])
        .collect();
    Stability {
        stability: order.iter().map(|&v| score(v)).collect(),
        order,
    }
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
    let lengths = mesh.triangles.iter().flat_map(|&triangle| {
        let [a, b, c] = mesh.corners(triangle);
        [a.distance(b), b.distance(c), c.distance(a)]
    });
    let mean = lengths.sum::<f64>() / (3 * mesh.triangles.len()).max(1) as f64;
    (0..mesh.positions.len())
        .map(|v| nearest(v) <= TOO_FAR * mean)
        .collect()
}
