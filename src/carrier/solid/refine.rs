//! Finding the lattice again when an attack has moved the frame or smoothed the surface by an unknown strength: by the
//! pilots alone, so that the other symbols, which never took part in the search, can testify without a charge for it.

use super::lattice::{Lattice, Placement};
use super::quantizer::{cosine, held, phase};
use super::window::Window;
use crate::code::Symbol;
use crate::order::order_by;
use crate::random::Random;
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// Degrees of freedom: translation, rotation, logarithms of the scale and of the strength; of a view that undoes a stretch, also the five
/// of a stretch that keeps the volume.
const FREEDOMS: usize = 13;
const WITHOUT_STRETCH: usize = 8;
const STRENGTH: usize = 7;
type Nudge = [f64; FREEDOMS];

/// A difference quotient's step.
const EPSILON: f64 = 0.006;
/// How much is tried about a view.
struct Effort {
    /// Nudges in the linear model, and those of them that are followed uphill.
    tried: usize,
    followed: usize,
    climbs: usize,
}

const WHOLE: Effort = Effort {
    tried: 3000,
    followed: 24,
    climbs: 15,
};
/// A sixth of that: enough to tell which of many views are worth the whole.
const QUICK: Effort = Effort {
    tried: 500,
    followed: 5,
    climbs: 8,
};
/// How far a climb goes along each freedom, at most: nine times as far as its widest nudges are tried, so that no attack that was
/// ever read again comes near. Where fluxes hardly change, the linear model would otherwise lead anywhere: to lattices of no
/// pitch, and of any number of points.
const FARTHEST: f64 = 0.1;
/// What is added to the curvature in every direction, as a share of its trace: turning a surface of revolution about its axis
/// changes hardly anything, which is no reason to turn it far.
const DAMPING: f64 = 1e-3;
/// A strength may be off by tens of percent where a scale is off by some.
const STRENGTHS_PER_SCALE: f64 = 12.0;

/// Where a lattice is looked for, and on what surface.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// What is done to the surface first, to undo a stretch.
    pub stretch: Option<DMat3>,
    pub placement: Placement,
    /// Of the smoothing that is undone; 0 for the suspect itself.
    pub strength: f64,
}

impl View {
    /// Of a suspect that nothing has smoothed.
    pub fn of_suspect(placement: Placement, stretch: Option<DMat3>) -> View {
        View {
            stretch,
            placement,
            strength: 0.0,
        }
    }

    fn nudged(&self, nudge: &Nudge) -> View {
        let [a, b, c, d, e, f, scale, strength, x, y, xy, yz, zx] = *nudge;
        let more = DMat3::from_cols(
            DVec3::new(1.0 + x, xy, zx),
            DVec3::new(xy, 1.0 + y, yz),
            DVec3::new(zx, yz, 1.0 - x - y),
        );
        View {
            stretch: self.stretch.map(|stretch| more * stretch),
            placement: self.placement.nudged(&[a, b, c, d, e, f, scale]),
            strength: self.strength * libm::exp(STRENGTHS_PER_SCALE * strength),
        }
    }

    /// Which nudges change what is seen.
    fn moves(&self, freedom: usize) -> bool {
        match freedom {
            STRENGTH => self.strength > 0.0,
            _ => freedom < self.num_freedoms(),
        }
    }

    fn num_freedoms(&self) -> usize {
        match self.stretch {
            Some(_) => FREEDOMS,
            None => WITHOUT_STRETCH,
        }
    }
}

/// A view near the given one at which the pilots agree best. `see` gives the windows of a view.
pub fn refine(
    see: &dyn Fn(&View) -> Vec<Window>,
    start: &View,
    lattice: &Lattice,
    step: f64,
) -> View {
    let wide = climb(see, start, lattice, step, &WHOLE, WIDE);
    climb(see, &wide, lattice, step, &WHOLE, (0.003, [0.25, 0.6, 1.2]))
}

/// The same with little effort, to tell whether a view is worth more.
pub fn approach(
    see: &dyn Fn(&View) -> Vec<Window>,
    start: &View,
    lattice: &Lattice,
    step: f64,
) -> View {
    climb(see, start, lattice, step, &QUICK, WIDE)
}

/// Sizes of nudges, in the units of a view, and their shares.
type Sizes = (f64, [f64; 3]);
const WIDE: Sizes = (0.007, [0.3, 0.8, 1.6]);

/// Pilots that a processor works on at once.
const LANES: usize = 4;
type Lanes = [f64; LANES];

/// Pilots in the linear model of a view's neighbourhood. Those that fill up the last weigh nothing.
#[derive(Clone, Copy, Default)]
struct Pilots {
    /// In steps, at the view.
    phases: Lanes,
    slopes: [Lanes; FREEDOMS],
    weights: Lanes,
}

/// All pilots, by which a nudge is judged.
struct Model(Vec<Pilots>);

