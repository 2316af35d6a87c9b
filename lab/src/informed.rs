//! What the original, or the record of an embedding, adds to a reading: one table, of the attacks that blind reading is weakest in.

use crate::case::{Case, Marked};
use crate::false_positives;
use crate::models::{Model, gathered};
use crate::real::Tool;
use crate::seed::Seed;
use glam::{DMat3, DVec3};
use meshmark::internals::attack::{chain, crop, remesh, similarity, simplify, step};
use meshmark::internals::geometry::diagonal;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::scene::to_glb;
use meshmark::internals::strangers;
use meshmark::{
    Comparison, Key, RecordOptions, Shape, Strength, Verdict, compare, compare_with_record, detect,
    record,
};
use rayon::prelude::*;
use std::time::Instant;

/// Length of a side after remeshing, as a fraction of the diagonal.
const REMESHED: f64 = 0.01;

/// What other people's programs are told, where they are there: to halve a model, and else.
pub const HALVING: [&str; 6] = [
    "glTF-Transform simplify --ratio 0.5 --error 1",
    "gltfpack -si 0.5",
    "meshoptimizer simplify 50%",
    "MeshLab meshing_decimation_quadric_edge_collapse targetperc=0.5",
    "Open3D simplify_quadric_decimation target_number_of_triangles=50%",
    "Blender DECIMATE ratio=0.5",
];
const TOOLS: [&str; 4] = [
    "MeshLab apply_coord_laplacian_smoothing",
    "MeshLab compute_normal_per_vertex generate_surface_reconstruction_screened_poisson depth=8",
    "Open3D filter_smooth_laplacian number_of_iterations=3",
    "Open3D filter_smooth_taubin number_of_iterations=10",
];

/// Of small models, which rows are of interest: copies as they are, and halved.
const LOW_POLY: [&str; 4] = ["none", "simplify 50 %", "unmarked", "wrong key"];

type Make = fn(&Case, &Mesh, u64) -> Result<Mesh, String>;

/// A row: what is done to the marked mesh, here or by a program.
enum Row<'a> {
    Own(&'a str, Make),
    Tool(&'a Tool),
}

impl Row<'_> {
    fn name(&self) -> &str {
        match self {
            Row::Own(name, _) => name,
            Row::Tool(tool) => &tool.name,
        }
    }

    fn make(&self, case: &Case, marked: &Marked, seed: u64) -> Result<Mesh, String> {
        match self {
            Row::Own(_, make) => make(case, &marked.mesh, seed),
            Row::Tool(tool) => gathered(&tool.run(&marked.bytes)?),
        }
    }
}

