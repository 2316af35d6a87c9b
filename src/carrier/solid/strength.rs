//! Surfaces that may have been smoothed, by any strength: between those that were measured, the flux is interpolated.

use super::flux::Window;
use crate::geometry::spectral::{self, InverseFilter};

/// A kind of smoothing, undone at growing strengths.
pub struct Family {
    step: fn(f64) -> f64,
    gain: f64,
    /// Numbers of steps: the nodes between which fluxes are interpolated.
    strengths: &'static [f64],
}

/// The kinds of smoothing that are tried, likeliest first. A filter with a small gain suits what was rounded or disturbed
/// after it was smoothed.
pub const FAMILIES: [Family; 4] = [
    Family {
        step: spectral::laplacian,
        gain: 100.0,
        strengths: &[3.4, 5.1, 7.6, 11.5, 17.0, 26.0, 39.0, 58.0],
    },
    Family {
        step: spectral::taubin,
        gain: 100.0,
        strengths: &[5.1, 7.6, 11.5, 17.0, 26.0],
    },
    Family {
        step: spectral::laplacian,
        gain: 2000.0,
        strengths: &[26.0, 39.0, 58.0],
    },
    Family {
        step: spectral::laplacian,
        gain: 20.0,
        strengths: &[7.6, 17.0, 39.0],
    },
];

impl Family {
    /// The inverse filter of a node.
    pub fn filter(&self, node: usize) -> InverseFilter {
        InverseFilter {
            steps: self.strengths[node],
            step: self.step,
            gain: self.gain,
        }
    }

    /// The number of nodes.
    pub const fn len(&self) -> usize {
        self.strengths.len()
    }

    /// The strength of a node.
    pub fn strength(&self, node: usize) -> f64 {
        self.strengths[node]
    }
}

/// Up to three nodes about a strength, with the weights by which a parabola through them is read there. Nodes ascend.
pub fn weights(nodes: &[f64], strength: f64) -> Vec<(usize, f64)> {
    let upper = nodes.partition_point(|node| *node < strength);
    let end = (upper + 1).max(3).min(nodes.len());
    let near = end.saturating_sub(3)..end;
    let weight = |node: usize| {
        let others = near.clone().filter(|other| *other != node);
        let product = others.map(|other| (strength - nodes[other]) / (nodes[node] - nodes[other]));
        (node, product.product())
    };
    near.clone()
        .map(weight)
        .filter(|(_, weight)| *weight != 0.0)
        .collect()
}

/// The windows that all lists have, fluxes and weights added up with the lists' factors.
pub fn blend<'a>(mut lists: impl Iterator<Item = (&'a [Window], f64)>) -> Vec<Window> {
    let Some((first, factor)) = lists.next() else {
        return Vec::new();
    };
    let mut blend = first.to_vec();
    for window in &mut blend {
        window.flux *= factor;
        window.weight *= factor;
    }
    for (list, factor) in lists {
        let mut rest = list.iter().peekable();
        blend.retain_mut(|window| {
            while rest.next_if(|other| other.index < window.index).is_some() {}
            rest.next_if(|other| other.index == window.index)
                .is_some_and(|other| {
                    window.flux += other.flux * factor;
                    window.weight += other.weight * factor;
                    true
                })
        });
    }
    blend
}
