//! The grid: every row of the tables, once. What attacks there are, and how strong, is in `meshmark::internals::attack`; here is what needs
//! a key, and what is done one after another.

use crate::case::Case;
use crate::models::gathered;
use crate::real::Tool;
use meshmark::internals::attack::{CATALOGUE, Family, Step, average, chain, step, warp};
use meshmark::internals::mesh::Mesh;

/// What a row is for.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// Nothing of this key is in it: a row in which something is found is a failure.
    Null,
    /// What happens to models.
    Usual,
    /// What somebody does who knows that there is a mark.
    Deliberate,
    /// Programs that people have.
    Real,
}

pub struct Row {
    pub name: String,
    pub kind: Kind,
    pub make: Suspect,
}

type Make = Box<dyn Fn(&Case, &Mesh, u64) -> Result<Mesh, String> + Send + Sync>;

/// How a suspect is made of a marked mesh.
pub enum Suspect {
    /// By attacks, one after another.
    Chain(Vec<Step>),
    /// With keys, or with what else a case knows.
    Keyed(Make),
    /// By a program, from the marked file.
    Tool(Tool),
}

/// Attacks one after another.
const CHAINS: [&[&str]; 4] = [
    &["simplify 50 %", "glTF quantize 12 bits"],
    &["crop 30 %", "simplify 50 %", "glTF quantize 10 bits"],
    &["noise 0.1 %", "simplify 50 %", "Laplacian 10"],
    &["isotropic remeshing 1 %", "quantize 11 bits"],
];

/// Rows of the short grid.
pub const QUICK: [&str; 20] = [
    "unmarked",
    "wrong key",
    "none",
    "noise 0.1 %",
    "noise 0.3 %",
    "Laplacian 10",
    "Laplacian 50",
    "quantize 11 bits",
    "quantize 9 bits",
    "simplify 30 %",
    "simplify 50 %",
    "simplify 90 %",
    "midpoint",
    "crop 30 %",
    "crop 50 %",
    "isotropic remeshing 1 %",
    "resampled distance 0.8 %",
    "second mark",
    "second and third mark",
    "average of two buyers' copies",
];

impl Row {
    fn chain(kind: Kind, steps: Vec<Step>) -> Row {
        let names: Vec<String> = steps.iter().map(Step::to_string).collect();
        Row {
            name: names.join(", "),
            kind,
            make: Suspect::Chain(steps),
        }
    }

    fn keyed(
        name: impl Into<String>,
        kind: Kind,
        make: impl Fn(&Case, &Mesh, u64) -> Result<Mesh, String> + Send + Sync + 'static,
    ) -> Row {
        Row {
            name: name.into(),
            kind,
            make: Suspect::Keyed(Box::new(make)),
        }
    }

    /// A row of a program.
    pub fn tool(tool: Tool) -> Row {
        Row {
            name: tool.name.clone(),
            kind: Kind::Real,
            make: Suspect::Tool(tool),
        }
    }

    pub fn is_quick(&self) -> bool {
        QUICK.contains(&&*self.name)
    }

    /// The suspect, of a case's marked mesh.
    pub fn suspect(&self, case: &Case, marked: &Mesh, seed: u64) -> Result<Mesh, String> {
        match &self.make {
            Suspect::Chain(steps) => Ok(chain(marked, steps, seed)),
            Suspect::Keyed(make) => make(case, marked, seed),
            Suspect::Tool(tool) => {
                let file = case.marked.as_ref().map_err(Clone::clone)?;
                gathered(&tool.run(&file.bytes)?)
            }
        }
    }
}

/// Every row that needs no other program, in the tables' order.
pub fn rows() -> Vec<Row> {
    use Kind::{Deliberate, Null, Usual};
    let catalogue = CATALOGUE.iter().flat_map(|attack| {
        let kind = match attack.family {
            Family::Deliberate => Deliberate,
            _ => Usual,
        };
        attack.steps().map(move |step| Row::chain(kind, vec![step]))
    });
    let chains = CHAINS.iter().map(|names| {
        let steps = names
            .iter()
            .map(|name| step(name).expect("names of the catalogue"));
        Row::chain(Deliberate, steps.collect())
    });
    let mut rows = vec![
        Row::keyed("unmarked", Null, |case, _, _| Ok(case.host.clone())),
        Row::keyed("wrong key", Null, |case, _, _| case.by_another(1)),
        Row::keyed("none", Usual, |_, marked, _| Ok(marked.clone())),
    ];
    rows.extend(catalogue);
    rows.extend(chains);
    rows.extend([
        Row::keyed("second mark", Deliberate, |case, marked, _| {
            case.marked_again(marked, 1)
        }),
        Row::keyed(
            "second mark, simplify 50 %",
            Deliberate,
            |case, marked, seed| {
                let simplify = step("simplify 50 %").expect("a name of the catalogue");
                Ok(simplify.apply(&case.marked_again(marked, 1)?, seed))
            },
        ),
        Row::keyed("second and third mark", Deliberate, |case, marked, _| {
            case.marked_again(&case.marked_again(marked, 1)?, 2)
        }),
        Row::keyed(
            "average with the original",
            Deliberate,
            |case, marked, _| averaged(vec![marked.clone(), case.host.clone()]),
        ),
        Row::keyed(
            "average with a copy under another key",
            Deliberate,
            |case, marked, _| averaged(vec![marked.clone(), case.by_another(1)?]),
        ),
    ]);
    rows.extend([("two", 1), ("five", 4)].map(|(name, others)| {
        let name = format!("average of {name} buyers' copies");
        Row::keyed(name, Deliberate, move |case, marked, _| {
            let copies = (1..=others).map(|number| case.of_buyer(number));
            let copies = [Ok(marked.clone())].into_iter().chain(copies);
            averaged(copies.collect::<Result<_, _>>()?)
        })
    }));
    rows.extend(warps());
    rows
}

/// Smooth deformations, as strong as the mark and stronger.
fn warps() -> impl Iterator<Item = Row> {
    let pairs =
        [5.0, 10.0, 20.0].map(|wavelength| [1.0, 2.0, 4.0].map(|times| (wavelength, times)));
    pairs.into_iter().flatten().map(|(wavelength, times)| {
        let name = format!("warp of wavelength {wavelength} %, {times} x the mark's RMS");
        Row::keyed(name, Kind::Deliberate, move |case, marked, seed| {
            Ok(warp(
                marked,
                wavelength / 100.0,
                times * case.rms_rel(),
                seed,
            ))
        })
    })
}

fn averaged(copies: Vec<Mesh>) -> Result<Mesh, String> {
    if copies
        .iter()
        .any(|copy| copy.triangles != copies[0].triangles)
    {
        return Err("the copies' vertices do not correspond".to_owned());
    }
    Ok(average(&copies))
}
