//! The attacks by name, each with the levels that tables show: one list for the lab, the command line, the tests and the page.

use super::{
    bake, bend, bilaplacian, both_sides, catmull_clark, convert_units, copies, crop, delaunay,
    hull, into_scene, loop_scheme, mean_curvature_flow, mean_filter, midpoint, mirror, noise,
    quantize, quantize_evenly, remesh, reorder, resample, similarity, simplify, simplify_volume,
    smooth, smooth_inside, soup, split, sqrt3, stray, swap_axes, take_out, taubin, warp, weld,
};
use crate::mesh::Mesh;
use serde::Serialize;
use std::fmt;

/// Where an attack comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// The LIRIS benchmark (Wang, Lavoue, Denis, Baskurt and He 2010).
    Benchmark,
    /// Smoothings beside the benchmark's, the seed paper's among them.
    Smoothing,
    /// The same surface in other triangles.
    Retessellation,
    /// What happens to files that nobody means harm.
    Wild,
    /// What somebody does who knows that there is a mark, and has no key.
    Deliberate,
}

/// An attack, with all its levels.
pub struct Attack {
    /// What tables, the command line and the page call it, in lower case but for names.
    pub name: &'static str,
    /// Where it comes from.
    pub family: Family,
    /// What follows a level: `" %"`, `" bits"`; nothing where the level is a count.
    pub unit: &'static str,
    /// The levels of tables, weakest first; none where there is nothing to choose.
    pub levels: &'static [f64],
    apply: fn(&Mesh, f64, u64) -> Mesh,
}

/// An attack at one of its levels.
#[derive(Clone, Copy)]
pub struct Step {
    /// What is done.
    pub attack: &'static Attack,
    /// How much, in the attack's unit; 0 where it has no levels.
    pub level: f64,
}

impl Step {
    /// The attacked mesh. Equal seeds give equal meshes.
    pub fn apply(&self, mesh: &Mesh, seed: u64) -> Mesh {
        (self.attack.apply)(mesh, self.level, seed)
    }
}

/// As [`step`] reads it: `noise 0.1 %`.
impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Attack {
            name, unit, levels, ..
        } = self.attack;
        if levels.is_empty() {
            write!(f, "{name}")
        } else {
            write!(f, "{name} {}{unit}", self.level)
        }
    }
}

/// Steps one after another, each with a seed of its own: `seed`, `seed + 1`, and so on.
pub fn chain(mesh: &Mesh, steps: &[Step], seed: u64) -> Mesh {
    let apply = |mesh, (step, number): (&Step, u64)| step.apply(&mesh, seed.wrapping_add(number));
    steps.iter().zip(0..).fold(mesh.clone(), apply)
}

/// A step by its name: an attack's, and behind it one of its levels, with or without the unit. `None` if there is none such: levels
/// are those of the catalogue, which have been tried.
pub fn step(name: &str) -> Option<Step> {
    let attack = CATALOGUE
        .iter()
        .filter(|attack| name.starts_with(attack.name))
        .max_by_key(|attack| attack.name.len())?;
    attack.steps().find(|step| {
        let whole = step.to_string();
        name == whole || name == whole.trim_end_matches(attack.unit)
    })
}

/// An attack as programs and pages list it.
#[derive(Serialize)]
pub struct Entry {
    name: &'static str,
    family: Family,
    unit: &'static str,
    levels: &'static [f64],
    steps: Vec<String>,
}

/// Every attack there is.
pub fn entries() -> Vec<Entry> {
    let entry = |attack: &'static Attack| Entry {
        name: attack.name,
        family: attack.family,
        unit: attack.unit,
        levels: attack.levels,
        steps: attack.steps().map(|step| step.to_string()).collect(),
    };
    CATALOGUE.iter().map(entry).collect()
}

impl Attack {
    /// The attack at each of its levels, or as it is.
    pub fn steps(&'static self) -> impl Iterator<Item = Step> {
        let plain = self.levels.is_empty().then_some(0.0);
        let levels = self.levels.iter().copied().chain(plain);
        levels.map(move |level| Step {
            attack: self,
            level,
        })
    }
}

const fn attack(
    name: &'static str,
    family: Family,
    unit: &'static str,
    levels: &'static [f64],
    apply: fn(&Mesh, f64, u64) -> Mesh,
) -> Attack {
    Attack {
        name,
        family,
        unit,
        levels,
        apply,
    }
}

/// Noise along random directions, in percent of the diagonal.
pub const NOISE: Attack = attack(
    "noise",
    Family::Benchmark,
    " %",
    &[0.05, 0.1, 0.3, 0.5],
    |m, x, seed| noise(m, x / 100.0, seed),
);

/// Quadric error metrics, in percent of the edges.
pub const SIMPLIFY: Attack = attack(
    "simplify",
    Family::Benchmark,
    " %",
    &[10.0, 30.0, 50.0, 70.0, 90.0, 95.0, 97.5],
    |m, x, _| simplify(m, x / 100.0),
);

/// A part cut off, in percent.
pub const CROP: Attack = attack(
    "crop",
    Family::Benchmark,
    " %",
    &[10.0, 30.0, 50.0],
    |m, x, seed| crop(m, x / 100.0, seed),
);

