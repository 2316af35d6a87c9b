//! What SOLID measures of a suspect without a key, and how a key reads it.

use super::flux::{Cluster, Placement, Window, clusters, windows};
use super::refine::refine;
use super::{Lattice, PITCH, STEPS, oriented, pose_of};
use crate::carrier::{Hypothesis, Reading};
use crate::code::{SoftSymbol, Symbol};
use crate::geometry::spectral::{self, InverseFilter};
use crate::key::Key;
use crate::mesh::{Edges, Mesh};
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// Axes whose spreads are nearer than this ratio may have changed places.
const NEAR: f64 = 0.85;

/// Where pilots agree less than this, in nats, there is nothing to decode.
const WORTH_DECODING: f64 = 3.0;

/// Pilots that agree better than this end the search: what follows would only undo attacks that did not happen.
const ENOUGH: f64 = 25.0;

/// A filtered surface that is so many times larger has spikes, and is left out.
const SPIKY: f64 = 1.6;

/// What may have been done to the surface, likeliest first: nothing; then smoothing, to be undone. Steps grow by about a
/// quarter, since a filter for 12 steps serves for 10 and for 15.
fn filters() -> Vec<InverseFilter> {
    let laplacian = [
        (4.0, 30.0),
        (6.0, 30.0),
        (9.0, 100.0),
        (13.0, 100.0),
        (19.0, 100.0),
        (28.0, 300.0),
        (28.0, 30.0),
    ];
    let laplacian =
        laplacian
            .into_iter()
            .chain([(40.0, 1000.0), (40.0, 30.0), (57.0, 1000.0), (57.0, 100.0)]);
    let taubin = [(9.0, 100.0), (13.0, 100.0), (19.0, 100.0), (27.0, 100.0)];
    let laplacian = laplacian.map(|(steps, gain)| InverseFilter {
        steps,
        step: spectral::laplacian,
        gain,
    });
    laplacian
        .chain(taubin.map(|(steps, gain)| InverseFilter {
            steps,
            step: spectral::taubin,
            gain,
        }))
        .collect()
}

/// Key-free measurement of a mesh: its surface in small pieces, in its own frame, as it is and as it may have been.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    surfaces: Vec<Surface>,
}

/// One surface in its own frame.
#[derive(Clone, Debug, PartialEq)]
struct Surface {
    /// Whether the frame's axes may have changed places, so that 24 turns are to be tried and not 4.
    ambiguous: bool,
    clusters: Vec<Cluster>,
}

impl Measurement {
    /// Measures a mesh.
    pub fn new(mesh: &Mesh) -> Measurement {
        let mesh = oriented(mesh);
        let rings = Edges::new(&mesh).rings(mesh.positions.len());
        let filtered = spectral::filtered(&mesh.positions, &rings, &filters());
        let largest = SPIKY * area(&mesh);
        let candidates = filtered
            .into_iter()
            .map(|positions| mesh.with_positions(positions));
        let candidates = candidates.filter(|candidate| area(candidate) <= largest);
        let surfaces = Surface::of(&mesh)
            .into_iter()
            .chain(candidates.filter_map(|candidate| Surface::of(&candidate)));
        Measurement {
            surfaces: surfaces.collect(),
        }
    }

    /// The soft symbols of a key: in the frame of each surface as it was found, all symbols, for each turn of the frame and
    /// each step; and once, at the placement where the pilots agree best, the symbols that are no pilots.
    pub fn read(&self, key: &Key) -> Reading {
        let lattice = Lattice::of(key);
        let mut hypotheses = Vec::new();
        let mut best: Option<(f64, &Surface, Placement, f64)> = None;
        let mut num_addresses = 0;
        for surface in &self.surfaces {
            for turn in turns(surface.ambiguous) {
                let placement = lattice.placed(turn);
                let windows = windows(&surface.clusters, &placement);
                num_addresses = num_addresses.max(windows.len());
                let held: Vec<(f64, Symbol)> = windows
                    .iter()
                    .map(|window| lattice.at(window.index))
                    .collect();
                for step in STEPS {
                    let step_size = step * PITCH * PITCH;
                    let symbols = soft(&windows, &held, step_size);
                    let evidence = pilot_evidence(&symbols);
                    if best.is_none_or(|(most, ..)| evidence > most) {
                        best = Some((evidence, surface, placement, step_size));
                    }
                    if evidence >= WORTH_DECODING || hypotheses.is_empty() {
                        hypotheses.push(Hypothesis { symbols });
                    }
                }
            }
            if best.is_some_and(|(evidence, ..)| evidence >= ENOUGH) {
                break;
            }
        }
        if let Some((_, surface, placement, step_size)) = best {
            let found = refine(&surface.clusters, &placement, &lattice, step_size);
            let windows = windows(&surface.clusters, &found);
            let held: Vec<(f64, Symbol)> = windows
                .iter()
                .map(|window| lattice.at(window.index))
                .collect();
            let mut symbols = soft(&windows, &held, step_size);
            symbols.retain(|soft| soft.symbol != Symbol::Pilot);
            hypotheses.push(Hypothesis { symbols });
        }
        let num_turns: usize = self
            .surfaces
            .iter()
            .map(|surface| turns(surface.ambiguous).len())
            .sum();
        Reading {
            num_declared: num_turns * STEPS.len() + 1,
            hypotheses,
            num_addresses,
        }
    }