fn climb(
    see: &dyn Fn(&View) -> Vec<Window>,
    start: &View,
    lattice: &Lattice,
    step: f64,
    effort: &Effort,
    (spread, spreads): Sizes,
) -> View {
    let model = Model::new(see, start, lattice, step / start.placement.pitch);
    let mut random = Random::new(0x50_4f_53_45);
    let nudges: Vec<(f64, Nudge)> = (0..effort.tried)
        .map(|number| {
            let size = if number == 0 {
                0.0
            } else {
                spread * spreads[number % 3]
            };
            let mut nudge = [0.0; FREEDOMS];
            let drawn = &mut nudge[..start.num_freedoms()];
            drawn.fill_with(|| size * random.normal());
            (model.agreement(&nudge), nudge)
        })
        .collect();
    // The best come first; where none is better, the start itself is followed.
    let order = order_by(nudges.iter().map(|(agreement, _)| descending(*agreement)));
    let curvature = model.curvature();
    let best = order
        .iter()
        .take(effort.followed)
        .map(|&(_, number)| nudges[number as usize].1)
        .chain([nudges[0].1])
        .map(|nudge| model.uphill(nudge, &curvature, effort.climbs))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(*start, |(_, nudge)| start.nudged(&nudge))
}

/// A key that orders numbers from the largest to the smallest.
fn descending(number: f64) -> u64 {
    let bits = number.to_bits();
    if bits >> 63 == 0 {
        !bits & !(1 << 63)
    } else {
        bits
    }
}

impl Pilots {
    /// Phases after a nudge.
    fn phases(&self, nudge: &Nudge) -> Lanes {
        let mut moved = [0.0; LANES];
        for (slopes, x) in self.slopes.iter().zip(nudge) {
            moved = std::array::from_fn(|lane| moved[lane] + slopes[lane] * x);
        }
        std::array::from_fn(|lane| self.phases[lane] + moved[lane])
    }
}

impl Model {
    fn new(
        see: &dyn Fn(&View) -> Vec<Window>,
        start: &View,
        lattice: &Lattice,
        step: f64,
    ) -> Model {
        let pilots: Vec<_> = see(start)
            .into_iter()
            .filter_map(|window| {
                let (dither, symbol) = lattice.at(window.index);
                (symbol == Symbol::Pilot).then_some((window, dither))
            })
            .collect();
        let mut model = vec![Pilots::default(); pilots.len().div_ceil(LANES)];
        for (number, (window, dither)) in pilots.iter().enumerate() {
            let some = &mut model[number / LANES];
            some.phases[number % LANES] = phase(window.flux / step, *dither);
            some.weights[number % LANES] = window.weight;
        }
        for axis in (0..FREEDOMS).filter(|&axis| start.moves(axis)) {
            let mut nudge = [0.0; FREEDOMS];
            nudge[axis] = EPSILON;
            let nudged = see(&start.nudged(&nudge));
            for (number, (window, _)) in pilots.iter().enumerate() {
                if let Ok(found) = nudged.binary_search_by_key(&window.index, |other| other.index) {
                    model[number / LANES].slopes[axis][number % LANES] =
                        (nudged[found].flux - window.flux) / (EPSILON * step);
                }
            }
        }
        Model(model)
    }

    fn agreement(&self, nudge: &Nudge) -> f64 {
        let mut sum = 0.0;
        for some in &self.0 {
            let cosines = some.phases(nudge).map(cosine);
            for (weight, cosine) in some.weights.iter().zip(cosines) {
                sum += weight * cosine;
            }
        }
        sum
    }

    /// The mean curvature of the agreement: half of `(2 pi)^2 sum w slope slope^T`.
    fn curvature(&self) -> [Nudge; FREEDOMS] {
        let mut curvature = [[0.0; FREEDOMS]; FREEDOMS];
        for some in &self.0 {
            for lane in 0..LANES {
                let weight = 0.5 * TAU * TAU * some.weights[lane];
                for (row, a) in curvature.iter_mut().zip(&some.slopes) {
                    for (entry, b) in row.iter_mut().zip(&some.slopes) {
                        *entry += weight * a[lane] * b[lane];
                    }
                }
            }
        }
        curvature
    }

    /// Follows the gradient, scaled by the curvature, for a few steps.
    fn uphill(
        &self,
        mut nudge: Nudge,
        curvature: &[Nudge; FREEDOMS],
        climbs: usize,
    ) -> (f64, Nudge) {
        for _ in 0..climbs {
            let mut gradient = [0.0; FREEDOMS];
            for some in &self.0 {
                let sines = some.phases(&nudge).map(|phase| cosine(phase - 0.25));
                for lane in 0..LANES {
                    let push = -TAU * some.weights[lane] * sines[lane];
                    for (g, slopes) in gradient.iter_mut().zip(&some.slopes) {
                        *g += push * slopes[lane];
                    }
                }
            }
            let step = solve(*curvature, gradient);
            nudge
                .iter_mut()
                .zip(step)
                .for_each(|(x, step)| *x = held(*x + 0.35 * step, FARTHEST));
        }
        (self.agreement(&nudge), nudge)
    }
}

/// Gauss-Jordan elimination on a symmetric positive semidefinite matrix, damped.
fn solve(mut a: [Nudge; FREEDOMS], mut b: Nudge) -> Nudge {
    let trace: f64 = a.iter().enumerate().map(|(i, row)| row[i]).sum();
    for pivot in 0..FREEDOMS {
        a[pivot][pivot] += DAMPING * trace + 1e-300;
        let (row, known) = (a[pivot], b[pivot]);
        for (other, (entries, right)) in a.iter_mut().zip(&mut b).enumerate() {
            if other != pivot {
                let factor = entries[pivot] / row[pivot];
                entries
                    .iter_mut()
                    .zip(row)
                    .for_each(|(entry, x)| *entry -= factor * x);
                *right -= factor * known;
            }
        }
    }
    b.iter_mut().enumerate().for_each(|(i, x)| *x /= a[i][i]);
    b
}
