//! The robustness lab: one grid of attacks x models x strengths, and the table of what the mark survived; and the seed paper's study.
//!
//! Everything random comes from one seed, which the system draws and the table states; `--seed` runs a table again.

mod adversary;
mod baseline;
mod case;
mod cell;
mod challenge;
mod crafted;
mod false_positives;
mod forecast;
mod found;
mod grid;
mod informed;
mod journal;
mod local;
mod models;
mod opened;
mod oracle;
mod plot;
mod published;
mod real;
mod removal;
mod report;
mod room;
mod run;
mod scenes;
mod seed;
mod study;
mod surface;
mod trace;
mod traces;
mod vectors;
mod wild;

use clap::Parser;
use journal::{Header, Journal};
use meshmark::Strength;
use models::Size;
use run::Scope;
use seed::Seed;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Options of the grid, which is what the lab measures where nothing else is asked for.
const GRID: [&str; 3] = ["quick", "full", "real"];

/// Measures what the mark survives, and writes docs/ROBUSTNESS.md.
#[derive(Parser)]
#[command(name = "cargo xtask lab")]
struct Arguments {
    /// Fewer rows and models: minutes.
    #[arg(long)]
    quick: bool,
    /// Every model at every strength, three times: a night.
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// Also programs that people have, which are installed into target/real.
    #[arg(long)]
    real: bool,
    /// Blender too.
    #[arg(long, requires = "real")]
    blender: bool,
    /// Goes on with a run that was interrupted.
    #[arg(long, conflicts_with_all = ["seed", "instead"])]
    resume: bool,
    /// A folder of .glb and .obj files. Default: ../shared/models, where it exists.
    #[arg(long)]
    models: Option<PathBuf>,
    /// Repeats the run of a table's header. Default: drawn by the system.
    #[arg(long)]
    seed: Option<u64>,
    /// Instead of the grid: so many tests with keys that marked nothing; writes docs/FALSE_POSITIVES.md.
    #[arg(long, value_name = "N", group = "instead", conflicts_with_all = GRID)]
    false_positives: Option<u64>,
    /// Instead of the grid: the seed paper's study; writes docs/STUDY.md, and its plots in docs/study.
    #[arg(long, group = "instead", conflicts_with_all = GRID)]
    study: bool,
    /// Instead of the grid: forgers who may ask a detector with so many keys, and what they need; prints a table.
    #[arg(long, value_name = "N", group = "instead", conflicts_with_all = GRID)]
    oracle: Option<u64>,
    /// Instead of the grid: every .glb and .gltf in a folder, marked, and after what people do to files; prints a table. With --real, what
    /// web developers' programs leave too.
    #[arg(long, value_name = "FOLDER", group = "instead", conflicts_with_all = ["quick", "full"])]
    wild: Option<PathBuf>,
    /// Instead of the grid: plain models whose surface is written otherwise, or has more beside it that is not seen; prints a table.
    #[arg(long, group = "instead", conflicts_with_all = GRID)]
    surface: bool,
    /// Instead of the grid: what people who have no key learn from marked plain models, and do to them; prints tables.
    #[arg(long, group = "instead", conflicts_with_all = GRID)]
    adversary: bool,
    /// Instead of the grid: whether a program that learned from marked models and their hosts, so many for each kind of surface, tells one from the
    /// other; at least 8; prints a table.
    #[arg(long, value_name = "N", group = "instead", conflicts_with_all = GRID, value_parser = clap::value_parser!(u64).range(8..))]
    traces: Option<u64>,
    /// Instead of the grid: what the original and the record add to a reading, at a strength (balanced or strong); prints a table. Of plain models, or
    /// of all .glb and .obj of --models that have 200 vertices and more. With --real, also in programs that people have.
    #[arg(long, value_name = "STRENGTH", groups = ["instead", "keyed"], conflicts_with_all = ["full"])]
    informed: Option<String>,
    /// Instead of the grid: whether marks are found after simplification where the forecast says so; prints a table. Of all models, or of all .glb
    /// and .obj of --models that have 200 vertices and more. With --real, in programs that people have.
    #[arg(long, value_name = "STRENGTH", group = "instead", conflicts_with_all = ["quick", "full"])]
    forecast: Option<String>,
    /// Instead of the grid: copies at a strength that leak, alone or mixed by several buyers, and who is named; prints a table.
    #[arg(long, value_name = "STRENGTH", group = "instead", conflicts_with_all = GRID)]
    trace: Option<String>,
    /// Instead of the grid: generated models in a new folder, marked with a key that is drawn for them, for outsiders to break.
    #[arg(long, value_name = "FOLDER", group = "instead", conflicts_with_all = GRID)]
    challenge: Option<PathBuf>,
    /// Instead of the grid: the host and the marked model of docs/VECTORS.md, in a new folder.
    #[arg(long, value_name = "FOLDER", group = "instead", conflicts_with_all = GRID)]
    vectors: Option<PathBuf>,
    /// Instead of the grid: pieces of plain models that all carriers mark, cut out and then changed, read by LOCAL; and so many wrong keys;
    /// prints tables.
    #[arg(long, value_name = "N", group = "instead", conflicts_with_all = GRID)]
    local: Option<u64>,
    /// Instead of the grid: generated scenes of several objects, of which one is taken out, and plain models beside other things; or the
    /// scenes in a folder; prints tables.
    #[arg(long, value_name = "FOLDER", num_args = 0..=1, groups = ["instead", "keyed"], conflicts_with_all = GRID)]
    scenes: Option<Option<PathBuf>>,
    /// Of --scenes and --informed: instead of their tables, so many keys that marked nothing; prints a table.
    #[arg(long, value_name = "N", requires = "keyed")]
    wrong_keys: Option<u64>,
    /// Of --informed: models of 200 to 1000 vertices alone, whole and halved.
    #[arg(long, requires = "informed")]
    low_poly: bool,
    /// Of --wild and --local: subtle, balanced, strong, or a fraction of the diagonal.
    #[arg(long, default_value = "balanced")]
    strength: Strength,
    /// Another file to write; plots are in a folder beside it.
    #[arg(long)]
    output: Option<PathBuf>,
}

