//! What people who know the method, and have no key, learn from marked models and do to them: traces, RING marks that are carried over to
//! other models, and stretches that nobody sees.

use crate::cell::ln_p_by;
use crate::models::{Class, Model, Size, gathered};
use crate::seed::Seed;
use glam::DVec3;
use meshmark::internals::attack::{remesh, simplify};
use meshmark::internals::carrier::ring::{Ring, STEP, rings, trace};
use meshmark::internals::geometry::Distortion;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::to_glb;
use meshmark::{Carrier, EmbedOptions, Extraction, Key, Strength, Verdict, detect, embed};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;

type Change = fn(&Mesh) -> Mesh;

/// What is done to a stretched copy, so that RING is gone.
const THEN: [(&str, Change); 3] = [
    ("30 % fewer edges", |mesh| simplify(mesh, 0.3)),
    ("half of the edges", |mesh| simplify(mesh, 0.5)),
    ("remeshed", |mesh| remesh(mesh, 0.01)),
];

/// Rounds in which a copied phase is approached: neighbours move each other's.
const ROUNDS: usize = 20;

/// All tables, for the plain models.
pub fn table(models: Vec<Model>, seed: &Seed) -> Result<String, String> {
    let is_meant = |model: &Model| model.class == Class::Plain && model.size <= Size::Usual;
    let models: Vec<Model> = models.into_iter().filter(is_meant).collect();
    let mut text = format!("seed {}\n", seed.number);
    for (name, strength) in [
        ("balanced", Strength::BALANCED),
        ("strong", Strength::STRONG),
    ] {
        let _ = writeln!(text, "\n{name}");
        let owner = seed.key("adversary", 0);
        let mark = |model: &Model| Marked::new(model, &owner, strength, seed);
        let of_one_key: Vec<Marked> = models.par_iter().map(mark).collect::<Result<_, _>>()?;
        traces(&of_one_key, &mut text);
        stretches(&of_one_key, &mut text)?;
        let mark = |model: &Model| {
            let key = owner.for_work(&model.name);
            Marked::new(model, &key.expect("models have names"), strength, seed)
        };
        let of_works: Vec<Marked> = models.par_iter().map(mark).collect::<Result<_, _>>()?;
        carried_over(&of_one_key, &of_works, &mut text)?;
    }
    Ok(text)
}

/// A model before and after it was marked.
struct Marked {
    name: String,
    host: Mesh,
    copy: Mesh,
    key: Key,
}

impl Marked {
    fn new(model: &Model, key: &Key, strength: Strength, seed: &Seed) -> Result<Marked, String> {
        let payload = seed.payload(&format!("adversary, {}", model.name));
        let options = EmbedOptions::default().with_strength(strength);
        let marked = embed(&*model.bytes, payload, key, &options);
        Ok(Marked {
            name: model.name.clone(),
            host: gathered(&model.bytes)?,
            copy: gathered(
                &marked
                    .map_err(|error| format!("{}: {error}", model.name))?
                    .model,
            )?,
            key: key.clone(),
        })
    }
}

fn read(suspect: &Mesh, key: &Key) -> Result<Extraction, String> {
    detect(&to_glb(suspect), key, None).map_err(|error| error.to_string())
}

/// How far rings that share an address agree, without the key.
fn traces(marked: &[Marked], text: &mut String) {
    let _ = writeln!(
        text,
        "\ntraces of RING, in standard deviations | host | marked"
    );
    for model in marked {
        let (host, copy) = (trace(&model.host), trace(&model.copy));
        let _ = writeln!(text, "{} | {host:.1} | {copy:.1}", model.name);
    }
}

