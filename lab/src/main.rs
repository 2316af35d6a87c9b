//! The robustness lab: one grid of attacks x models x strengths, and the table of what the mark survived; and the seed paper's study.
//!
//! Everything random comes from one seed, which the system draws and the table states; `--seed` runs a table again.

#[allow(dead_code)] // not in a table yet
mod baseline;
mod case;
mod false_positives;
mod grid;
mod measure;
mod models;
mod report;
mod seed;
mod study;

use clap::Parser;
use meshmark::Strength;
use seed::Seed;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Measures what the mark survives, and writes docs/ROBUSTNESS.md.
#[derive(Parser)]
#[command(name = "cargo xtask lab")]
struct Arguments {
    /// Fewer rows, models and strengths.
    #[arg(long)]
    quick: bool,
    /// A folder of .glb and .obj files. Default: ../shared/models, where it exists.
    #[arg(long)]
    models: Option<PathBuf>,
    /// Repeats the run of a table's header. Default: drawn by the system.
    #[arg(long)]
    seed: Option<u64>,
    /// Instead of the grid: so many tests with keys that marked nothing; writes docs/FALSE_POSITIVES.md.
    #[arg(long, value_name = "N")]
    false_positives: Option<u64>,
    /// Instead of the grid: the seed paper's study; writes docs/STUDY.md, and its plots in docs/study.
    #[arg(long, conflicts_with = "false_positives")]
    study: bool,
    /// Another file to write.
    #[arg(long)]
    output: Option<PathBuf>,
}

/// The presets, weakest first.
const STRENGTHS: [(&str, Strength); 3] = [
    ("subtle", Strength::SUBTLE),
    ("balanced", Strength::BALANCED),
    ("strong", Strength::STRONG),
];

/// Keys that the study's errors are averaged over.
const STUDY_KEYS: u32 = 2;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(path) => {
            println!("wrote {}", path.display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<PathBuf, String> {
    let seed = match arguments.seed {
        Some(number) => Seed::new(number),
        None => Seed::new(getrandom::u64().map_err(|error| error.to_string())?),
    };
    let name = match arguments.false_positives {
        _ if arguments.study => "STUDY.md",
        Some(_) => "FALSE_POSITIVES.md",
        None => "ROBUSTNESS.md",
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = arguments
        .output
        .clone()
        .unwrap_or_else(|| root.join("docs").join(name));
    let folder = arguments.models.as_deref();
    if arguments.study {
        study::write(&models::of_study(folder)?, &seed, STUDY_KEYS, &path)?;
        return Ok(path);
    }
    let (models, unread) = models::all(folder)?;
    let write = |text: &str| {
        std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))
    };
    if let Some(tests) = arguments.false_positives {
        false_positives::table(&models, &seed, tests, &write)?;
        return Ok(path);
    }
    let models: Vec<_> = models
        .into_iter()
        .filter(|model| model.is_quick || !arguments.quick)
        .collect();
    let mut rows = grid::rows();
    rows.retain(|row| row.is_quick || !arguments.quick);
    let strengths = if arguments.quick {
        &STRENGTHS[1..]
    } else {
        &STRENGTHS
    };
    let results = measure::all(&models, &rows, strengths, &seed);
    write(&report::table(
        &rows,
        &results,
        &unread,
        &seed,
        arguments.quick,
    ))?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use meshmark::mesh::shapes;
    use meshmark::scene::to_glb;

    /// A row's name is what its random numbers are for.
    #[test]
    fn rows_have_names_of_their_own() {
        let mut names: Vec<String> = grid::rows().into_iter().map(|row| row.name).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn a_seed_gives_each_purpose_its_own_and_again_the_same() {
        let bytes = |seed, purpose| *Seed::new(seed).key(purpose, 0).to_bytes();
        assert_eq!(bytes(1, "a"), bytes(1, "a"));
        assert_ne!(bytes(1, "a"), bytes(1, "b"));
        assert_ne!(bytes(1, "a"), bytes(2, "a"));
    }

    /// A small grid from end to end: what is there is found, what is not is not, and a run repeats.
    #[test]
    fn a_small_grid_repeats() {
        let model = models::Model {
            name: "asteroid".to_owned(),
            class: models::Class::Plain,
            bytes: to_glb(&shapes::asteroid(40, 60)),
            is_quick: true,
        };
        let mut rows = grid::rows();
        rows.retain(|row| ["unmarked", "none", "average with the original"].contains(&&*row.name));
        let run = || {
            let seed = Seed::new(5);
            let outcomes =
                measure::all(std::slice::from_ref(&model), &rows, &STRENGTHS[2..], &seed);
            let decoded: Vec<bool> = outcomes[0]
                .cells
                .iter()
                .map(|cell| cell.is_decoded)
                .collect();
            assert_eq!(decoded[..2], [false, true]);
            report::table(&rows, &outcomes, &[], &seed, false)
        };
        let text = run();
        assert!(text.contains("| none | 1/1 | 1/1 |"), "{text}");
        assert!(text.contains("--seed 5"));
        assert_eq!(text, run());
    }
}
