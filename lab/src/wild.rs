//! Files of one's own: what marking them does to each of their parts, and what the usual steps of a web pipeline leave of the mark.

use crate::opened::{self, Opened};
use crate::real::Tool;
use crate::seed::Seed;
use meshmark::internals::attack::{Step, step};
use meshmark::internals::geometry::Deformation;
use meshmark::internals::mesh::Mesh;
use meshmark::internals::scene::{Scene, to_glb};
use meshmark::{
    EmbedOptions, EmbedReport, Error, Key, Model, SceneError, Strength, Verdict, detect, embed,
};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Bits of the grid that each primitive gets in its own box, as Draco's encoders in glTF-Transform have it.
const GRID_BITS: u32 = 14;

/// The codec that orders vertices anew.
const DRACO: &str = "KHR_draco_mesh_compression";

/// What people's programs are told.
const TOOLS: [&str; 8] = [
    "glTF-Transform draco",
    "glTF-Transform meshopt",
    "glTF-Transform quantize",
    "glTF-Transform optimize",
    "glTF-Transform flatten",
    "glTF-Transform join",
    "gltfpack -cc",
    "gltfpack -si 0.5",
];

/// A column: what is done to the marked file.
enum Column {
    /// Every primitive in world space and in single precision, by itself.
    Joined,
    /// The same, each on a grid of its own.
    Grids,
    Attack(Step),
    Tool(Tool),
}

/// A table with a line for each file, of keys and payloads that come from a seed.
pub fn table(
    folder: &Path,
    strength: Strength,
    seed: &Seed,
    tools: Vec<Tool>,
) -> Result<String, String> {
    let paths = opened::paths(folder)?;
    let attacks = ["glTF quantize 14 bits", "simplify 50 %"].map(|name| step(name).ok_or(name));
    let mut columns = vec![Column::Joined, Column::Grids];
    for attack in attacks {
        columns.push(Column::Attack(attack?));
    }
    let chosen = tools
        .into_iter()
        .filter(|tool| TOOLS.contains(&&*tool.name));
    columns.extend(chosen.map(Column::Tool));

    let mut text = String::from(
        "| file | class | vertices | solid | ring | worst part, % | worst turn, degrees | turned over | s |",
    );
    columns.iter().for_each(|column| {
        let _ = write!(text, " {} |", column.name()); // strings take what is written
    });
    let _ = write!(text, "\n|---|---|{}", "--:|".repeat(7 + columns.len()));
    let lines: Vec<String> = paths
        .par_iter()
        .map(|path| {
            let name = path.strip_prefix(folder).unwrap_or(path).display();
            line(path, strength, seed, &columns).map_or_else(
                |code| format!("\n| {name} | {code} |{}", " |".repeat(7 + columns.len())),
                |(class, cells)| format!("\n| {name} | {class} | {} |", cells.join(" | ")),
            )
        })
        .collect();
    text.extend(lines);
    Ok(text)
}

impl Column {
    fn name(&self) -> String {
        match self {
            Column::Joined => "flatten + join".to_owned(),
            Column::Grids => format!("grids of {GRID_BITS} bits"),
            Column::Attack(step) => step.to_string(),
            Column::Tool(tool) => tool.name.clone(),
        }
    }

    /// What becomes of a marked file, as a `.glb`.
    fn apply(&self, marked: &Opened, mesh: &Mesh) -> Result<Vec<u8>, String> {
        match self {
            Column::Joined => Ok(to_glb(&Mesh::joined(marked.pieces()?))),
            Column::Grids => {
                let pieces = marked.pieces()?.into_iter().map(|piece| on_grid(&piece));
                Ok(to_glb(&Mesh::joined(pieces)))
            }
            Column::Attack(step) => Ok(to_glb(&step.apply(mesh, 1))),
            Column::Tool(_) if !marked.files.is_empty() => Err("no .glb".to_owned()),
            Column::Tool(tool) => tool.run(&marked.bytes),
        }
    }
}