/// Laplacian smoothing that moves boundaries too, in steps of 0.1.
pub const SMOOTH: Attack = attack(
    "Laplacian with borders",
    Family::Smoothing,
    "",
    &[10.0, 50.0],
    |m, x, _| smooth(m, 0.1, x as u32),
);

/// Quantization as glTF's optimisers do it, to so many bits.
pub const QUANTIZE_EVENLY: Attack = attack(
    "glTF quantize",
    Family::Wild,
    " bits",
    &[14.0, 12.0, 10.0, 8.0],
    |m, x, _| quantize_evenly(m, x as u32),
);

/// Every attack, in the order of tables.
pub static CATALOGUE: &[Attack] = &{
    use Family::{Benchmark, Deliberate, Retessellation, Smoothing, Wild};
    [
        attack("reorder", Benchmark, "", &[], |m, _, seed| reorder(m, seed)),
        attack("similarity", Benchmark, "", &[], |m, _, seed| {
            similarity(m, seed)
        }),
        NOISE,
        attack(
            "Laplacian",
            Benchmark,
            "",
            &[5.0, 10.0, 30.0, 50.0],
            |m, x, _| smooth_inside(m, 0.1, x as u32),
        ),
        attack(
            "quantize",
            Benchmark,
            " bits",
            &[11.0, 10.0, 9.0, 8.0, 7.0],
            |m, x, _| quantize(m, x as u32),
        ),
        attack("midpoint", Benchmark, "", &[], |m, _, _| midpoint(m)),
        attack("square root of 3", Benchmark, "", &[], |m, _, _| sqrt3(m)),
        attack("Loop", Benchmark, "", &[], |m, _, _| loop_scheme(m)),
        SIMPLIFY,
        attack(
            "simplify Lindstrom-Turk",
            Benchmark,
            " %",
            &[10.0, 30.0, 50.0, 70.0, 90.0, 95.0, 97.5],
            |m, x, _| simplify_volume(m, x / 100.0),
        ),
        CROP,
        attack("MeshSmooth", Smoothing, "", &[1.0, 2.0], |m, x, _| {
            catmull_clark(m, x as u32)
        }),
        SMOOTH,
        attack("Taubin", Smoothing, "", &[5.0, 20.0], |m, x, _| {
            taubin(m, 0.5, -0.53, x as u32)
        }),
        attack("bilaplacian", Smoothing, "", &[2.0, 10.0], |m, x, _| {
            bilaplacian(m, 0.5, x as u32)
        }),
        attack(
            "mean curvature flow",
            Smoothing,
            "",
            &[1.0, 2.0],
            |m, x, _| mean_curvature_flow(m, 0.5, x as u32),
        ),
        attack("mean filter", Smoothing, "", &[1.0, 2.0], |m, x, _| {
            mean_filter(m, x as u32)
        }),
        attack(
            "isotropic remeshing",
            Retessellation,
            " %",
            &[1.0],
            |m, x, _| remesh(m, x / 100.0),
        ),
        attack(
            "resampled distance",
            Retessellation,
            " %",
            &[0.8],
            |m, x, _| resample(m, x / 100.0),
        ),
        attack("flipped edges", Retessellation, "", &[], |m, _, _| {
            delaunay(m)
        }),
        attack("triangle soup", Wild, "", &[], |m, _, _| soup(m)),
        attack("merge by distance", Wild, " %", &[0.01], |m, x, _| {
            weld(m, x / 100.0)
        }),
        attack("baked transform", Wild, "", &[], |m, _, seed| bake(m, seed)),
        attack("swapped axes", Wild, "", &[], |m, _, _| swap_axes(m)),
        attack(
            "inches to metres at",
            Wild,
            " diagonals",
            &[100.0, 1000.0],
            convert_units,
        ),
        attack("mirrored copy", Wild, "", &[], |m, _, _| mirror(m)),
        attack("split by material", Wild, "", &[], |m, _, seed| {
            split(m, seed)
        }),
        attack("one part taken out", Wild, "", &[], |m, _, _| take_out(m)),
        attack("in a scene", Wild, " x as large", &[2.0, 5.0], into_scene),
        attack("posed", Wild, " degrees", &[10.0, 30.0], |m, x, _| {
            bend(m, x)
        }),
        attack("both sides", Wild, "", &[], |m, _, _| both_sides(m)),
        attack("outline hull", Wild, " %", &[0.2, 2.0], |m, x, _| {
            hull(m, x / 100.0)
        }),
        attack(
            "stray triangle at",
            Wild,
            " diagonals",
            &[10.0, 100.0],
            |m, x, _| stray(m, x),
        ),
        QUANTIZE_EVENLY,
        attack(
            "non-uniform scale",
            Wild,
            " %",
            &[2.0, 5.0, 10.0],
            |m, x, _| {
                let scale = glam::DVec3::new(1.0 + x / 100.0, 1.0, 1.0 - x / 200.0);
                m.with_positions(m.positions.iter().map(|p| *p * scale).collect())
            },
        ),
        attack(
            "copied triangles",
            Deliberate,
            " %",
            &[5.0, 100.0],
            |m, x, seed| copies(m, x / 100.0, 1, 0.0, seed),
        ),
        attack(
            "warp",
            Deliberate,
            " %",
            &[0.04, 0.08, 0.16, 0.32],
            |m, x, seed| warp(m, 0.1, x / 100.0, seed),
        ),
    ]
};
