//! Scenes of several objects: what is found of a scene's mark in one object that was taken out of it, beside the same object as a file of
//! its own; in the scene written as one mesh; and of a single model's mark where something else stands about it.

use crate::case::Case;
use crate::cell::ln_p_by;
use crate::false_positives;
use crate::models::{self, Class, Model};
use crate::opened::{self, Opened};
use crate::room;
use crate::seed::Seed;
use glam::DVec3;
use meshmark::internals::attack::{into_scene, quantize, remesh, similarity, simplify};
use meshmark::internals::carrier::{Measurement, ring, solid};
use meshmark::internals::geometry::{Pieces, Pose};
use meshmark::internals::mesh::{Edges, Mesh, shapes};
use meshmark::internals::scene::to_glb;
use meshmark::{
    Carrier, EmbedOptions, Evidence, Files, Key, Model as File, Payload, Strength, Verdict, detect,
    embed,
};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Objects of fewer vertices are not taken out, and no more than so many of a scene, those of the most vertices.
const FEWEST_VERTICES: usize = 200;
const MOST_OBJECTS: usize = 2;

/// As a detector reads.
const MOST_PIECES: usize = 16;

/// Plain models of fewer vertices are not put beside other things.
const PLAIN_VERTICES: usize = 2000;

/// How much larger than the object the scene is that it is put into.
const TIMES: f64 = 5.0;

const STRENGTHS: [(&str, Strength); 2] = [
    ("strong", Strength::STRONG),
    ("balanced", Strength::BALANCED),
];

/// A scene, as a file and as its objects.
struct Setting {
    name: String,
    file: Opened,
    /// Of a generated scene, which is one mesh: how many vertices each object has, by its name.
    sizes: Option<Vec<(String, usize)>>,
}

impl Setting {
    fn generated(name: &str, objects: Vec<(String, Mesh)>) -> Setting {
        let size = |(name, mesh): &(String, Mesh)| (name.clone(), mesh.positions.len());
        let sizes = Some(objects.iter().map(size).collect());
        let bytes = to_glb(&Mesh::joined(objects.into_iter().map(|(_, mesh)| mesh)));
        let files = Files::new();
        let file = Opened { bytes, files };
        let name = name.to_owned();
        Setting { name, file, sizes }
    }

    /// The objects of this scene in a file, marked or not.
    fn objects(&self, file: &Opened) -> Result<Vec<(String, Mesh)>, String> {
        let Some(sizes) = &self.sizes else {
            return file.objects();
        };
        let whole = Mesh::joined(file.pieces()?);
        let mut first = 0;
        let object = |(name, size): &(String, usize)| {
            let vertices = first as u32..(first + size) as u32;
            first += size;
            let triangles = whole.triangles.iter();
            let own = triangles.filter(|triangle| vertices.contains(&triangle[0]));
            (name.clone(), whole.part(own.copied()))
        };
        Ok(sizes.iter().map(object).collect())
    }
}

/// Every file of a folder with several nodes that show something.
fn files(folder: &Path) -> Result<Vec<Setting>, String> {
    let mut settings = Vec::new();
    for path in opened::paths(folder)? {
        let file = Opened::new(&path)?;
        if file.objects()?.len() > 1 {
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            settings.push(Setting {
                name: name.into_owned(),
                file,
                sizes: None,
            });
        }
    }
    Ok(settings)
}

/// Scenes of this project's own making.
fn generated() -> Vec<Setting> {
    let parts = |mesh: &Mesh| {
        let mut parts: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
        for (part, &triangle) in Edges::new(mesh).components().iter().zip(&mesh.triangles) {
            parts.entry(*part).or_default().push(triangle);
        }
        let named = |(number, triangles): (usize, Vec<[u32; 3]>)| {
            (format!("part {}", number + 1), mesh.part(triangles))
        };
        parts.into_values().enumerate().map(named).collect()
    };
    vec![
        Setting::generated("rover", parts(&shapes::game_asset())),
        Setting::generated("seven shapes", parts(&shapes::seven_shapes())),
        Setting::generated("room", room::objects()),
    ]
}

/// Puts an object where it is to be found.
type Place<'a> = &'a dyn Fn(&Mesh) -> Mesh;