    /// The measurement as bytes: for each surface 1, the number of its clusters in 4, and 32 for each of them.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.surfaces.iter().flat_map(Surface::to_bytes).collect()
    }

    /// A measurement from its bytes; `None` if they are not such.
    pub fn from_bytes(mut bytes: &[u8]) -> Option<Measurement> {
        let mut surfaces = Vec::new();
        while !bytes.is_empty() {
            let (surface, rest) = Surface::from_bytes(bytes)?;
            surfaces.push(surface);
            bytes = rest;
        }
        Some(Measurement { surfaces })
    }
}

impl Surface {
    /// Bytes in a stored cluster.
    const CLUSTER_BYTES: usize = 32;

    /// The surface of an oriented mesh; `None` without area.
    fn of(mesh: &Mesh) -> Option<Surface> {
        let pose = pose_of(mesh)?;
        let ambiguous =
            pose.spreads.y > NEAR * pose.spreads.x || pose.spreads.z > NEAR * pose.spreads.y;
        let clusters = clusters(mesh, &pose)
            .into_iter()
            .map(|cluster| decode(encode(&cluster)))
            .collect();
        Some(Surface {
            ambiguous,
            clusters,
        })
    }

    fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = vec![u8::from(self.ambiguous)];
        bytes.extend((self.clusters.len() as u32).to_le_bytes());
        bytes.extend(
            self.clusters
                .iter()
                .flat_map(|cluster| encode(cluster).into_iter().flat_map(f32::to_le_bytes)),
        );
        bytes
    }

    /// The surface that bytes begin with, and what follows it.
    fn from_bytes(bytes: &[u8]) -> Option<(Surface, &[u8])> {
        let (&ambiguous, bytes) = bytes.split_first()?;
        let (count, bytes) = bytes.split_first_chunk()?;
        let length = (u32::from_le_bytes(*count) as usize).checked_mul(Self::CLUSTER_BYTES)?;
        let (clusters, rest) = bytes.split_at_checked(length)?;
        let (clusters, _) = clusters.as_chunks::<{ Self::CLUSTER_BYTES }>();
        let cluster = |bytes: &[u8; Self::CLUSTER_BYTES]| {
            let (numbers, _) = bytes.as_chunks::<4>();
            let mut values = [0.0; 8];
            values
                .iter_mut()
                .zip(numbers)
                .for_each(|(value, bytes)| *value = f32::from_le_bytes(*bytes));
            values
                .iter()
                .all(|value| value.is_finite())
                .then(|| decode(values))
        };
        let clusters: Option<Vec<Cluster>> = clusters.iter().map(cluster).collect();
        (ambiguous <= 1).then_some((
            Surface {
                ambiguous: ambiguous == 1,
                clusters: clusters?,
            },
            rest,
        ))
    }
}

fn area(mesh: &Mesh) -> f64 {
    let double = |&triangle: &[u32; 3]| {
        let [a, b, c] = mesh.corners(triangle);
        (b - a).cross(c - a).length()
    };
    mesh.triangles.iter().map(double).sum::<f64>() * 0.5
}

fn encode(cluster: &Cluster) -> [f32; 8] {
    let (c, a) = (cluster.centre.as_vec3(), cluster.area.as_vec3());
    [
        c.x,
        c.y,
        c.z,
        a.x,
        a.y,
        a.z,
        cluster.moment as f32,
        cluster.weight as f32,
    ]
}

fn decode(v: [f32; 8]) -> Cluster {
    let v = v.map(f64::from);
    Cluster {
        centre: DVec3::new(v[0], v[1], v[2]),
        area: DVec3::new(v[3], v[4], v[5]),
        moment: v[6],
        weight: v[7],
    }
}

/// How well the pilots agree, in nats: the exponent of their bound.
fn pilot_evidence(symbols: &[SoftSymbol]) -> f64 {
    let pilots = symbols.iter().filter(|soft| soft.symbol == Symbol::Pilot);
    let (sum, energy) = pilots.fold((0.0f64, 0.0f64), |(sum, energy), soft| {
        (sum + soft.value, energy + soft.weight * soft.weight)
    });
    if energy > 0.0 {
        sum.max(0.0) * sum.max(0.0) / energy
    } else {
        0.0
    }
}

/// The symbols of the windows, whose dithers and symbols are `held`, as a quantizer of a step sees them.
fn soft(windows: &[Window], held: &[(f64, Symbol)], step_size: f64) -> Vec<SoftSymbol> {
    let read = |(window, &(dither, symbol)): (&Window, &(f64, Symbol))| {
        let value = window.weight * libm::cos(TAU * (window.flux / step_size + dither));
        SoftSymbol {
            symbol,
            value,
            weight: window.weight,
        }
    };
    windows.iter().zip(held).map(read).collect()
}

/// The rotations that take a frame into itself: 4 if its axes are known but for their signs, else 24.
fn turns(ambiguous: bool) -> Vec<DMat3> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut turns = Vec::new();
    for (first, second) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
        for (a, b) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let (x, y) = (axes[first] * a, axes[second] * b);
            turns.push(DMat3::from_cols(x, y, x.cross(y)));
        }
        if !ambiguous {
            break;
        }
    }
    turns
}
