//! Reading with the original: what a suspect shows of the displacement that the embedder must have given the original.
//!
//! The key and the original give, for each window, by how much of a step the embedder had to move it: an *error* that is uniform
//! over a step, for the dither is. A keyless filter gives what the suspect shows of each error: a *response*, from the embedder's own
//! linear problem and what was observed of the surface. Responses know no dither; so their product with the errors is as surprising as
//! it looks (docs/SECURITY.md, "With the original").

use super::cluster::clusters;
use super::embed::CLAMPS;
use super::frame::has_axes;
use super::freedom::{freedoms, typical};
use super::lattice::{Lattice, Placement, RADIUS};
use super::pitch::{AREAS, pitches, pitches_to_embed};
use super::problem::Problem;
use super::quantizer::{STEPS, phase};
use super::window::{Window, windows};
use crate::carrier::{Host, Place, Way};
use crate::code::Symbol;
use crate::geometry::{Observation, Pieces, Pose, conjugate_gradients, diagonal, oriented};
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::{Cancelled, Progress, Stage, step};
use crate::random::Random;
use glam::{DMat3, DVec3};

/// Noise of neighbouring observations is alike, and there are more of them than it has freedoms: each counts as this part of one.
pub const NOISES: [f64; 3] = [4.0, 32.0, 256.0];
/// Objects that are read alone, at most.
const MOST_OBJECTS: usize = 16;
/// The step that the displacement is taken to be in proportion to: what a strength has of both (`steps_for`).
const RMS_REL: f64 = 0.0008;
const ROUNDS: usize = 5;
const CG_STEPS: usize = 120;
const CG_TOLERANCE: f64 = 1e-3;

/// What is seen of a suspect that lies on the original in one way, by the radius of windows.
pub type Seen<'a> = dyn Fn(f64) -> Vec<Observation> + 'a;

/// Where an original may have been marked, whoever did it: as a whole, and each of its objects.
pub struct Frames<'a> {
    host: &'a Host<'a>,
    pub(super) frames: Vec<Frame>,
}

/// One of these.
pub(super) struct Frame {
    /// Oriented.
    pub mesh: Mesh,
    /// The names of its vertices in the whole.
    vertices: Vec<u32>,
    pub pose: Pose,
    freedom: Vec<f64>,
    /// What it is charged for being one of several.
    pub ln_num_shares: f64,
}

impl<'a> Frames<'a> {
    /// Of an original, as an embedder would have it as a host.
    pub fn new(host: &'a Host<'a>) -> Frames<'a> {
        let whole: Vec<u32> = (0..host.mesh.positions.len() as u32).collect();
        let mut parts = vec![(host.mesh.clone(), whole)];
        for object in Pieces::stable_objects(host.mesh)
            .into_iter()
            .take(MOST_OBJECTS)
        {
            let mut vertices: Vec<u32> = object.iter().flatten().copied().collect();
            vertices.sort_unstable();
            vertices.dedup();
            let mesh = host.mesh.part(object);
            if has_axes(&mesh) {
                parts.push((mesh, vertices));
            }
        }
        let num_parts = parts.len();
        let frame = |(number, (mesh, vertices)): (usize, (Mesh, Vec<u32>))| {
            let (mesh, boundary) = oriented(&mesh);
            let pose = Pose::of_oriented(&mesh, &boundary)?;
            let leeway = host.leeway.of(&mesh, &vertices);
            let own = Host {
                mesh: &mesh,
                leeway: &leeway,
                ..*host
            };
            let freedom = freedoms(&mesh, &boundary, &own, CLAMPS[0]);
            // The whole has half of the probability where there are objects, and they share the rest.
            let num_shares = match (number, num_parts) {
                (_, 1) => 1,
                (0, _) => 2,
                (_, num) => 2 * (num - 1),
            };
            Some(Frame {
                mesh,
                vertices,
                pose,
                freedom,
                ln_num_shares: libm::log(num_shares as f64),
            })
        };
        Frames {
            host,
            frames: parts.into_iter().enumerate().filter_map(frame).collect(),
        }
    }

    /// What a key has to look for there.
    pub fn with_key(&self, key: &Key) -> Reader<'_> {
        self.with_lattice(Lattice::of(key))
    }

    fn with_lattice(&self, lattice: Lattice) -> Reader<'_> {
        let mut laid = Vec::new();
        for frame in &self.frames {
            let (candidates, finest) = frame.pitches();
            let clusters = clusters(&frame.mesh, &frame.pose, finest);
            for &pitch in &candidates {
                let placement = lattice.placed(DMat3::IDENTITY, pitch);
                let active = windows(&clusters, &placement);
                if active.is_empty() {
                    continue;
                }
                laid.push(Laid {
                    frame,
                    placement,
                    response: Response::new(frame, &placement, &active, self.host.hidden),
                    held: held(&lattice, &active),
                    active,
                    ln_num_ways: libm::log((candidates.len() * WAYS) as f64) + frame.ln_num_shares,
                });
            }
        }
        Reader { laid }
    }
}

