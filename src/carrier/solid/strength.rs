//! Surfaces that may have been smoothed, by any strength: between those that were measured, the flux is interpolated.

use super::window::Window;
use crate::geometry::spectral::{self, InverseFilter};
use std::ops::Range;

/// A kind of smoothing, undone at growing strengths.
pub struct Family {
    step: fn(f64) -> f64,
    gain: f64,
    /// Numbers of steps: the nodes between which fluxes are interpolated.
    strengths: &'static [f64],
}

/// Nodes of a family by which the flux of a mesh with many triangles is measured once: it changes little from node to node.
const SPARSENESS: usize = 3;

/// Each about 1.145 times the one before.
const LAPLACIAN: &[f64] = &[
    2.6, 3.0, 3.4, 3.9, 4.5, 5.1, 5.8, 6.7, 7.6, 8.8, 10.1, 11.5, 13.1, 14.9, 17.0, 19.6, 22.6,
    26.0, 29.8, 34.1, 39.0, 44.5, 50.8, 58.0,
];

/// The kinds of smoothing that are tried, likeliest first. A filter with a small gain suits what was rounded or disturbed
/// after it was smoothed.
pub const FAMILIES: [Family; 5] = [
    Family {
        step: spectral::laplacian,
        gain: 100.0,
        strengths: LAPLACIAN,
    },
    Family {
        step: spectral::taubin,
        gain: 100.0,
        strengths: &[
            3.9, 4.5, 5.1, 5.8, 6.7, 7.6, 8.8, 10.1, 11.5, 13.1, 14.9, 17.0, 19.6, 22.6, 26.0,
        ],
    },
    Family {
        step: spectral::laplacian,
        gain: 2000.0,
        strengths: &[19.6, 22.6, 26.0, 29.8, 34.1, 39.0, 44.5, 50.8, 58.0],
    },
    Family {
        step: spectral::laplacian,
        gain: 20.0,
        strengths: &[4.5, 5.8, 7.6, 10.1, 13.1, 17.0, 22.6, 29.8, 39.0],
    },
    Family {
        step: spectral::laplacian,
        gain: 1000.0,
        strengths: LAPLACIAN,
    },
];

/// The kinds in the order in which they are measured.
pub const FIRST_FAMILY: Range<usize> = 0..1;
pub const OTHER_FAMILIES: Range<usize> = 1..4;
/// The kind that held boundaries.
pub const HELD_FAMILY: Range<usize> = 4..5;

impl Family {
    /// The inverse filter of a node.
    pub fn filter(&self, node: usize) -> InverseFilter {
        InverseFilter {
            steps: self.strengths[node],
            step: self.step,
            gain: self.gain,
        }
    }

    /// The nodes to measure: all of them, or as many as are needed where there are many triangles.
    pub fn nodes(&self, all: bool) -> impl Iterator<Item = usize> {
        (0..self.len()).filter(move |node| all || node % SPARSENESS == SPARSENESS - 1)
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

/// Up to three nodes about a strength, with the weights by which a parabola through them is read there. Nodes ascend. Below the
/// first and above the last nothing was measured: there the parabola would lead to fluxes that no surface has, so these are read.
pub fn weights(nodes: &[f64], strength: f64) -> Vec<(usize, f64)> {
    let [first, .., last] = nodes else {
        return nodes.iter().map(|_| (0, 1.0)).collect();
    };
    let strength = strength.max(*first).min(*last);
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