/// The rows: what is done to the marked mesh.
const ROWS: [(&str, Make); 20] = [
    ("posed 30 degrees, simplify 50 %", |_, marked, seed| {
        by_name(marked, &["posed 30 degrees", "simplify 50 %"], seed)
    }),
    (
        "two pieces of it beside a third thing, simplify 50 %",
        |_, marked, _| Ok(kit(&simplify(marked, 0.5))),
    ),
    (
        "unmarked, posed 30 degrees, simplify 50 %",
        |case, _, seed| by_name(&case.host, &["posed 30 degrees", "simplify 50 %"], seed),
    ),
    ("none", |_, marked, _| Ok(marked.clone())),
    ("simplify 50 %", |_, marked, seed| {
        by_name(marked, &["simplify 50 %"], seed)
    }),
    (
        "crop 30 %, simplify 50 %, glTF quantize 10 bits",
        |_, marked, seed| {
            by_name(
                marked,
                &["crop 30 %", "simplify 50 %", "glTF quantize 10 bits"],
                seed,
            )
        },
    ),
    ("crop 50 %, isotropic remeshing 1 %", |_, marked, seed| {
        Ok(remesh(&crop(marked, 0.5, seed), REMESHED))
    }),
    ("crop 70 %", |_, marked, seed| Ok(crop(marked, 0.7, seed))),
    ("crop 90 %", |_, marked, seed| Ok(crop(marked, 0.9, seed))),
    ("mirrored, isotropic remeshing 1 %", |_, marked, _| {
        Ok(remesh(&mirrored(marked), REMESHED))
    }),
    ("scaled by 1.5, 1 and 0.7, simplify 50 %", |_, marked, _| {
        let scaled = marked.positions.iter();
        let scaled = scaled.map(|p| *p * DVec3::new(1.5, 1.0, 0.7)).collect();
        Ok(simplify(&marked.with_positions(scaled), 0.5))
    }),
    ("simplify 90 %", |_, marked, seed| {
        by_name(marked, &["simplify 90 %"], seed)
    }),
    ("simplify 95 %", |_, marked, seed| {
        by_name(marked, &["simplify 95 %"], seed)
    }),
    ("Laplacian 50", |_, marked, seed| {
        by_name(marked, &["Laplacian 50"], seed)
    }),
    (
        "isotropic remeshing 1 %, Laplacian 10",
        |_, marked, seed| by_name(&remesh(marked, REMESHED), &["Laplacian 10"], seed),
    ),
    ("noise 0.5 %", |_, marked, seed| {
        by_name(marked, &["noise 0.5 %"], seed)
    }),
    ("quantize 7 bits", |_, marked, seed| {
        by_name(marked, &["quantize 7 bits"], seed)
    }),
    ("resampled distance 0.8 %", |_, marked, seed| {
        by_name(marked, &["resampled distance 0.8 %"], seed)
    }),
    ("unmarked", |case, _, _| Ok(case.host.clone())),
    ("wrong key", |case, _, _| case.by_another(1)),
];

fn by_name(mesh: &Mesh, names: &[&str], seed: u64) -> Result<Mesh, String> {
    let named = |name: &&str| step(name).ok_or_else(|| format!("there is no attack {name}"));
    let steps = names.iter().map(named).collect::<Result<Vec<_>, _>>()?;
    Ok(chain(mesh, &steps, seed))
}

/// Two ends of a model, moved and turned against each other, beside something that is not of it.
fn kit(mesh: &Mesh) -> Mesh {
    let size = diagonal(&mesh.positions);
    let centre = mesh.positions.iter().sum::<DVec3>() / mesh.positions.len().max(1) as f64;
    let along = DVec3::new(0.6, 0.7, 0.2).normalize();
    let end = |direction: DVec3| {
        let is_there = |v: &u32| (mesh.positions[*v as usize] - centre).dot(direction) > 0.1 * size;
        mesh.part(
            mesh.triangles
                .iter()
                .copied()
                .filter(|t| t.iter().all(is_there)),
        )
    };
    let turned = |mesh: Mesh, shift: DVec3| {
        let turn = DMat3::from_rotation_y(0.7);
        let positions = mesh.positions.iter().map(|p| turn * *p + shift);
        mesh.with_positions(positions.collect())
    };
    let third = shapes::relief_sphere(60, 90);
    let small = 0.4 * size / diagonal(&third.positions);
    let third = third.with_positions(third.positions.iter().map(|p| *p * small).collect());
    Mesh::joined([
        turned(end(along), DVec3::X * (2.0 * size)),
        end(-along),
        turned(third, DVec3::ONE * size),
    ])
}

fn mirrored(mesh: &Mesh) -> Mesh {
    let turned = mesh.positions.iter().map(|p| DVec3::new(-p.x, p.y, p.z));
    let mut mirrored = mesh.with_positions(turned.collect());
    mirrored.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mirrored
}

/// What one reading said.
struct Said {
    /// Found with the payload that was embedded, or present of a mark without one.
    is_right: bool,
    /// Found or present, whatever was read.
    is_mark: bool,
    is_same_shape: bool,
    ln_p: f64,
    seconds: f64,
}

impl Said {
    fn of(comparison: &Comparison, number: Option<u64>, start: Instant) -> Said {
        Said {
            is_same_shape: comparison.shape == Shape::Same,
            ..Said::new(
                comparison.verdict,
                comparison.number,
                number,
                comparison.ln_p(),
                start,
            )
        }
    }

