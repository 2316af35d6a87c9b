//! The grid: every row of the tables, once. Strengths are in `main`, models in `models`.
//!
//! Definitions and parameters of the LIRIS benchmark (Wang et al. 2010) where it has them; see `meshmark::attack`.

use crate::case::Case;
use glam::DVec3;
use meshmark::attack::{
    average, catmull_clark, crop, loop_scheme, midpoint, noise, quantize, remesh, reorder,
    resample, simplify, smooth, smooth_inside, sqrt3, taubin, warp,
};
use meshmark::mesh::Mesh;

/// Which table a row is in.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// Nothing of this key is in it: a row in which something is found is a failure.
    Null,
    /// What happens to models.
    Usual,
    /// What somebody does who knows that there is a mark.
    Deliberate,
}

pub struct Row {
    pub name: String,
    pub kind: Kind,
    pub is_quick: bool,
    /// The suspect, of a case, its marked mesh, and a seed.
    pub suspect: Suspect,
}

type Suspect = Box<dyn Fn(&Case, &Mesh, u64) -> Result<Mesh, String> + Send + Sync>;

/// A row whose suspect is made of the marked mesh alone.
fn shape(
    name: impl Into<String>,
    is_quick: bool,
    attack: impl Fn(&Mesh, u64) -> Mesh + Send + Sync + 'static,
) -> Row {
    Row {
        name: name.into(),
        kind: Kind::Usual,
        is_quick,
        suspect: Box::new(move |_, marked, seed| Ok(attack(marked, seed))),
    }
}

fn row(
    name: impl Into<String>,
    kind: Kind,
    is_quick: bool,
    suspect: impl Fn(&Case, &Mesh, u64) -> Result<Mesh, String> + Send + Sync + 'static,
) -> Row {
    Row {
        name: name.into(),
        kind,
        is_quick,
        suspect: Box::new(suspect),
    }
}

/// Rows that differ in a number; `quick` are those of the short grid.
fn series(
    name: &str,
    unit: &str,
    numbers: &[f64],
    quick: &[f64],
    attack: fn(&Mesh, f64, u64) -> Mesh,
) -> Vec<Row> {
    let row = |&x: &f64| {
        let name = format!("{name} {x}{unit}");
        shape(name, quick.contains(&x), move |m, seed| attack(m, x, seed))
    };
    numbers.iter().map(row).collect()
}

/// Every row, in the tables' order.
pub fn rows() -> Vec<Row> {
    use Kind::{Deliberate, Null, Usual};
    [
        vec![
            row("unmarked", Null, true, |case, _, _| Ok(case.host.clone())),
            row("wrong key", Null, true, |case, _, _| case.by_another(1)),
            shape("none", true, |m, _| m.clone()),
            shape("reorder", false, reorder),
        ],
        series(
            "noise",
            " %",
            &[0.05, 0.1, 0.3, 0.5],
            &[0.1, 0.3],
            |m, x, seed| noise(m, x / 100.0, seed),
        ),
        series(
            "Laplacian",
            "",
            &[5.0, 10.0, 20.0, 30.0, 50.0],
            &[10.0, 50.0],
            |m, x, _| smooth_inside(m, 0.1, x as u32),
        ),
        series(
            "Laplacian, borders too,",
            "",
            &[10.0, 50.0],
            &[],
            |m, x, _| smooth(m, 0.1, x as u32),
        ),
        series("Taubin", "", &[20.0], &[], |m, x, _| {
            taubin(m, 0.5, -0.53, x as u32)
        }),
        series(
            "quantize",
            " bits",
            &[14.0, 12.0, 11.0, 10.0, 9.0, 8.0, 7.0],
            &[11.0, 9.0],
            |m, x, _| quantize(m, x as u32),
        ),
        series(
            "simplify",
            " %",
            &[10.0, 30.0, 50.0, 70.0, 90.0, 95.0, 97.5],
            &[30.0, 50.0, 90.0],
            |m, x, _| simplify(m, x / 100.0),
        ),
        vec![
            shape("midpoint", true, |m, _| midpoint(m)),
            shape("square root of 3", false, |m, _| sqrt3(m)),
            shape("Loop", false, |m, _| loop_scheme(m)),
        ],
        series("MeshSmooth", "", &[1.0, 2.0], &[], |m, x, _| {
            catmull_clark(m, x as u32)
        }),
        vec![
            shape("isotropic remeshing 1 %", true, |m, _| remesh(m, 0.01)),
            shape("resampled distance 0.8 %", true, |m, _| resample(m, 0.008)),
        ],
        series(
            "crop",
            " %",
            &[10.0, 30.0, 50.0],
            &[30.0, 50.0],
            |m, x, seed| crop(m, x / 100.0, seed),
        ),
        vec![
            shape("scale 1.1 x 1 x 0.95", false, |m, _| {
                let scale = DVec3::new(1.1, 1.0, 0.95);
                m.with_positions(m.positions.iter().map(|p| *p * scale).collect())
            }),
            shape("simplify 50 %, quantize 12 bits", false, |m, _| {
                quantize(&simplify(m, 0.5), 12)
            }),
            shape(
                "crop 30 %, simplify 50 %, quantize 10 bits",
                false,
                |m, seed| quantize(&simplify(&crop(m, 0.3, seed), 0.5), 10),
            ),
            row("second mark", Usual, true, |case, marked, _| {
                case.marked_again(marked, 1)
            }),
            row(
                "second mark, simplify 50 %",
                Usual,
                false,
                |case, marked, _| Ok(simplify(&case.marked_again(marked, 1)?, 0.5)),
            ),
            row("second and third mark", Usual, true, |case, marked, _| {
                case.marked_again(&case.marked_again(marked, 1)?, 2)
            }),
        ],
        warps(),
        vec![
            row(
                "average with the original",
                Deliberate,
                true,
                |case, marked, _| averaged(marked, case.host.clone()),
            ),
            row(
                "average with a copy under another key",
                Deliberate,
                false,
                |case, marked, _| averaged(marked, case.by_another(1)?),
            ),
            row(
                "average with a copy of another payload",
                Deliberate,
                false,
                |case, marked, _| averaged(marked, case.with_another_payload()?),
            ),
        ],
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Smooth deformations, as strong as the mark and stronger.
fn warps() -> Vec<Row> {
    let pairs =
        [5.0, 10.0, 20.0].map(|wavelength| [1.0, 2.0, 4.0].map(|times| (wavelength, times)));
    let warp = |(wavelength, times): (f64, f64)| {
        row(
            format!("warp of wavelength {wavelength} %, {times} x the mark's RMS"),
            Kind::Deliberate,
            (wavelength, times) == (10.0, 2.0),
            move |case, marked, seed| {
                Ok(warp(
                    marked,
                    wavelength / 100.0,
                    times * case.rms_rel(),
                    seed,
                ))
            },
        )
    };
    pairs.into_iter().flatten().map(warp).collect()
}

fn averaged(marked: &Mesh, other: Mesh) -> Result<Mesh, String> {
    if marked.triangles != other.triangles {
        return Err("the copies' vertices do not correspond".to_owned());
    }
    Ok(average(&[marked.clone(), other]))
}