/// A mesh on the grid of its own box.
fn on_grid(mesh: &Mesh) -> Mesh {
    let low = mesh
        .positions
        .iter()
        .copied()
        .reduce(|a, b| a.min(b))
        .unwrap_or_default();
    let high = mesh
        .positions
        .iter()
        .copied()
        .reduce(|a, b| a.max(b))
        .unwrap_or_default();
    let pitch = (high - low).max_element() / f64::from((1u32 << GRID_BITS) - 1);
    if pitch <= 0.0 {
        return mesh.clone();
    }
    let positions = mesh.positions.iter();
    mesh.with_positions(
        positions
            .map(|p| ((*p - low) / pitch).round() * pitch + low)
            .collect(),
    )
}

/// A file's class, which is what its mark holds, and the cells behind it; the code of what stopped it, if it cannot be marked.
fn line(
    path: &Path,
    strength: Strength,
    seed: &Seed,
    columns: &[Column],
) -> Result<(&'static str, Vec<String>), String> {
    let purpose = path.file_name().unwrap_or_default().to_string_lossy();
    let (key, payload) = (seed.key(&purpose, 0), seed.payload(&purpose));
    let host = Opened::new(path)?;
    let start = Instant::now();
    let options = EmbedOptions::default().with_strength(strength);
    let model = Model::new(&host.bytes).with_files(&host.files);
    let marking = embed(model, payload, &key, &options).map_err(|e: Error| e.code().to_owned())?;
    let seconds = start.elapsed().as_secs_f64();
    let mut files = host.files.clone();
    files.extend(marking.files);
    let marked = Opened {
        bytes: marking.model,
        files,
    };
    // Draco orders vertices anew, so what it wrote cannot be held against the host vertex by vertex: the report's figures are from before.
    let is_reordered = document_names(&host.bytes, DRACO);
    let num_turned_over = match is_reordered {
        true => "-".to_owned(),
        false => deformation(&host, &marked)?.num_turned_over.to_string(),
    };
    let after = marked.mesh()?;
    let report = &marking.report;
    let ln_p = |place: usize| {
        let carriers = &report.read_back.details().carriers;
        carriers.get(place).map_or(0.0, |carrier| carrier.ln_p)
    };
    let mut cells = vec![
        report.vertices.to_string(),
        format!("{:.0}", ln_p(0)),
        format!("{:.0}", ln_p(1)),
        format!("{:.2}", 100.0 * report.worst_part_rel),
        format!("{:.1}", report.worst_turn_degrees),
        num_turned_over,
        format!("{seconds:.1}"),
    ];
    for column in columns {
        let suspect = column.apply(&marked, &after);
        cells.push(suspect.map_or_else(|said| said, |bytes| found(&bytes, &key, report)));
    }
    let class = match (report.number, report.is_fragile) {
        (Some(_), false) => "payload",
        (None, false) => "presence",
        (Some(_), true) => "payload, fragile",
        (None, true) => "presence, fragile",
    };
    Ok((class, cells))
}

/// Whether a file says that it uses an extension.
fn document_names(bytes: &[u8], extension: &str) -> bool {
    bytes
        .windows(extension.len())
        .any(|window| window == extension.as_bytes())
}

/// What was done to a host.
fn deformation(host: &Opened, marked: &Opened) -> Result<Deformation, String> {
    let said = |error: SceneError| error.code().to_owned();
    let scene = Scene::gather(&host.document()?).map_err(said)?;
    let after = scene.positions_in(&marked.document()?).map_err(said)?;
    Ok(Deformation::between(&scene.mesh, &scene.parts(), &after))
}

/// What is said of a suspect: ln p, if what was embedded is found.
fn found(bytes: &[u8], key: &Key, report: &EmbedReport) -> String {
    match detect(bytes, key, None) {
        Err(error) => error.code().to_owned(),
        Ok(answer) if !matches!(answer.verdict, Verdict::Found | Verdict::Present) => {
            "lost".to_owned()
        }
        Ok(answer) if report.number.is_some() && answer.verdict == Verdict::Present => {
            format!("present, {:.0}", answer.details().ln_p)
        }
        Ok(answer) if answer.number != report.number => "another".to_owned(),
        Ok(answer) => format!("{:.0}", answer.details().ln_p),
    }
}