/// Ways that differ in step and noise.
const WAYS: usize = STEPS.len() * NOISES.len();

/// A key's lattice, laid through an original's frames.
pub struct Reader<'a> {
    laid: Vec<Laid<'a>>,
}

/// What each of some windows holds: its dither, and its symbol.
type Held = Vec<(f64, Symbol)>;

fn held(lattice: &Lattice, windows: &[Window]) -> Held {
    let windows = windows.iter();
    windows.map(|window| lattice.at(window.index)).collect()
}

struct Laid<'a> {
    frame: &'a Frame,
    placement: Placement,
    active: Vec<Window>,
    held: Held,
    response: Response<'a>,
    ln_num_ways: f64,
}

impl Reader<'_> {
    /// Calls `visit` with every declared way of reading, until it returns `true`. `seen` are the ways in which the suspect may lie on the
    /// host.
    pub fn read(
        &self,
        seen: &[&Seen],
        progress: &mut dyn Progress,
        visit: &mut dyn FnMut(Way) -> bool,
    ) -> Result<(), Cancelled> {
        self.respond(seen, progress, &mut |number, list, responses| {
            let laid = &self.laid[number];
            let way = |step| laid.way(&laid.held, responses, step, (list, seen));
            STEPS.into_iter().map(way).any(&mut *visit)
        })
    }

    /// The same with what the points of this key's lattice would hold under other keys: responses depend on where it lies, and on nothing else of a
    /// key. Calls `visit` with the number of the key, and each way.
    pub fn read_as(
        &self,
        seen: &[&Seen],
        others: &[Key],
        progress: &mut dyn Progress,
        visit: &mut dyn FnMut(usize, Way),
    ) -> Result<(), Cancelled> {
        let lattices: Vec<Lattice> = others.iter().map(Lattice::of).collect();
        let of_laid = |laid: &Laid| -> Vec<Held> {
            let lattices = lattices.iter();
            lattices.map(|other| held(other, &laid.active)).collect()
        };
        let all: Vec<Vec<Held>> = self.laid.iter().map(of_laid).collect();
        self.respond(seen, progress, &mut |number, list, responses| {
            let laid = &self.laid[number];
            for (other, held) in all[number].iter().enumerate() {
                for step in STEPS {
                    visit(other, laid.way(held, responses, step, (list, seen)));
                }
            }
            false
        })
    }

    /// Calls `visit` with what is seen of every window, for every lattice that is laid, by its number, every way to lie and level of noise, until it
    /// returns `true`.
    fn respond(
        &self,
        seen: &[&Seen],
        progress: &mut dyn Progress,
        visit: &mut dyn FnMut(usize, usize, &[f64]) -> bool,
    ) -> Result<(), Cancelled> {
        for (number, laid) in self.laid.iter().enumerate() {
            for (list, observe) in seen.iter().enumerate() {
                let done = (number * seen.len() + list) as f64;
                let all = (self.laid.len() * seen.len()) as f64;
                step(progress, Stage::Test, done / all)?;
                let observations = observe(laid.radius());
                let observations = laid.frame.own(observations);
                if observations.is_empty() {
                    continue;
                }
                let evidence = Evidence::new(&laid.response, &observations);
                for noise in NOISES {
                    if visit(number, list, &evidence.responses(noise)) {
                        return Ok(());
                    }
                }
            }
        }
        Ok(())
    }
}

impl Laid<'_> {
    /// Of the windows, in scene units.
    fn radius(&self) -> f64 {
        RADIUS * self.placement.pitch * self.frame.pose.size
    }

    /// The way of reading at a step, of one of so many ways to lie.
    fn way(
        &self,
        held: &Held,
        responses: &[f64],
        step: f64,
        (list, seen): (usize, &[&Seen]),
    ) -> Way {
        Way {
            places: self.places(held, responses, step),
            ln_num_tests: self.ln_num_ways + libm::log(seen.len() as f64),
            list,
            radius: self.radius(),
        }
    }

    /// The windows with their errors at a step, in the frame's units.
    fn places(&self, held: &Held, responses: &[f64], step: f64) -> Vec<Place> {
        let step = step / self.placement.pitch;
        let place =
            |((window, &(dither, symbol)), &response): ((&Window, &(f64, Symbol)), &f64)| {
                let phase = phase(window.flux / step, dither);
                let error = |coset: f64| {
                    let phase = phase - coset;
                    phase.round() - phase
                };
                Place {
                    symbol,
                    response,
                    errors: [error(0.5), error(0.0)],
                    centre: centre(&self.frame.pose, &self.placement, window.index),
                }
            };
        let windows = self.active.iter().zip(held);
        windows.zip(responses).map(place).collect()
    }
}

