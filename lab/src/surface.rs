//! Suspects that look as the marked model does, or nearly so, and are written otherwise: what is there twice, shells, what lies inside, what is
//! strewn. Each stands beside the same suspect without that.

use crate::case::Case;
use crate::cell::ln_p_by;
use crate::models::{Class, Model, Size};
use crate::seed::Seed;
use meshmark::internals::attack::{
    ball_within, both_sides, bridged_hull, copies, hull, midpoint, needles, remesh, similarity,
    simplify, stray,
};
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::to_glb;
use meshmark::{Carrier, Strength, Verdict, detect};
use rayon::prelude::*;
use std::fmt::Write;

type Made = Box<dyn Fn(&Mesh, u64) -> Mesh + Send + Sync>;
type Then = fn(&Mesh) -> Mesh;

/// How a suspect is made, and what is done to it and to the plain one alike.
struct Row {
    name: String,
    make: Made,
    then: Then,
}

fn as_it_is(mesh: &Mesh) -> Mesh {
    mesh.clone()
}

fn halved(mesh: &Mesh) -> Mesh {
    simplify(mesh, 0.5)
}

fn to_a_third(mesh: &Mesh) -> Mesh {
    simplify(mesh, 0.7)
}

fn remeshed(mesh: &Mesh) -> Mesh {
    remesh(mesh, 0.01)
}

fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    let mut add = |name: String, then: Then, make: Made| rows.push(Row { name, make, then });
    add(
        "both sides".to_owned(),
        as_it_is,
        Box::new(|m, _| both_sides(m)),
    );
    add(
        "both sides, halved".to_owned(),
        halved,
        Box::new(|m, _| both_sides(m)),
    );
    for share in [1.0, 5.0, 50.0, 100.0] {
        let name = format!("copies of {share} %");
        let make: Made = Box::new(move |m, seed| copies(m, share / 100.0, 1, 0.0, seed));
        add(name, as_it_is, make);
    }
    add(
        "copies, each three times".to_owned(),
        as_it_is,
        Box::new(|m, seed| copies(m, 1.0, 2, 0.0, seed)),
    );
    add(
        "copies of 50 %, halved".to_owned(),
        halved,
        Box::new(|m, seed| copies(m, 0.5, 1, 0.0, seed)),
    );
    add(
        "copies 1e-5 away".to_owned(),
        as_it_is,
        Box::new(|m, seed| copies(m, 1.0, 1, 1e-5, seed)),
    );
    add(
        "copies of 50 % 1e-5 away".to_owned(),
        as_it_is,
        Box::new(|m, seed| copies(m, 0.5, 1, 1e-5, seed)),
    );
    add(
        "split at midpoints and copied".to_owned(),
        as_it_is,
        Box::new(|m, seed| copies(&midpoint(m), 1.0, 1, 0.0, seed)),
    );
    add(
        "beside its own split".to_owned(),
        as_it_is,
        Box::new(|m, _| Mesh::joined([m.clone(), both_sides(&midpoint(m))])),
    );
    for share in [5.0, 100.0] {
        let name = format!("needles at {share} %");
        add(
            name,
            as_it_is,
            Box::new(move |m, seed| needles(m, share / 100.0, seed)),
        );
    }
    for distance in [0.1, 0.5, 2.0, 5.0, -0.5, -2.0] {
        let name = format!("hull at {distance} %");
        add(
            name.clone(),
            as_it_is,
            Box::new(move |m, _| hull(m, distance / 100.0)),
        );
        add(
            format!("{name}, halved"),
            halved,
            Box::new(move |m, _| hull(m, distance / 100.0)),
        );
    }
    for distance in [0.5, -2.0] {
        let name = format!("hull at {distance} %, remeshed");
        add(
            name,
            remeshed,
            Box::new(move |m, _| hull(m, distance / 100.0)),
        );
    }
    for distance in [0.5, -2.0] {
        let name = format!("hull at {distance} %, on a bridge");
        add(
            name.clone(),
            as_it_is,
            Box::new(move |m, _| bridged_hull(m, distance / 100.0)),
        );
        add(
            format!("{name}, halved"),
            halved,
            Box::new(move |m, _| bridged_hull(m, distance / 100.0)),
        );
    }
    add(
        "ball within, to a third".to_owned(),
        to_a_third,
        Box::new(|m, _| ball_within(m, 0.05)),
    );
    for away in [10.0, 100.0] {
        add(
            format!("stray at {away} diagonals"),
            as_it_is,
            Box::new(move |m, _| stray(m, away)),
        );
        add(
            format!("stray at {away} diagonals, halved"),
            halved,
            Box::new(move |m, _| stray(m, away)),
        );
    }
    rows
}

/// SOLID's and RING's ln p, and whether the payload is found.
struct Read {
    is_found: bool,
    solid: f64,
    ring: f64,
}

fn read(case: &Case, suspect: &Mesh, purpose: &str) -> Result<Read, String> {
    let moved = similarity(suspect, case.seed.number(purpose, 1));
    let read = detect(&to_glb(&moved), &case.key, None).map_err(|error| error.to_string())?;
    let of = ln_p_by(&read);
    Ok(Read {
        is_found: read.verdict == Verdict::Found && read.number == Some(case.payload.number()),
        solid: of(Carrier::Solid),
        ring: of(Carrier::Ring),
    })
}

/// Every row of every plain model at strong and balanced.
pub fn table(models: Vec<Model>, seed: &Seed) -> Result<String, String> {
    let is_plain = |model: &&Model| model.class == Class::Plain && model.size <= Size::Usual;
    let models: Vec<&Model> = models.iter().filter(is_plain).collect();
    let mut text = format!("seed {}\n", seed.number);
    for strength in [
        ("strong", Strength::STRONG),
        ("balanced", Strength::BALANCED),
    ] {
        let cases: Vec<Case> = models
            .par_iter()
            .map(|model| Case::new(model, strength, 0, seed))
            .collect::<Result<_, _>>()?;
        let rows = rows();
        let _ = writeln!(
            text,
            "\n{} | plain found | found | lost, of those (SOLID/RING plain -> here)",
            strength.0
        );
        for row in &rows {
            let one = |case: &Case| -> Result<Option<(String, [Read; 2])>, String> {
                let Ok(marked) = &case.marked else {
                    return Ok(None);
                };
                let purpose = format!("{}, {}", case.purpose, row.name);
                let number = seed.number(&purpose, 0);
                let plain = read(case, &(row.then)(&marked.mesh), &purpose)?;
                let made = read(
                    case,
                    &(row.then)(&(row.make)(&marked.mesh, number)),
                    &purpose,
                )?;
                Ok(Some((case.model.name.clone(), [plain, made])))
            };
            let cells = cases.par_iter().map(one).collect::<Result<Vec<_>, _>>()?;
            let cells: Vec<_> = cells.into_iter().flatten().collect();
            let plain = cells.iter().filter(|(_, [plain, _])| plain.is_found);
            let lost: Vec<String> = plain
                .clone()
                .filter(|(_, [_, made])| !made.is_found)
                .map(|(name, [plain, made])| {
                    format!(
                        "{name} {:.0}/{:.0} -> {:.0}/{:.0}",
                        plain.solid, plain.ring, made.solid, made.ring
                    )
                })
                .collect();
            let num_plain = plain.count();
            let num_found = cells.iter().filter(|(_, [_, made])| made.is_found).count();
            let line = format!(
                "{} | {num_plain} | {num_found} | {}",
                row.name,
                lost.join(", ")
            );
            eprintln!("{line}");
            let _ = writeln!(text, "{line}");
        }
    }
    Ok(text)
}