    fn new(
        verdict: Verdict,
        read: Option<u64>,
        number: Option<u64>,
        ln_p: f64,
        start: Instant,
    ) -> Said {
        let is_mark = matches!(verdict, Verdict::Found | Verdict::Present);
        Said {
            is_right: is_mark && read == number,
            is_mark,
            is_same_shape: true,
            ln_p,
            seconds: start.elapsed().as_secs_f64(),
        }
    }
}

/// Blind, with the original, with the record; `None` where a program did not do what it was told, or another key cannot mark the model.
type Cell = Option<[Said; 3]>;

/// Prints the table, row after row: each model once at a strength, under keys of its own; of small models only copies that are whole or halved.
pub fn table(
    models: &[Model],
    (name, strength): (&'static str, Strength),
    seed: &Seed,
    tools: &[Tool],
    are_low_poly: bool,
) -> Result<String, String> {
    let cases = models.par_iter();
    let cases = cases.map(|model| Case::new(model, (name, strength), 0, seed));
    let mut cases = cases.collect::<Result<Vec<_>, _>>()?;
    cases.retain(|case| case.marked.is_ok());
    let names: Vec<&str> = cases.iter().map(|case| &*case.model.name).collect();
    println!(
        "{name}, seed {}, {} models: {}\n\n\
         | attack | blind | with the original | with the record | ln p, median: blind | original | record | s, median: original | record | not found with the original |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|---|",
        seed.number,
        names.len(),
        names.join(", "),
    );
    let is_told = |name: &str| HALVING.contains(&name) || !are_low_poly && TOOLS.contains(&name);
    let tools = tools.iter().filter(|tool| is_told(&tool.name));
    let own = ROWS.iter();
    let own = own.filter(|(name, _)| !are_low_poly || LOW_POLY.contains(name));
    let own = own.map(|(name, make)| Row::Own(name, *make));
    for row in own.chain(tools.map(Row::Tool)) {
        let cells = cases.par_iter().map(|case| cells_of(case, &row));
        let cells = cells.collect::<Result<Vec<Cell>, _>>()?;
        println!("{}", line(row.name(), &names, &cells));
    }
    Ok(String::new())
}

fn line(row: &str, names: &[&str], cells: &[Cell]) -> String {
    let made = || cells.iter().flatten();
    let found = |by: usize| made().filter(|cell| cell[by].is_right).count();
    let median = |by: usize, of: fn(&Said) -> f64| {
        let mut values: Vec<f64> = made().map(|cell| of(&cell[by])).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let missed: Vec<String> = names
        .iter()
        .zip(cells)
        .filter_map(|(name, cell)| match cell {
            None => Some(format!("{name} (not made)")),
            Some([_, said, _]) if said.is_right => None,
            Some([_, said, _]) if said.is_mark => Some(format!("{name} (p)")),
            Some([_, said, _]) if !said.is_same_shape => Some(format!("{name} (another shape)")),
            Some(_) => Some((*name).to_owned()),
        })
        .collect();
    format!(
        "| {row} | {} | {} | {} | {:.0} | {:.0} | {:.0} | {:.1} | {:.1} | {} |",
        found(0),
        found(1),
        found(2),
        median(0, |said| said.ln_p),
        median(1, |said| said.ln_p),
        median(2, |said| said.ln_p),
        median(1, |said| said.seconds),
        median(2, |said| said.seconds),
        missed.join(", "),
    )
}

fn cells_of(case: &Case, row: &Row) -> Result<Cell, String> {
    let name = row.name();
    let marked = case.marked.as_ref().map_err(Clone::clone)?;
    let purpose = format!("{}, {name}", case.purpose);
    let suspect = match row.make(case, marked, case.seed.number(&purpose, 0)) {
        Ok(suspect) => suspect,
        Err(said) => {
            eprintln!("{}, {name}: {said}", case.model.name);
            return Ok(None);
        }
    };
    let suspect = to_glb(&similarity(&suspect, case.seed.number(&purpose, 1)));
    let said = |error: meshmark::Error| format!("{}, {name}: {error}", case.model.name);
    let number = marked.report.number;
    let start = Instant::now();
    let read = detect(&suspect, &case.key, None).map_err(said)?;
    let ln_p = read.details().ln_p;
    let blind = Said::new(read.verdict, read.number, number, ln_p, start);
    let start = Instant::now();
    let informed = compare(&suspect, &case.model.bytes, &case.key).map_err(said)?;
    let informed = Said::of(&informed, number, start);
    let options = RecordOptions::default();
    let kept = record(&case.model.bytes, &marked.report, &case.key, &options).map_err(said)?;
    let start = Instant::now();
    let recorded = compare_with_record(&suspect, &kept, &case.key).map_err(said)?;
    Ok(Some([blind, informed, Said::of(&recorded, number, start)]))
}

/// Keys that one lattice is read with: where it lies takes most of the time of a key, what its points hold little.
const KEYS_OF_A_LATTICE: u64 = 1000;

/// Lays suspects on their originals, unmarked and marked by another key, whole, in pieces and in another pose, and reads them with so many keys that
/// marked nothing, evenly; prints the tail of ln p.
pub fn wrong_keys(
    models: &[Model],
    strength: (&'static str, Strength),
    seed: &Seed,
    num_keys: u64,
) -> Result<String, String> {
    let start = Instant::now();
    let cases = models.par_iter();
    let cases = cases.map(|model| Case::new(model, strength, 0, seed));
    let mut cases = cases.collect::<Result<Vec<_>, _>>()?;
    cases.retain(|case| case.marked.is_ok());
    let suspects = cases.par_iter().map(suspects_of);
    let suspects: Vec<_> = suspects.collect::<Result<Vec<_>, _>>()?.concat();
    let each = num_keys.div_ceil(suspects.len().max(1) as u64);
    let purpose = format!("strangers, {}", strength.0);
    let read = |(number, (case, name, mesh)): (usize, &(&Case, String, Mesh))| {
        let first = number as u64 * each;
        let keys: Vec<Key> = (first..first + each)
            .map(|key| seed.key(&purpose, key))
            .collect();
        let lattices = keys.chunks(KEYS_OF_A_LATTICE as usize);
        let lattices: Vec<Vec<Key>> = lattices.map(<[Key]>::to_vec).collect();
        let ln_ps = strangers(mesh, &case.model.bytes, &lattices);
        let ln_ps = ln_ps.map_err(|error| format!("{name}: {error}"))?;
        eprintln!(
            "{name}: {} keys, {:.0} s",
            ln_ps.len(),
            start.elapsed().as_secs_f64()
        );
        Ok((name.clone(), ln_ps))
    };
    let read = suspects.par_iter().enumerate().map(read);
    let (names, ln_ps): (Vec<String>, Vec<Vec<f64>>) = read
        .collect::<Result<Vec<_>, String>>()?
        .into_iter()
        .unzip();
    let title = format!("With the original, {}, seed {}", strength.0, seed.number);
    let table = false_positives::document(&title, &names, &ln_ps);
    Ok(format!("{table}\n{:.0} s.", start.elapsed().as_secs_f64()))
}

/// What is laid on a model.
fn suspects_of<'a>(case: &'a Case<'a>) -> Result<Vec<(&'a Case<'a>, String, Mesh)>, String> {
    let marked = &case.marked.as_ref().map_err(Clone::clone)?.mesh;
    let by = |mesh: &Mesh, names: &[&str]| by_name(mesh, names, case.seed.number(&case.purpose, 9));
    let suspects = [
        ("unmarked", case.host.clone()),
        ("marked", marked.clone()),
        (
            "marked, crop 50 %, simplify 50 %",
            by(marked, &["crop 50 %", "simplify 50 %"])?,
        ),
        (
            "marked, posed 30 degrees, simplify 50 %",
            by(marked, &["posed 30 degrees", "simplify 50 %"])?,
        ),
        (
            "posed 30 degrees, unmarked",
            by(&case.host, &["posed 30 degrees"])?,
        ),
    ];
    let named = suspects.into_iter().map(|(name, mesh)| {
        (
            case,
            format!("{}, {name}", case.model.name),
            similarity(&mesh, case.seed.number(&case.purpose, 10)),
        )
    });
    Ok(named.collect())
}
