//! LOCAL beside SOLID and RING: what it takes from them, and what is found with it in pieces that were cut out and then changed, at random
//! planes, with keys drawn for the table; and wrong keys on suspects that are made to break its bound.

use crate::cell::ln_p_by;
use crate::models::{Class, Model, gathered};
use crate::seed::Seed;
use glam::DVec3;
use meshmark::internals::attack::{
    crop, mirror, noise, quantize, remesh, resample, similarity, simplify, smooth_inside,
};
use meshmark::internals::carrier::local::Measurement;
use meshmark::internals::code::Codeword;
use meshmark::internals::detection::{LN_P_FOUND, Statistic};
use meshmark::internals::geometry::diagonal;
use meshmark::internals::mesh::{Mesh, shapes};
use meshmark::internals::progress::ignore;
use meshmark::{Carrier, EmbedOptions, Extraction, Key, Strength, embed};
use rayon::prelude::*;
use std::fmt::Write;
use std::time::Instant;

/// Planes for each model and row.
const CUTS: u64 = 3;
/// Models have as many vertices at least.
const FEWEST_VERTICES: usize = 2500;
/// What the judge charges LOCAL: it has a sixteenth of the probability.
const LN_LOCAL: f64 = 2.772_588_722_239_781; // ln 16

type Change = fn(&Mesh, u64) -> Mesh;

/// How much is cut away, and what then happens.
const ROWS: [(&str, f64, Change); 12] = [
    ("whole, as it is", 0.0, |m, _| m.clone()),
    ("half", 0.5, |m, _| m.clone()),
    ("half, then simplified to half", 0.5, |m, _| {
        simplify(m, 0.5)
    }),
    ("half, then simplified to 10 %", 0.5, |m, _| {
        simplify(m, 0.9)
    }),
    ("half, then remeshed", 0.5, |m, _| remesh(m, 0.01)),
    ("half, then by a distance field", 0.5, |m, _| {
        resample(m, 0.008)
    }),
    ("half, then noise of 0.2 %", 0.5, |m, seed| {
        noise(m, 0.002, seed)
    }),
    ("half, then 10 bits", 0.5, |m, _| quantize(m, 10)),
    ("half, then Laplacian 10", 0.5, |m, _| {
        smooth_inside(m, 0.1, 10)
    }),
    ("70 %, then simplified to half and 10 bits", 0.3, |m, _| {
        quantize(&simplify(m, 0.5), 10)
    }),
    ("a quarter, then simplified to half", 0.75, |m, _| {
        simplify(m, 0.5)
    }),
    ("a quarter, then remeshed", 0.75, |m, _| remesh(m, 0.01)),
];

/// The tables, as Markdown.
pub fn tables(
    mut models: Vec<Model>,
    strength: Strength,
    seed: &Seed,
    num_keys: u64,
) -> Result<String, String> {
    models.retain(|model| model.class == Class::Plain);
    let mut text = format!(
        "SOLID, LOCAL and RING together, strength {:.4} % of the diagonal, seed {}. Three random planes for each model, then any similarity. \
         Found is a bound of 1e-9 at most, all charges paid.\n\n",
        100.0 * strength.rms_rel(),
        seed.number
    );
    let marked: Vec<Result<Option<Marked>, String>> = models
        .into_par_iter()
        .map(|model| Marked::new(&model, strength, seed))
        .collect();
    let marked = marked.into_iter().filter_map(Result::transpose);
    let marked: Vec<Marked> = marked.collect::<Result<_, _>>()?;
    text.push_str(
        "ln p as it is: of SOLID and of RING without LOCAL, and of all three together.\n\n\
         | model | vertices | SOLID alone | beside | RING alone | beside | LOCAL | RMS, % | s |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for model in &marked {
        let [alone, beside] = [&model.without, &model.with].map(ln_p_by);
        let line = format!(
            "| {} | {} | {:.0} | {:.0} | {:.0} | {:.0} | {:.0} | {:.3} | {:.1} |",
            model.name,
            model.mesh.positions.len(),
            alone(Carrier::Solid),
            beside(Carrier::Solid),
            alone(Carrier::Ring),
            beside(Carrier::Ring),
            beside(Carrier::Local),
            100.0 * model.rms_rel,
            model.seconds
        );
        let _ = writeln!(text, "{line}");
        eprintln!("{line}");
    }
    let names = marked.iter().map(|model| model.name.as_str());
    let _ = writeln!(
        text,
        "\nFound by LOCAL, of three planes.\n\n| attack | {} | cells | models with two or more |\n|---|{}--:|--:|",
        names.collect::<Vec<_>>().join(" | "),
        "--:|".repeat(marked.len())
    );
    for (row, (name, cut, change)) in ROWS.into_iter().enumerate() {
        let found: Vec<usize> = marked
            .par_iter()
            .map(|model| {
                let is_found = |number| model.is_found(cut, change, seed.number(name, number));
                let numbers = (0..CUTS).map(|number| number + CUTS * row as u64);
                numbers.filter(|number| is_found(*number)).count()
            })
            .collect();
        let each: Vec<String> = found.iter().map(usize::to_string).collect();
        let line = format!(
            "| {name} | {} | {} of {} | {} of {} |",
            each.join(" | "),
            found.iter().sum::<usize>(),
            CUTS as usize * marked.len(),
            found.iter().filter(|found| **found >= 2).count(),
            marked.len(),
        );
        let _ = writeln!(text, "{line}");
        eprintln!("{line}");
    }
    text.push_str(&wrong_keys(&marked, seed, num_keys));
    Ok(text)
}