/// What is done to an object, or to the scene that it is put into.
type Then = (&'static str, fn(&Mesh, Place) -> Mesh);

const THEN: [Then; 4] = [
    ("as it is", |mesh, place| place(mesh)),
    ("simplify 50 %", |mesh, place| simplify(&place(mesh), 0.5)),
    ("isotropic remeshing 1 %, of the object", |mesh, place| {
        place(&remesh(mesh, 0.01))
    }),
    ("quantize 11 bits", |mesh, place| quantize(&place(mesh), 11)),
];

/// What was read.
struct Read {
    /// Found with the payload that was embedded, or present; of a mark without a payload, present.
    is_mark: bool,
    solid: f64,
    ring: f64,
}

fn read(suspect: &Mesh, key: &Key, payload: Payload, turn: u64) -> Result<Read, String> {
    let moved = similarity(suspect, turn);
    let read = detect(&to_glb(&moved), key, None).map_err(|error| error.to_string())?;
    let of = ln_p_by(&read);
    Ok(Read {
        is_mark: match read.verdict {
            Verdict::Found => read.number == Some(payload.number()),
            verdict => verdict == Verdict::Present,
        },
        solid: of(Carrier::Solid),
        ring: of(Carrier::Ring),
    })
}

/// A marked file; why not, where it cannot be marked.
fn marked(
    file: &Opened,
    payload: Payload,
    key: &Key,
    strength: Strength,
) -> Result<Opened, String> {
    let options = EmbedOptions::default().with_strength(strength);
    let model = File::new(&file.bytes).with_files(&file.files);
    let marking = embed(model, payload, key, &options);
    let marking = marking.map_err(|error| error.code().to_owned())?;
    let mut files = file.files.clone();
    files.extend(marking.files);
    Ok(Opened {
        bytes: marking.model,
        files,
    })
}

/// One object in one row: read where it was marked as a file of its own, and where its scene was. The second is not read where the first
/// is lost.
struct Cell {
    object: String,
    alone: Read,
    of_scene: Option<Read>,
}

/// Prints everything about one scene at one strength, as lines of the table.
fn print(setting: &Setting, strength: (&str, Strength), seed: &Seed) -> Result<(), String> {
    let purpose = format!("{}, {}", setting.name, strength.0);
    let (key, payload) = (seed.key(&purpose, 0), seed.payload(&purpose));
    let start = Instant::now();
    let scene = match marked(&setting.file, payload, &key, strength.1) {
        Ok(scene) => scene,
        Err(code) => {
            println!("| {} | {code} | | | |", setting.name);
            return Ok(());
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    let hosts = setting.objects(&setting.file)?;
    let parts = setting.objects(&scene)?;
    let mut pairs: Vec<((String, Mesh), Mesh)> = hosts
        .into_iter()
        .zip(parts.into_iter().map(|(_, mesh)| mesh))
        .collect();
    pairs.sort_by_key(|((_, host), _)| std::cmp::Reverse(host.welded().positions.len()));
    pairs.retain(|((_, host), _)| host.welded().positions.len() >= FEWEST_VERTICES);
    pairs.truncate(MOST_OBJECTS);
    let mut refused = Vec::new();
    let mut objects = Vec::new();
    for ((name, host), of_scene) in pairs {
        let bytes = to_glb(&host);
        let files = Files::new();
        match marked(&Opened { bytes, files }, payload, &key, strength.1) {
            Ok(alone) => objects.push((name, alone.mesh()?, of_scene)),
            Err(code) => refused.push(format!("{name} ({code})")),
        }
    }

    let joined = Mesh::joined(scene.pieces()?);
    let turn = |row: &str| seed.number(&format!("{purpose}, {row}"), 0);
    let whole = read(&joined, &key, payload, turn("joined"))?;
    let said = if whole.is_mark { "found" } else { "lost" };
    println!(
        "| {} | flattened, joined | {said}, {:.0}/{:.0} | {} objects | {} |",
        setting.name,
        whole.solid,
        whole.ring,
        objects.len(),
        match refused.is_empty() {
            true => format!("embedded in {seconds:.0} s"),
            false => format!(
                "embedded in {seconds:.0} s; not markable alone: {}",
                refused.join(", ")
            ),
        },
    );
    for is_in_scene in [false, true] {
        for (then, change) in THEN {
            let row = match is_in_scene {
                false => format!("one object, alone, {then}"),
                true => format!("one object, in a scene {TIMES} x as large, {then}"),
            };
            let place = |mesh: &Mesh| match is_in_scene {
                false => mesh.clone(),
                true => into_scene(mesh, TIMES, turn(&row)),
            };
            let suspect = |mesh: &Mesh| change(mesh, &place);
            let cell = |(name, alone, of_scene): &(String, Mesh, Mesh)| -> Result<Cell, String> {
                let own = read(&suspect(alone), &key, payload, turn(&row))?;
                let of_scene = match own.is_mark {
                    true => Some(read(&suspect(of_scene), &key, payload, turn(&row))?),
                    false => None,
                };
                Ok(Cell {
                    object: name.clone(),
                    alone: own,
                    of_scene,
                })
            };
            let cells = objects
                .par_iter()
                .map(cell)
                .collect::<Result<Vec<_>, _>>()?;
            println!("{}", line(&setting.name, &row, &cells));
        }
    }
    Ok(())
}

fn line(scene: &str, row: &str, cells: &[Cell]) -> String {
    let pairs = || {
        cells
            .iter()
            .filter_map(|cell| Some((cell, cell.of_scene.as_ref()?)))
    };
    let lost = pairs().filter(|(_, of_scene)| !of_scene.is_mark);
    let lost: Vec<String> = lost
        .map(|(cell, of_scene)| {
            format!(
                "{} {:.0}/{:.0} -> {:.0}/{:.0}",
                cell.object, cell.alone.solid, cell.alone.ring, of_scene.solid, of_scene.ring
            )
        })
        .collect();
    format!(
        "| {scene} | {row} | {} of {} | {} | {} |",
        pairs().count(),
        cells.len(),
        pairs().filter(|(_, of_scene)| of_scene.is_mark).count(),
        lost.join(", ")
    )
}

/// What stands about a marked model: y is up.
type Beside = (&'static str, fn(&Mesh) -> Mesh);

const BESIDE: [Beside; 4] = [
    ("a ground plane beneath it", |mesh| {
        let (low, high) = ends(mesh);
        let middle = low.midpoint(high);
        let side = 1.5 * (high - low).length();
        let corner = |x: f64, z: f64| DVec3::new(middle.x + x * side, low.y, middle.z + z * side);
        Mesh {
            positions: vec![
                corner(-1.0, -1.0),
                corner(-1.0, 1.0),
                corner(1.0, 1.0),
                corner(1.0, -1.0),
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }),
    ("a box of a tenth of its volume in it", |mesh| {
        let Some(pose) = Pose::of(mesh) else {
            return Mesh::default();
        };
        let volume = |&triangle: &[u32; 3]| {
            let [a, b, c] = mesh.corners(triangle).map(|p| p - pose.centre);
            a.dot(b.cross(c)) / 6.0
        };
        let volume: f64 = mesh.triangles.iter().map(volume).sum();
        let side = libm::cbrt(0.1 * volume.abs());
        let cube = shapes::cuboid(DVec3::splat(side), [6; 3]);
        cube.with_positions(cube.positions.iter().map(|p| *p + pose.centre).collect())
    }),
    ("a second model beside it", |mesh| {
        let (low, high) = ends(mesh);
        let knot = shapes::torus_knot(120, 24);
        let (own_low, own_high) = ends(&knot);
        let size = (high - low).max_element() / (own_high - own_low).max_element();
        // With a gap of a twentieth of the model's size.
        let place = DVec3::new(high.x + 0.05 * (high - low).length(), low.y, low.z);
        knot.with_positions(
            knot.positions
                .iter()
                .map(|p| (*p - own_low) * size + place)
                .collect(),
        )
    }),
    ("a room about it", |mesh| {
        let (low, high) = ends(mesh);
        let side = 4.0 * (high - low).max_element();
        let mut room = shapes::cuboid(DVec3::splat(side), [1; 3]);
        room.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        let middle = DVec3::new(0.0, low.y + side / 2.0, 0.0);
        room.with_positions(room.positions.iter().map(|p| *p + middle).collect())
    }),
];

fn ends(mesh: &Mesh) -> (DVec3, DVec3) {
    let first = mesh.positions.first().copied().unwrap_or_default();
    let positions = mesh.positions.iter();
    positions.fold((first, first), |(low, high), &p| (low.min(p), high.max(p)))
}

/// A plain model, marked, then halved: alone, and beside each thing.
fn lines_beside(model: &Model, seed: &Seed) -> Result<Option<(String, Vec<Read>)>, String> {
    let case = Case::new(model, STRENGTHS[0], 0, seed)?;
    let Ok(marked) = &case.marked else {
        return Ok(None);
    };
    let halved = |other: Option<&Beside>| {
        let other = other.map(|(_, make)| make(&marked.mesh));
        let suspect = Mesh::joined(std::iter::once(marked.mesh.clone()).chain(other));
        let turn = seed.number(&case.purpose, 1);
        read(&simplify(&suspect, 0.5), &case.key, case.payload, turn)
    };
    let rows = std::iter::once(None).chain(BESIDE.iter().map(Some));
    let reads = rows.map(halved).collect::<Result<Vec<_>, _>>()?;
    Ok(Some((model.name.clone(), reads)))
}

fn beside(seed: &Seed) -> Result<String, String> {
    let (mut models, _) = models::all(None)?;
    models.retain(|model| {
        let is_large =
            models::gathered(&model.bytes).is_ok_and(|mesh| mesh.positions.len() >= PLAIN_VERTICES);
        model.class == Class::Plain && is_large
    });
    let reads = models.par_iter().map(|model| lines_beside(model, seed));
    let reads = reads.collect::<Result<Vec<_>, _>>()?;
    let reads: Vec<_> = reads.into_iter().flatten().collect();
    let names = std::iter::once("nothing").chain(BESIDE.iter().map(|(name, _)| *name));
    let mut text = format!(
        "Marked at strong, then simplified to half: {} plain models.\n\n| beside the model | found | lost (SOLID/RING) |\n|---|--:|---|\n",
        reads.len()
    );
    for (row, name) in names.enumerate() {
        let lost: Vec<String> = reads
            .iter()
            .filter(|(_, reads)| !reads[row].is_mark)
            .map(|(model, reads)| format!("{model} {:.0}/{:.0}", reads[row].solid, reads[row].ring))
            .collect();
        let num_found = reads.len() - lost.len();
        let _ = writeln!(text, "| {name} | {num_found} | {} |", lost.join(", "));
    }
    Ok(text)
}

/// Reads the scenes with so many keys that marked nothing, as a whole and by their pieces, unmarked and marked by another key and halved;
/// prints the tail of ln p.
pub fn wrong_keys(folder: Option<&Path>, seed: &Seed, tests: u64) -> Result<String, String> {
    let settings = folder.map_or_else(|| Ok(generated()), files)?;
    let mut suspects = Vec::new();
    for setting in &settings {
        let (key, payload) = (seed.key(&setting.name, 0), seed.payload(&setting.name));
        let marked = marked(&setting.file, payload, &key, STRENGTHS[0].1)?;
        suspects.push((
            format!("{}, unmarked", setting.name),
            evidence(&setting.file.mesh()?),
        ));
        suspects.push((
            format!("{}, simplify 50 %", setting.name),
            evidence(&simplify(&marked.mesh()?, 0.5)),
        ));
    }
    let title = "Scenes, as a whole and by their pieces";
    let section = false_positives::section(title, suspects, seed, tests);
    Ok(format!("seed {}\n{section}", seed.number))
}

/// What a suspect and each of its pieces show as they are: nothing depends on a key.
fn evidence(mesh: &Mesh) -> Evidence {
    let pieces = Pieces::of(mesh).in_order().take(MOST_PIECES);
    let all = std::iter::once(mesh.clone()).chain(pieces.map(|piece| mesh.part(piece)));
    let surfaces = all.flat_map(|piece| solid::Surfaces::new(&piece).plain().take(1));
    Evidence::from_iter([
        Measurement::Ring(ring::Measurement::new(mesh)),
        Measurement::Solid(surfaces.collect()),
    ])
}

/// Tables of a folder's scenes, at strong and balanced; of generated ones where there is none, and of plain models beside other things. Each
/// line is printed when it is there.
pub fn tables(folder: Option<&Path>, seed: &Seed) -> Result<String, String> {
    let settings = folder.map_or_else(|| Ok(generated()), files)?;
    println!("seed {}", seed.number);
    if folder.is_none() {
        print_costs(seed)?;
        println!("\n{}", beside(seed)?);
    }
    for strength in STRENGTHS {
        println!(
            "\n{}:\n\n| scene | then | marked alone: found | marked in the scene: found of these | lost (SOLID/RING alone -> in the scene) |\n|---|---|--:|--:|---|",
            strength.0
        );
        settings
            .par_iter()
            .try_for_each(|setting| print(setting, strength, seed))?;
    }
    Ok(String::new())
}

/// Prints how long a scene of a hundred parts takes beside one part of its size, at balanced.
fn print_costs(seed: &Seed) -> Result<(), String> {
    let part = shapes::asteroid(20, 25);
    let place = |number: u32| DVec3::new((number % 10).into(), (number / 10).into(), 0.0) * 3.0;
    let parts = (0..100).map(|number| {
        let by = place(number);
        part.with_positions(part.positions.iter().map(|p| *p + by).collect())
    });
    let (key, payload) = (seed.key("costs", 0), seed.payload("costs"));
    println!("\n| vertices | embed, s | found, s | not found, s |\n|---|--:|--:|--:|");
    for (name, mesh) in [
        ("one part", shapes::asteroid(200, 250)),
        ("a hundred parts", Mesh::joined(parts)),
    ] {
        let (bytes, files) = (to_glb(&mesh), Files::new());
        let host = Opened { bytes, files };
        let start = Instant::now();
        let marked = marked(&host, payload, &key, Strength::BALANCED)?;
        let embedded = start.elapsed().as_secs_f64();
        let seconds = |model: &Opened| -> Result<f64, String> {
            let start = Instant::now();
            detect(&model.bytes, &key, None).map_err(|error| error.to_string())?;
            Ok(start.elapsed().as_secs_f64())
        };
        println!(
            "| {name}, {} | {embedded:.1} | {:.1} | {:.1} |",
            mesh.positions.len(),
            seconds(&marked)?,
            seconds(&host)?
        );
    }
    Ok(())
}