/// Where a window of a lattice in a frame is, in scene units.
pub(super) fn centre(pose: &Pose, placement: &Placement, index: [i32; 3]) -> DVec3 {
    let index = DVec3::from_array(index.map(f64::from));
    pose.axes * placement.point(index) * pose.size + pose.centre
}

impl Frame {
    /// The pitches that an embedder may have used, and the one that it gathered clusters for.
    pub fn pitches(&self) -> (Vec<f64>, f64) {
        let area = self.mesh.area() / (self.pose.size * self.pose.size);
        let candidates = pitches_to_embed(area).collect();
        let finest = pitches(area, AREAS).fold(f64::INFINITY, f64::min);
        (candidates, finest)
    }

    /// What is seen of this frame's vertices, by their own names.
    fn own(&self, observations: Vec<Observation>) -> Vec<Observation> {
        let own = |observation: Observation| {
            let name = |v: u32| self.vertices.binary_search(&v).ok();
            let [a, b, c] = observation.vertices;
            let vertices = [name(a)? as u32, name(b)? as u32, name(c)? as u32];
            Some(Observation {
                vertices,
                ..observation
            })
        };
        observations.into_iter().filter_map(own).collect()
    }
}

/// How the host answers to errors: the embedder's problem, with the ridge that a strength leads to on the average.
struct Response<'a> {
    problem: Problem<'a>,
    weights: Vec<f64>,
    ridge: f64,
    /// From lattice coordinates to the scene's.
    from_lattice: DMat3,
    /// In lattice coordinates.
    step: f64,
}

impl<'a> Response<'a> {
    fn new(
        frame: &'a Frame,
        placement: &Placement,
        active: &[Window],
        hidden: bool,
    ) -> Response<'a> {
        let Frame {
            mesh,
            pose,
            freedom,
            ..
        } = frame;
        let problem = Problem::new(mesh, pose, placement, active, freedom);
        let weights: Vec<f64> = active.iter().map(|window| window.weight).collect();
        let step = STEPS[0] / placement.pitch;
        let from_lattice = pose.axes * placement.rotation * (pose.size * placement.pitch);
        let limit = RMS_REL * diagonal(&mesh.positions);
        let typical = typical(freedom);
        let mut random = Random::new(1);
        let goals: Vec<f64> = active
            .iter()
            .map(|_| (random.unit() - 0.5) * step)
            .collect();
        let mut ridge = problem.mean_diagonal();
        let mut multipliers = vec![0.0; active.len()];
        for _ in 0..ROUNDS {
            let solution = problem.solve(&goals, &weights, ridge, &mut multipliers);
            let squares = solution.iter().zip(freedom).map(|(x, freedom)| {
                let share = if hidden { freedom / typical } else { 1.0 };
                (from_lattice * *x).length_squared() / (share * share)
            });
            let rms = (squares.sum::<f64>() / solution.len() as f64).sqrt();
            let excess = (rms / limit).clamp(0.05, 20.0);
            ridge *= excess * excess;
        }
        Response {
            problem,
            weights,
            ridge,
            from_lattice,
            step,
        }
    }

    fn ridged(&self, l: &[f64]) -> Vec<f64> {
        self.problem.ridged(l, &self.weights, self.ridge)
    }
}

/// What was observed, ready for the filter.
struct Evidence<'a> {
    response: &'a Response<'a>,
    observations: &'a [Observation],
    /// What each window would have to be pushed by for what was seen.
    pushes: Vec<f64>,
    /// For each window, about how precisely it is seen.
    squares: Vec<f64>,
}