/// A model and its mark.
struct Marked {
    name: String,
    mesh: Mesh,
    key: Key,
    rms_rel: f64,
    seconds: f64,
    /// What is read of it as it is, marked without LOCAL and with it.
    without: Extraction,
    with: Extraction,
}

impl Marked {
    /// `None` for a model with few vertices.
    fn new(model: &Model, strength: Strength, seed: &Seed) -> Result<Option<Marked>, String> {
        if gathered(&model.bytes)?.positions.len() < FEWEST_VERTICES {
            return Ok(None);
        }
        let (key, payload) = (seed.key(&model.name, 0), seed.payload(&model.name));
        let options = EmbedOptions::default().with_strength(strength);
        let with_all = options.clone().with_carriers(Carrier::ALL);
        let embed = |options: &EmbedOptions| {
            let embedded = embed(&model.bytes, payload, &key, options);
            embedded.map_err(|error| format!("{}: {error}", model.name))
        };
        let without = embed(&options)?.report.read_back;
        let start = Instant::now();
        let embedded = embed(&with_all)?;
        for warning in &embedded.report.warnings {
            eprintln!("{}: {warning}", model.name);
        }
        Ok(Some(Marked {
            name: model.name.clone(),
            mesh: gathered(&embedded.model)?,
            rms_rel: embedded.report.rms_rel,
            seconds: start.elapsed().as_secs_f64(),
            with: embedded.report.read_back,
            without,
            key,
        }))
    }

    /// Whether LOCAL alone says that a piece is the owner's: what the judge hears beside that is not looked at.
    fn is_found(&self, cut: f64, change: Change, seed: u64) -> bool {
        let piece = match cut {
            0.0 => self.mesh.clone(),
            cut => crop(&self.mesh, cut, seed),
        };
        let suspect = similarity(&change(&piece, seed), seed);
        ln_p(&Measurement::new(&suspect), &self.key) + LN_LOCAL <= LN_P_FOUND
    }
}

/// The bound of the best way of reading, the carrier's own choices charged.
fn ln_p(measurement: &Measurement, key: &Key) -> f64 {
    let reading = measurement.read(key, &mut ignore).unwrap_or_default();
    let charged = reading.hypotheses.iter().map(|hypothesis| {
        let symbols = hypothesis.symbols.iter();
        let signed = symbols.map(|soft| {
            (
                soft.value * Codeword::Presence.sign(soft.symbol),
                soft.weight,
            )
        });
        Statistic::new(signed).ln_p() + hypothesis.ln_num_tests
    });
    charged.fold(0.0, f64::min)
}

/// Wrong keys: how often a bound is at most e^-n, beside the most that the proof allows on average.
fn wrong_keys(marked: &[Marked], seed: &Seed, num_keys: u64) -> String {
    let mut suspects: Vec<(String, Mesh)> = Vec::new();
    for model in marked.iter().take(2) {
        let piece = simplify(&crop(&model.mesh, 0.5, 1), 0.5);
        suspects.push((format!("half of {}, simplified", model.name), piece));
    }
    suspects.extend(crafted());
    let mut text = format!(
        "\nWrong keys, {num_keys} on each suspect: how many have a bound of e^-n or less, and the most that the proof allows on average.\n\n\
         | suspect | places | n = 1 | 2 | 3 | 4 | 6 | least ln p |\n|---|--:|--:|--:|--:|--:|--:|--:|\n"
    );
    for (name, mesh) in suspects {
        let measurement = Measurement::new(&mesh);
        let of_key = |number| ln_p(&measurement, &seed.key(&name, number));
        let all: Vec<f64> = (0..num_keys).into_par_iter().map(of_key).collect();
        let tail = |n: f64| all.iter().filter(|ln_p| **ln_p <= -n).count();
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {} | {} | {:.1} |",
            measurement.num_places(),
            tail(1.0),
            tail(2.0),
            tail(3.0),
            tail(4.0),
            tail(6.0),
            all.iter().copied().fold(0.0, f64::min)
        );
        eprintln!("{name}: {} of {num_keys} at e^-3", tail(3.0));
    }
    // e^-n.
    let allowed = [0.3679, 0.1353, 0.0498, 0.0183, 0.0025];
    let allowed = allowed.map(|share| format!("{:.1}", num_keys as f64 * share));
    let _ = writeln!(text, "| *allowed* | | {} | |", allowed.join(" | "));
    text
}

/// Suspects that repeat one place.
fn crafted() -> Vec<(String, Mesh)> {
    let at = |mesh: &Mesh, shift: DVec3| {
        mesh.with_positions(mesh.positions.iter().map(|p| *p + shift).collect())
    };
    let grid = |mesh: &Mesh, side: u32, pitch: f64| {
        let numbers = 0..side * side * side;
        Mesh::joined(numbers.map(|n| {
            let [i, j, k] = [n / side / side, n / side % side, n % side].map(f64::from);
            at(mesh, DVec3::new(i, j, k) * pitch)
        }))
    };
    let ball = shapes::icosphere(2);
    let rock = shapes::low_poly();
    let size = diagonal(&rock.positions);
    let twin = mirror(&rock);
    vec![
        ("a lattice of balls".to_owned(), grid(&ball, 4, 3.0)),
        (
            "a creature 216 times".to_owned(),
            grid(&rock, 6, 1.2 * size),
        ),
        (
            "mirrored twins".to_owned(),
            Mesh::joined([rock.clone(), at(&twin, DVec3::X * 2.0 * size)]),
        ),
    ]
}
