//! One row of one marked model: the suspect made, read, and what it cost whoever made it.

use crate::baseline;
use crate::case::Case;
use crate::grid::{Kind, Row, Suspect};
use meshmark::internals::attack::{chain, similarity};
use meshmark::internals::geometry::Quality;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::to_glb;
use meshmark::{Carrier, Extraction, Payload, Verdict, extract, measure};
use serde::{Deserialize, Serialize};

/// What became of a mark in a row.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Cell {
    pub model: String,
    pub strength: String,
    pub copy: u32,
    pub row: String,
    pub outcome: Result<Outcome, String>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Outcome {
    /// Found, with the payload that was embedded.
    pub is_decoded: bool,
    /// Natural logarithm of the bound, every choice charged.
    pub ln_p: f64,
    /// The same of each carrier alone.
    pub solid: f64,
    pub ring: f64,
    /// Triangles that are left, or that there are now, as a fraction of the marked model's.
    pub triangles: f64,
    /// What the attacker paid: from the attacked model to the marked one.
    pub quality: Quality,
    /// Wrong bits of the baseline after the same attack, as a fraction; where there is one.
    pub baseline: Option<f64>,
}

/// What a carrier says in a reading: the bound, what it charges itself paid.
pub fn ln_p_by(read: &Extraction) -> impl Fn(Carrier) -> f64 {
    move |carrier| {
        let mut carriers = read.details().carriers.iter();
        let own = carriers.find(|own| own.name == carrier);
        own.map_or(0.0, |own| own.ln_p)
    }
}

impl Outcome {
    fn new(read: &Extraction, payload: Payload, marked: &Mesh, suspect: &Mesh) -> Outcome {
        let of = ln_p_by(read);
        Outcome {
            is_decoded: read.verdict == Verdict::Found && read.number == Some(payload.number()),
            ln_p: read.details().ln_p,
            solid: of(Carrier::Solid),
            ring: of(Carrier::Ring),
            triangles: suspect.triangles.len() as f64 / marked.triangles.len() as f64,
            quality: Quality::between(marked, suspect),
            baseline: None,
        }
    }

    /// Wrong bits of the payload: none, or, where it is not read, as many as a guess has.
    pub fn ber(&self) -> f64 {
        if self.is_decoded { 0.0 } else { 0.5 }
    }
}

/// Makes the suspect of a row and reads it.
pub fn cell(case: &Case, row: &Row) -> Cell {
    Cell {
        model: case.model.name.clone(),
        strength: case.strength_name.to_owned(),
        copy: case.copy,
        row: row.name.clone(),
        outcome: outcome(case, row),
    }
}

fn outcome(case: &Case, row: &Row) -> Result<Outcome, String> {
    let purpose = format!("{}, {}", case.purpose, row.name);
    let reference = match &case.marked {
        Ok(marked) => &marked.mesh,
        // An unmarked model is there even where it cannot be marked.
        Err(_) if row.kind == Kind::Null => &case.host,
        Err(error) => return Err(format!("not marked: {error}")),
    };
    let seed = case.seed.number(&purpose, 0);
    let suspect = row.suspect(case, reference, seed)?;
    let moved = similarity(&suspect, case.seed.number(&purpose, 1));
    let evidence = measure(&to_glb(&moved)).map_err(|error| error.to_string())?;
    let read = extract(&evidence, &case.key);
    Ok(Outcome {
        baseline: baseline_after(case, row, seed),
        ..Outcome::new(&read, case.payload, reference, &suspect)
    })
}

/// Wrong bits of the baseline in the same host, after the same attack.
fn baseline_after(case: &Case, row: &Row, seed: u64) -> Option<f64> {
    let (Suspect::Chain(steps), Some((marked, bits))) = (&row.make, case.baseline()) else {
        return None;
    };
    let read = baseline::extract(&chain(marked, steps, seed), bits.len());
    let wrong = bits.iter().zip(&read).filter(|(a, b)| a != b).count();
    Some(wrong as f64 / bits.len() as f64)
}