impl<'a> Evidence<'a> {
    fn new(response: &'a Response, observations: &'a [Observation]) -> Evidence<'a> {
        let num_vertices = response.problem.num_vertices();
        let mut precisions = vec![0.0; num_vertices];
        for seen in observations {
            for (&v, weight) in seen.vertices.iter().zip(seen.weights) {
                precisions[v as usize] += seen.precision * weight * weight / 3.0;
            }
        }
        let scale = response.from_lattice.x_axis.length_squared();
        let mut evidence = Evidence {
            response,
            observations,
            pushes: Vec::new(),
            squares: response.problem.squares(&precisions),
        };
        evidence.squares.iter_mut().for_each(|s| *s *= scale);
        evidence.pushes = evidence.gathered(|seen| seen.value * seen.precision);
        evidence
    }

    /// The sum over observations of a number times how it answers to each window.
    fn gathered(&self, amount: impl Fn(&Observation) -> f64) -> Vec<f64> {
        let back = self.response.from_lattice.transpose();
        let mut at = vec![DVec3::ZERO; self.response.problem.num_vertices()];
        for seen in self.observations {
            let force = seen.direction * amount(seen);
            for (&v, weight) in seen.vertices.iter().zip(seen.weights) {
                at[v as usize] += force * weight;
            }
        }
        at.iter_mut().for_each(|force| *force = back * *force);
        self.response.problem.gathered(&at)
    }

    /// What is seen of each error: the mean of errors that are as likely as the embedder makes them, given what was observed.
    ///
    /// With A the matrix of the dual, errors e are A l / step, and the displacement is what l spreads.
    fn responses(&self, noise: f64) -> Vec<f64> {
        let response = self.response;
        let prior = 12.0 / (response.step * response.step);
        let apply = |l: &[f64]| -> Vec<f64> {
            let twice = response.ridged(&response.ridged(l));
            let moved = response.problem.spread(l);
            let seen = self.gathered(|seen| {
                let parts = seen.vertices.iter().zip(seen.weights);
                let moved: DVec3 = parts.map(|(&v, weight)| moved[v as usize] * weight).sum();
                (response.from_lattice * moved).dot(seen.direction) * seen.precision
            });
            let rows = twice.iter().zip(&seen);
            rows.map(|(a, b)| prior * a + b / noise).collect()
        };
        let diagonal = response.problem.diagonal().iter().zip(&response.weights);
        let diagonal: Vec<f64> = diagonal
            .zip(&self.squares)
            .map(|((d, w), square)| {
                let own = d + response.ridge / w;
                prior * own * own + square / noise
            })
            .collect();
        let precondition = |r: &[f64]| r.iter().zip(&diagonal).map(|(r, d)| r / d).collect();
        let goals: Vec<f64> = self.pushes.iter().map(|push| push / noise).collect();
        let mut l = vec![0.0; goals.len()];
        conjugate_gradients(apply, precondition, &goals, &mut l, CG_TOLERANCE, CG_STEPS);
        response.ridged(&l)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::*;
    use crate::geometry::{Bounds, Leeway, Parts, scattered};
    use crate::mesh::{Admissible, shapes};
    use crate::progress::ignore;

    /// docs/SECURITY.md, "With the original", 3: responses and charges know no dither, and each window has an address of its own.
    #[test]
    fn no_response_depends_on_a_dither() {
        let mesh = shapes::asteroid(20, 30);
        let (parts, admissible) = (Parts::new(&mesh), Admissible::default());
        let leeway = Leeway::new(&mesh, &parts, Bounds::HIDDEN);
        let host = Host {
            mesh: &mesh,
            leeway: &leeway,
            admissible: &admissible,
            rms_rel: 0.0004,
            hidden: true,
            share: 1.0,
            on_top: None,
        };
        let observations: Vec<Observation> = scattered(&mesh, 2000, 1)
            .iter()
            .map(|point| Observation {
                vertices: mesh.triangles[point.triangle as usize],
                weights: point.weights,
                direction: point.normal,
                value: 1e-3 * libm::sin(20.0 * point.position.x),
                precision: 1e6,
            })
            .collect();
        let frames = Frames::new(&host);
        let ways = |lattice: Lattice| {
            let mut ways = Vec::new();
            let observe = |_: f64| observations.clone();
            let mut keep = |way: Way| {
                ways.push(way);
                false
            };
            let reader = frames.with_lattice(lattice);
            reader.read(&[&observe], &mut ignore, &mut keep).unwrap();
            ways
        };
        let key = |number: u8| Key::from_bytes(&[number; Key::BYTES]).unwrap();
        let drawn = ways(Lattice::of(&key(1)));
        let redrawn = ways(Lattice::of(&key(1)).redrawn(&key(2)));
        assert!(!drawn.is_empty() && drawn.len() == redrawn.len());
        let charge = |way: &Way| way.ln_num_tests;
        let total: f64 = drawn.iter().map(|way| libm::exp(-charge(way))).sum();
        assert!(total <= 1.0 + 1e-9, "the shares add up to {total}");
        for (a, b) in drawn.iter().zip(&redrawn) {
            assert_eq!(charge(a), charge(b));
            let responses =
                |way: &Way| -> Vec<f64> { way.places.iter().map(|place| place.response).collect() };
            assert_eq!(responses(a), responses(b));
            assert!(responses(a).iter().any(|response| *response != 0.0));
            assert_ne!(a.places, b.places, "nothing was redrawn");
        }
    }
}