/// A scale along one axis of the file, or one that differs along all three.
fn stretches(marked: &[Marked], text: &mut String) -> Result<(), String> {
    let _ = writeln!(text, "\nscale | then | found, of | not found");
    let along = |axis: usize, ratio: f64| {
        let mut scale = DVec3::ONE;
        scale[axis] = ratio;
        scale
    };
    for percent in [2.0, 5.0, 10.0] {
        let ratio = 1.0 + percent / 100.0;
        let one: Vec<DVec3> = (0..3).map(|axis| along(axis, ratio)).collect();
        let all = vec![DVec3::new(ratio, 1.0, 1.0 - percent / 200.0)];
        for (name, scales) in [("one axis", one), ("three axes", all)] {
            for (then, change) in THEN {
                let cells: Vec<(&Marked, DVec3)> = marked
                    .iter()
                    .flat_map(|model| scales.iter().map(move |scale| (model, *scale)))
                    .collect();
                let lost = |(model, scale): &(&Marked, DVec3)| -> Result<Option<String>, String> {
                    let stretched = model.copy.positions.iter().map(|p| *p * *scale).collect();
                    let suspect = change(&model.copy.with_positions(stretched));
                    let verdict = read(&suspect, &model.key)?.verdict;
                    let is_found = matches!(verdict, Verdict::Found | Verdict::Present);
                    Ok((!is_found).then(|| model.name.clone()))
                };
                let lost = cells.par_iter().map(lost).collect::<Result<Vec<_>, _>>()?;
                let lost: Vec<String> = lost.into_iter().flatten().collect();
                let (found, of) = (cells.len() - lost.len(), cells.len());
                let _ = writeln!(
                    text,
                    "{percent} %, {name} | {then} | {found} of {of} | {}",
                    lost.join(", ")
                );
            }
        }
    }
    Ok(())
}

/// Unmarked models whose rings are given the phases that rings of the same address have in all the others, marked ones.
fn carried_over(
    of_one_key: &[Marked],
    of_works: &[Marked],
    text: &mut String,
) -> Result<(), String> {
    let _ = writeln!(
        text,
        "\nRING carried over to | addresses in common | moved, RMS in % | ln p, verdict: one key | works"
    );
    for number in 0..of_one_key.len() {
        let host = &of_one_key[number].host;
        let others = |marked: &[Marked]| -> Vec<Mesh> {
            let others = marked
                .iter()
                .enumerate()
                .filter(|(other, _)| *other != number);
            others.map(|(_, model)| model.copy.clone()).collect()
        };
        let forged = carry_over(&others(of_one_key), host);
        let one = read(&forged.mesh, &of_one_key[number].key)?;
        let with_works = carry_over(&others(of_works), host).mesh;
        let works = of_works.iter().map(|work| read(&with_works, &work.key));
        let works = works.collect::<Result<Vec<_>, _>>()?;
        let best = works.iter().min_by(|a, b| ring(a).total_cmp(&ring(b)));
        let best = best.ok_or("no model")?;
        let _ = writeln!(
            text,
            "{} | {} | {:.3} | {:.0}, {:?} | {:.0}, {:?}",
            of_one_key[number].name,
            forged.num_common,
            100.0 * forged.rms_rel,
            ring(&one),
            one.verdict,
            ring(best),
            best.verdict
        );
    }
    Ok(())
}

fn ring(reading: &Extraction) -> f64 {
    ln_p_by(reading)(Carrier::Ring)
}

struct Forged {
    mesh: Mesh,
    num_common: usize,
    rms_rel: f64,
}

fn carry_over(from: &[Mesh], to: &Mesh) -> Forged {
    let mut offsets: BTreeMap<u64, f64> = BTreeMap::new();
    for mesh in from {
        for (address, ring) in alone(mesh) {
            offsets.entry(address).or_insert(ring.offset);
        }
    }
    let mut mesh = to.clone();
    let mut num_common = 0;
    for _ in 0..ROUNDS {
        let wanted = alone(&mesh).into_iter();
        let wanted: Vec<_> = wanted
            .filter_map(|(address, ring)| Some((ring, offsets.get(&address)?)))
            .collect();
        num_common = wanted.len();
        for (ring, offset) in wanted {
            let steps = (offset - ring.offset) / STEP;
            let missing = (steps - steps.round()) * STEP;
            mesh.positions[ring.vertex as usize] += ring.direction * missing;
        }
    }
    let moved = Distortion::between(&to.positions, &mesh.positions);
    Forged {
        rms_rel: moved.rms_rel,
        mesh,
        num_common,
    }
}

/// Rings whose address no other ring has.
fn alone(mesh: &Mesh) -> BTreeMap<u64, Ring> {
    let mut alone = BTreeMap::new();
    let mut met = BTreeMap::new();
    for ring in rings(mesh) {
        *met.entry(ring.by_connectivity).or_insert(0) += 1;
        alone.insert(ring.by_connectivity, ring);
    }
    alone.retain(|address, _| met[address] == 1);
    alone
}
