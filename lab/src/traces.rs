//! Whether a program that learned from marked and unmarked models tells one from the other, without the key.
//!
//! Hosts are generated shapes, bent at random, whose surfaces are exactly smooth or as noisy as scans are. Of each there is a copy that is
//! marked under a key of its own. Half of the hosts, with their copies, teach a forest of decision trees (Breiman 2001) what statistics of a
//! surface are like with a mark and without; the others are what it is asked about.

use crate::models::gathered;
use crate::seed::Seed;
use meshmark::internals::attack::{noise, smooth, warp};
use meshmark::internals::carrier::ring::{STEP, rings, trace};
use meshmark::internals::geometry::{dihedrals, face_areas};
use meshmark::internals::mesh::{Edges, Mesh, shapes};
use meshmark::internals::scene::to_glb;
use meshmark::{Carrier, EmbedOptions, Strength, embed};
use rayon::prelude::*;
use smartcore::ensemble::random_forest_classifier::{
    RandomForestClassifier, RandomForestClassifierParameters,
};
use smartcore::linalg::basic::matrix::DenseMatrix;
use std::f64::consts::TAU;

/// Surfaces: the largest noise of a coordinate, as a fraction of the mean distance from the middle.
const SURFACES: [(&str, f64); 5] = [
    ("exactly smooth", 0.0),
    ("noise 0.02 %", 0.0002),
    ("noise 0.05 %", 0.0005),
    ("noise 0.1 %", 0.001),
    ("noise 0.2 %", 0.002),
];

/// What is marked with: strengths, and the carriers.
const MARKS: [(&str, Strength, &[Carrier]); 4] = [
    ("balanced", Strength::BALANCED, &Carrier::STANDARD),
    ("strong", Strength::STRONG, &Carrier::STANDARD),
    ("strong, SOLID alone", Strength::STRONG, &[Carrier::Solid]),
    ("strong, RING alone", Strength::STRONG, &[Carrier::Ring]),
];

/// Of some 1400 vertices, and such that most can be marked.
const SHAPES: [fn() -> Mesh; 2] = [|| shapes::asteroid(30, 46), || shapes::torus_knot(70, 20)];

/// Wavelengths and sizes of the deformations that make a host of a shape, as fractions of the diagonal.
const WARPS: [(f64, f64); 2] = [(0.5, 0.02), (0.2, 0.006)];

/// Steps of smoothing, one after another: what each takes is how much of a surface is in one band of wavelengths.
const BANDS: [u32; 7] = [1, 1, 2, 4, 8, 16, 32];

/// What the statistics are of, group by group: a band each, then the rest.
const GROUPS: [&str; BANDS.len() + 3] = [
    "what the 1st step of smoothing takes",
    "what the 2nd takes",
    "what steps 3 and 4 take",
    "what steps 5 to 8 take",
    "what steps 9 to 16 take",
    "what steps 17 to 32 take",
    "what steps 33 to 64 take",
    "offsets from one-rings",
    "offsets at RING's step",
    "angles at edges",
];

/// Steps at which features of rings are looked at, in those of RING.
const STEPS: [f64; 5] = [0.75, 0.875, 1.0, 1.125, 1.25];

/// Two tables: for each surface, how many of the copies and hosts that were asked about are told for what they are; and for each group of
/// statistics, how many are by it alone, whatever the surface.
pub fn table(num_hosts: u64, seed: &Seed) -> Result<String, String> {
    let mut text = format!(
        "seed {}, {num_hosts} hosts for each surface\n\n",
        seed.number
    );
    text += &head("surface");
    let all_groups: Vec<usize> = (0..GROUPS.len()).collect();
    let mut all = Vec::new();
    for surface in SURFACES {
        let hosts = (0..num_hosts).into_par_iter();
        let hosts = hosts.map(|number| Example::new(surface, number, seed));
        let hosts = hosts.collect::<Result<Vec<_>, _>>()?;
        text += &row(surface.0, &hosts, &all_groups, seed)?;
        all.extend(hosts);
        eprintln!("{}", surface.0);
    }
    // Who does not know how noisy a host was.
    text += &row("any of these", &all, &all_groups, seed)?;
    text += "\n";
    text += &head("by this alone");
    for (group, name) in GROUPS.iter().enumerate() {
        text += &row(name, &all, &[group], seed)?;
    }
    Ok(text)
}

fn head(first: &str) -> String {
    let names = MARKS.map(|(name, ..)| name).join(" | ");
    format!(
        "| {first} | {names} |\n|---|{}\n",
        "--:|".repeat(MARKS.len())
    )
}

fn row(name: &str, examples: &[Example], groups: &[usize], seed: &Seed) -> Result<String, String> {
    let cells = (0..MARKS.len()).map(|mark| told(examples, mark, groups, seed));
    let cells = cells.collect::<Result<Vec<_>, _>>()?;
    Ok(format!("| {name} | {} |\n", cells.join(" | ")))
}

/// Each of [`GROUPS`].
type Statistics = [Vec<f64>; GROUPS.len()];

/// Statistics of a host, and of its copies, where it could be marked.
struct Example {
    host: Statistics,
    copies: Vec<Option<Statistics>>,
}