/// The presets, weakest first.
const STRENGTHS: [(&str, Strength); 3] = [
    ("subtle", Strength::SUBTLE),
    ("balanced", Strength::BALANCED),
    ("strong", Strength::STRONG),
];

/// Vertices without which a file is not read with the original: low-poly models are.
const FEWEST_INFORMED: usize = 200;
/// Models of more vertices are not low-poly.
const MOST_LOW_POLY: usize = 1000;

/// Keys that the study's errors are averaged over.
const STUDY_KEYS: u32 = 2;

/// Copies of each model in a full run, as many as the LIRIS benchmark has of what is random.
const COPIES: u32 = 3;

/// The folder of plots, beside the documents.
const PLOTS: &str = "robustness";

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(said) => {
            println!("{said}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Does what was asked for; returns what there is to say.
fn run(arguments: &Arguments) -> Result<String, String> {
    let seed = match arguments.seed {
        Some(number) => number,
        None => getrandom::u64().map_err(|error| error.to_string())?,
    };
    if let Some(num_keys) = arguments.oracle {
        return Ok(oracle::table(&Seed::new(seed), num_keys));
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let target = root.join("target");
    if let Some(folder) = &arguments.wild {
        return wild::table(
            folder,
            arguments.strength,
            &Seed::new(seed),
            real_tools(arguments, &target)?,
        );
    }
    if let Some(folder) = &arguments.scenes {
        let (folder, seed) = (folder.as_deref(), Seed::new(seed));
        return match arguments.wrong_keys {
            Some(tests) => scenes::wrong_keys(folder, &seed, tests),
            None => scenes::tables(folder, &seed),
        };
    }
    if arguments.surface {
        let (models, _) = models::all(arguments.models.as_deref())?;
        return surface::table(models, &Seed::new(seed));
    }
    if let Some(folder) = &arguments.challenge {
        return challenge::write(models::generated().collect(), folder);
    }
    if let Some(folder) = &arguments.vectors {
        return vectors::write(folder);
    }
    if arguments.adversary {
        let (models, _) = models::all(arguments.models.as_deref())?;
        return adversary::table(models, &Seed::new(seed));
    }
    if let Some(num_hosts) = arguments.traces {
        return traces::table(num_hosts, &Seed::new(seed));
    }
    if let Some(name) = &arguments.informed {
        let strength = named_strength(name)?;
        let most = match arguments.quick {
            true => Size::Quick,
            false => Size::Full,
        };
        let mut models = match &arguments.models {
            Some(folder) => models::of_folder(folder, FEWEST_INFORMED)?,
            None => {
                let (mut models, _) = models::all(None)?;
                models.retain(|model| arguments.low_poly || model.class == models::Class::Plain);
                models
            }
        };
        if arguments.low_poly {
            models.retain(|model| {
                models::gathered(&model.bytes)
                    .is_ok_and(|mesh| mesh.positions.len() <= MOST_LOW_POLY)
            });
        }
        models.retain(|model| model.size <= most);
        if let Some(num_keys) = arguments.wrong_keys {
            return informed::wrong_keys(&models, strength, &Seed::new(seed), num_keys);
        }
        let tools = real_tools(arguments, &target)?;
        return informed::table(
            &models,
            strength,
            &Seed::new(seed),
            &tools,
            arguments.low_poly,
        );
    }
    if let Some(name) = &arguments.forecast {
        let models = match &arguments.models {
            Some(folder) => models::of_folder(folder, FEWEST_INFORMED)?,
            None => models::all(None)?.0,
        };
        let tools = real_tools(arguments, &target)?;
        return forecast::table(&models, named_strength(name)?, &Seed::new(seed), &tools);
    }
    if let Some(name) = &arguments.trace {
        let (models, _) = models::all(arguments.models.as_deref())?;
        return trace::table(&models, named_strength(name)?, &Seed::new(seed));
    }
    if let Some(num_keys) = arguments.local {
        let (models, _) = models::all(arguments.models.as_deref())?;
        return local::tables(models, arguments.strength, &Seed::new(seed), num_keys);
    }
    let name = match arguments.false_positives {
        _ if arguments.study => "STUDY.md",
        Some(_) => "FALSE_POSITIVES.md",
        None => "ROBUSTNESS.md",
    };
    let path = arguments
        .output
        .clone()
        .unwrap_or_else(|| root.join("docs").join(name));
    let folder = arguments.models.as_deref();
    if arguments.study {
        let models = models::of_study(folder)?;
        study::write(&models, &Seed::new(seed), STUDY_KEYS, &path)?;
    } else if let Some(tests) = arguments.false_positives {
        let (models, _) = models::all(folder)?;
        let write =
            |text: &str, plot: &str| write_with_plot(&path, text, "false-positives.svg", plot);
        false_positives::table(&models, &Seed::new(seed), tests, &write)?;
    } else {
        robustness(arguments, seed, &target, &path)?;
    }
    Ok(format!("wrote {}", path.display()))
}

/// Runs the grid, or the rest of it.
fn robustness(arguments: &Arguments, seed: u64, target: &Path, path: &Path) -> Result<(), String> {
    let tools = real_tools(arguments, target)?;
    let (models, unread) = models::all(arguments.models.as_deref())?;
    let scope = scope(arguments, models, tools);
    let said = said(arguments);
    let program = program()?;
    let header = |seed| Header {
        seed,
        arguments: said.clone(),
        program: program.clone(),
    };
    let file = target.join("lab-journal.jsonl");
    let (journal, seed) = if arguments.resume {
        Journal::resume(&file, header)?
    } else {
        (Journal::begin(&file, header(seed))?, seed)
    };
    run::run(&scope, &Seed::new(seed), &journal)?;
    let results = journal.results();
    let origin = report::Origin {
        arguments: &said
            .iter()
            .map(|word| format!(" {word}"))
            .collect::<String>(),
        seed,
        unread: &unread,
    };
    let text = report::document(&origin, &scope, &results);
    write_with_plot(
        path,
        &text,
        "found.svg",
        &found::plot(&scope.rows, &results),
    )
}

fn named_strength(name: &str) -> Result<(&'static str, Strength), String> {
    let strength = STRENGTHS.into_iter().find(|(own, _)| *own == name);
    strength.ok_or_else(|| format!("there is no strength {name}"))
}

/// Other people's programs, where they are asked for; installs them.
fn real_tools(arguments: &Arguments, target: &Path) -> Result<Vec<real::Tool>, String> {
    if !arguments.real {
        return Ok(Vec::new());
    }
    real::install(&target.join("real"), arguments.blender)?;
    Ok(real::tools(&target.join("real"), arguments.blender))
}

fn scope(arguments: &Arguments, mut models: Vec<models::Model>, tools: Vec<real::Tool>) -> Scope {
    let mut rows = grid::rows();
    if arguments.quick {
        rows.retain(grid::Row::is_quick);
    }
    let size = match (arguments.quick, arguments.full) {
        (true, _) => Size::Quick,
        (_, true) => Size::Full,
        _ => Size::Usual,
    };
    models.retain(|model| model.size <= size);
    rows.extend(tools.into_iter().map(grid::Row::tool));
    Scope {
        models,
        rows,
        means: if arguments.quick {
            Vec::new()
        } else {
            removal::means()
        },
        strengths: if arguments.full {
            &STRENGTHS
        } else {
            &STRENGTHS[1..]
        },
        copies: if arguments.full { COPIES } else { 1 },
    }
}

/// The arguments that say what is run, as `cargo xtask lab` takes them.
fn said(arguments: &Arguments) -> Vec<String> {
    let flags = [
        ("--quick", arguments.quick),
        ("--full", arguments.full),
        ("--real", arguments.real),
        ("--blender", arguments.blender),
        ("--models FOLDER", arguments.models.is_some()),
    ];
    let flags = flags.into_iter().filter(|(_, is_set)| *is_set);
    flags.map(|(flag, _)| flag.to_owned()).collect()
}

/// SHA-256 of the program that runs.
fn program() -> Result<String, String> {
    let bytes = std::env::current_exe().and_then(std::fs::read);
    let digest = Sha256::digest(bytes.map_err(|error| error.to_string())?);
    Ok(digest.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn write_with_plot(path: &Path, text: &str, name: &str, plot: &str) -> Result<(), String> {
    let said = |error: std::io::Error| format!("{}: {error}", path.display());
    let folder = path.with_file_name(PLOTS);
    std::fs::create_dir_all(&folder).map_err(said)?;
    std::fs::write(folder.join(name), plot).map_err(said)?;
    std::fs::write(path, text).map_err(said)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::*;
    use meshmark::internals::mesh::shapes;
    use meshmark::internals::scene::to_glb;

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

    fn small_scope() -> Scope {
        let model = models::Model {
            name: "asteroid".to_owned(),
            class: models::Class::Plain,
            bytes: to_glb(&shapes::asteroid(40, 60)),
            size: Size::Quick,
        };
        let mut rows = grid::rows();
        rows.retain(|row| ["unmarked", "none", "average with the original"].contains(&&*row.name));
        Scope {
            models: vec![model],
            rows,
            means: Vec::new(),
            strengths: &STRENGTHS[2..],
            copies: 1,
        }
    }

    fn header(seed: u64) -> Header {
        Header {
            seed,
            arguments: Vec::new(),
            program: String::new(),
        }
    }

    fn text(scope: &Scope, journal: &Journal) -> String {
        let origin = report::Origin {
            arguments: "",
            seed: 5,
            unread: &[],
        };
        report::document(&origin, scope, &journal.results())
    }

    /// A small grid from end to end: what is there is found, what is not is not, and a run repeats. One that was cut short goes on,
    /// with the same result.
    #[test]
    fn a_small_grid_repeats_and_goes_on() {
        let scope = small_scope();
        let folder = std::env::temp_dir().join(format!("meshmark-lab-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("journal");
        let journal = Journal::begin(&path, header(5)).unwrap();
        run::run(&scope, &Seed::new(5), &journal).unwrap();
        let whole = text(&scope, &journal);
        assert!(whole.contains("| none | 1/1 | 1/1 |"), "{whole}");
        assert!(whole.contains("| unmarked | 0/1 | 0/1 |"), "{whole}");
        assert!(whole.contains("--seed 5"));
        drop(journal);

        let lines = std::fs::read_to_string(&path).unwrap();
        let cut = lines.len() - 20;
        std::fs::write(&path, &lines[..cut]).unwrap();
        let (journal, seed) = Journal::resume(&path, header).unwrap();
        assert_eq!(journal.results().cells.len(), 2);
        run::run(&scope, &Seed::new(seed), &journal).unwrap();
        assert_eq!(text(&scope, &journal), whole);
        drop(journal);

        let other = |seed| Header {
            program: "another".to_owned(),
            ..header(seed)
        };
        assert!(Journal::resume(&path, other).is_err());
        std::fs::remove_dir_all(&folder).unwrap();
    }

    /// Each row of the short grid is one of the grid.
    #[test]
    fn the_short_grid_is_part_of_the_grid() {
        let rows = grid::rows();
        let quick = rows.iter().filter(|row| row.is_quick()).count();
        assert_eq!(quick, grid::QUICK.len());
    }

    /// The published figures stand beside rows of the same name.
    #[test]
    fn published_rows_are_rows_of_the_grid() {
        let rows = grid::rows();
        for (name, _) in published::BENCHMARK {
            assert!(rows.iter().any(|row| row.name == name), "{name}");
        }
    }
}