impl Example {
    fn new((surface, size): (&str, f64), number: u64, seed: &Seed) -> Result<Example, String> {
        let purpose = format!("traces, {surface}, {number}");
        let shape = SHAPES[number as usize % SHAPES.len()]();
        let bent = (0..)
            .zip(WARPS)
            .fold(shape, |mesh, (index, (wavelength, rms))| {
                warp(&mesh, wavelength, rms, seed.number(&purpose, index))
            });
        let model = to_glb(&noise(&bent, size, seed.number(&purpose, 2)));
        let copies = MARKS.map(|(name, strength, carriers)| {
            let purpose = format!("{purpose}, {name}");
            let options = EmbedOptions::default()
                .with_strength(strength)
                .with_carriers(carriers.iter().copied());
            let (payload, key) = (seed.payload(&purpose), seed.key(&purpose, 0));
            let copy = embed(&model, payload, &key, &options).ok()?;
            Some(gathered(&copy.model).map(|mesh| statistics(&mesh)))
        });
        let copies = copies.into_iter().map(Option::transpose);
        Ok(Example {
            host: statistics(&gathered(&model)?),
            copies: copies.collect::<Result<_, _>>()?,
        })
    }
}

/// Of those that were not learned from, how many are told for what they are, by some groups of statistics.
fn told(
    examples: &[Example],
    mark: usize,
    groups: &[usize],
    seed: &Seed,
) -> Result<String, String> {
    // Half of each shape.
    let pairs_of = |half: usize| -> Vec<[&Statistics; 2]> {
        let examples = examples.iter().enumerate();
        let ours = examples.filter(|(place, _)| place / SHAPES.len() % 2 == half);
        ours.filter_map(|(_, one)| Some([&one.host, one.copies[mark].as_ref()?]))
            .collect()
    };
    let (learned, asked) = (pairs_of(0), pairs_of(1));
    let rows = |pairs: &[[&Statistics; 2]]| {
        let row = |all: &&Statistics| {
            groups
                .iter()
                .flat_map(|group| all[*group].clone())
                .collect()
        };
        let rows: Vec<Vec<f64>> = pairs.iter().flatten().map(row).collect();
        DenseMatrix::from_2d_vec(&rows).map_err(|error| error.to_string())
    };
    let kinds = |pairs: &[[&Statistics; 2]]| -> Vec<u32> { [0, 1].repeat(pairs.len()) };
    let parameters = RandomForestClassifierParameters::default()
        .with_n_trees(300)
        .with_seed(seed.number("traces, forest", 0));
    let forest = RandomForestClassifier::fit(&rows(&learned)?, &kinds(&learned), parameters);
    let asked_of = rows(&asked)?;
    let said = forest.and_then(|forest| forest.predict(&asked_of));
    let said = said.map_err(|error| error.to_string())?;
    let right = said
        .iter()
        .zip(kinds(&asked))
        .filter(|(said, kind)| *said == kind);
    Ok(format!("{} of {}", right.count(), said.len()))
}

/// What can be measured of any mesh, whatever its size and place.
fn statistics(mesh: &Mesh) -> Statistics {
    let size = mesh.area().sqrt();
    let edges = Edges::new(mesh);
    let mut rough = mesh.clone();
    let [b1, b2, b3, b4, b5, b6, b7] = BANDS.map(|steps| {
        let smoother = smooth(&rough, 0.5, steps);
        let moved = rough.positions.iter().zip(&smoother.positions);
        let moved: Vec<_> = moved.map(|(from, to)| (*from - *to) / size).collect();
        // Whether neighbours move alike.
        let alike = edges.pairs().map(|pair| {
            let [a, b] = pair.ends.map(|v| moved[v as usize].normalize_or_zero());
            a.dot(b)
        });
        let mut band = spread(moved.iter().map(|m| m.length())).to_vec();
        band.push(mean(alike));
        rough = smoother;
        band
    });
    let offsets: Vec<f64> = rings(mesh).iter().map(|ring| ring.offset).collect();
    let sizes = spread(offsets.iter().map(|offset| offset.abs()));
    let at_step = |step: f64| {
        let phases = offsets.iter().map(|offset| TAU * offset / (step * STEP));
        let [re, im] =
            [libm::cos as fn(f64) -> f64, libm::sin].map(|of| mean(phases.clone().map(of)));
        libm::hypot(re, im) * (offsets.len() as f64).sqrt()
    };
    let mut at_steps = STEPS.map(at_step).to_vec();
    at_steps.push(trace(mesh));
    let angles = dihedrals(mesh, &edges, &face_areas(mesh));
    let angles = spread(angles.iter().map(|dihedral| dihedral.angle.abs()));
    [
        b1,
        b2,
        b3,
        b4,
        b5,
        b6,
        b7,
        sizes.to_vec(),
        at_steps,
        angles.to_vec(),
    ]
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0_f64), |(sum, count), value| {
        (sum + value, count + 1.0)
    });
    sum / count.max(1.0)
}

/// Logarithms of how large values are, and how unlike each other: of three quantiles, and of the root of the mean square.
fn spread(values: impl Iterator<Item = f64>) -> [f64; 4] {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let place = share * (values.len() as f64 - 1.0);
        values.get(place as usize).copied().unwrap_or(0.0)
    };
    let square = mean(values.iter().map(|value| value * value));
    [at(0.1), at(0.5), at(0.9), square.sqrt()].map(|value| libm::log(value + 1e-12))
}

#[cfg(test)]
mod tests {
    use super::*;
    use meshmark::internals::attack::similarity;

    /// Else a copy could be told by where it stands.
    #[test]
    fn statistics_forget_size_and_place() {
        let mesh = noise(&shapes::low_poly(), 0.001, 1);
        let moved = statistics(&similarity(&mesh, 2));
        for (place, (own, moved)) in statistics(&mesh)
            .concat()
            .iter()
            .zip(moved.concat())
            .enumerate()
        {
            assert!((own - moved).abs() < 0.01, "{place}: {own} {moved}");
        }
    }
}
