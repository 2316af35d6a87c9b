//! The command line: what scripts and servers use. JSON on stdout; progress and errors on stderr.
//!
//! Exit codes: 0 done, or the mark was found; 1 the mark was not found; 2 the model cannot be checked, or bad input.

use clap::{Args, Parser, Subcommand};
use meshmark::attack::{Attack, CATALOGUE, Step, chain, step};
use meshmark::document::Document;
use meshmark::geometry::Quality;
use meshmark::mesh::Mesh;
use meshmark::paper::{Preparation, study};
use meshmark::scene::{Scene, to_glb};
use meshmark::{
    Carrier, EmbedOptions, Error, Evidence, Extraction, Files, Input, Key, Payload, Progress,
    Stage, Strength, Verdict, detect, embed, extract, extract_many, inspect, measure, note, verify,
};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::error::Error as StdError;
use std::io::{IsTerminal, Write, stderr, stdout};
use std::ops::ControlFlow;
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// What evidence begins with. A file is not read as evidence because it begins so: a suspect's maker would choose how it is judged.
const EVIDENCE: &[u8] = b"MMEV";

const FOUND: u8 = 0;
const NOT_FOUND: u8 = 1;
const CANNOT_CHECK: u8 = 2;

/// Invisible, keyed, robust watermarks in the geometry of glTF models
#[derive(Parser)]
#[command(
    version,
    after_help = "Exit codes: 0 done or found, 1 not found, 2 cannot check or bad input."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Mark a model and read the mark back
    Embed {
        /// The model: .glb, or .gltf with its buffers beside it
        input: PathBuf,
        /// Where the marked model goes; changed buffers of a .gltf go beside it
        output: PathBuf,
        #[command(flatten)]
        owner: Owner,
        #[command(flatten)]
        payload: PayloadArgument,
        /// subtle, balanced, strong, or a fraction of the diagonal
        #[arg(long, default_value = "balanced")]
        strength: Strength,
        /// Comma-separated
        #[arg(long, value_delimiter = ',', default_value = "solid,ring", value_parser = carrier)]
        carriers: Vec<Carrier>,
    },
    /// Read the mark of a key from a model, or from measured evidence
    Extract {
        #[command(flatten)]
        suspect: Suspect,
        #[command(flatten)]
        owner: Owner,
        #[command(flatten)]
        telling: Telling,
    },
    /// Test a model, or measured evidence, for an expected payload
    Verify {
        #[command(flatten)]
        suspect: Suspect,
        #[command(flatten)]
        owner: Owner,
        #[command(flatten)]
        payload: PayloadArgument,
        #[command(flatten)]
        telling: Telling,
    },
    /// Measure a model without a key; the evidence can be tested later, elsewhere
    Measure {
        /// .glb or .gltf
        input: PathBuf,
        /// Where the evidence goes
        evidence: PathBuf,
    },
    /// Test a model, or measured evidence, with a list of keys
    Test {
        #[command(flatten)]
        suspect: Suspect,
        /// File with a key in each line: 64 hexadecimal digits, and a name if you like
        #[arg(long, value_name = "FILE")]
        keys: PathBuf,
    },
    /// Write a text into a model, or read it: up to 29 characters. A mark goes on top, so after the note
    Note {
        #[command(subcommand)]
        command: NoteCommand,
    },
    /// Attack a model as the robustness tables do, and measure what that cost it
    Attack {
        /// .glb or .gltf
        input: PathBuf,
        /// Where the attacked copy goes: a .glb with the geometry alone
        output: PathBuf,
        /// An attack at one of its levels, as `meshmark attacks` names it; more than one are made one after another
        #[arg(long = "step", value_name = "ATTACK", required = true, value_parser = attack_step)]
        steps: Vec<Step>,
        /// What is random is drawn with
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// List every attack and its levels
    Attacks,
    /// Describe a model and what it could hold
    Inspect {
        /// .glb or .gltf
        input: PathBuf,
    },
    /// Repeat the seed paper's study on a model of at most 11732 faces: what is found again after smoothing
    Study {
        /// .glb or .gltf
        input: PathBuf,
        /// How it is brought to so many faces: optimize (the paper's way) or simplify
        #[arg(long, default_value = "optimize", value_parser = preparation)]
        preparation: Preparation,
        /// How many keys errors are averaged over, each with a text and random hosts of its own
        #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
        keys: u32,
        /// What keys, texts and random hosts are drawn with
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
}

#[derive(Subcommand)]
enum NoteCommand {
    /// Write a text and read it back
    Embed {
        /// The model: .glb, or .gltf with its buffers beside it
        input: PathBuf,
        /// 1 to 29 bytes of UTF-8; fewer in models of less than 8192 vertices
        #[arg(long)]
        text: String,
        /// Where the model with the note goes; changed buffers of a .gltf go beside it
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
        #[command(flatten)]
        owner: Owner,
    },
    /// Read the note of a key
    Read {
        /// .glb or .gltf
        input: PathBuf,
        #[command(flatten)]
        owner: Owner,
    },
}

/// What is read.
#[derive(Args)]
struct Suspect {
    /// .glb or .gltf
    input: PathBuf,
    /// INPUT is no model but a file that `measure` wrote: only where you trust who wrote it
    #[arg(long)]
    evidence: bool,
}

/// What is told where nothing is found.
#[derive(Args)]
struct Telling {
    /// Say how far each carrier agrees, whatever the verdict is. For the key's owner: dithers can be read off it
    #[arg(long)]
    details: bool,
}

/// Whose mark. Without a passphrase file or key file, MESHMARK_PASSPHRASE is used, or the passphrase is asked for.
#[derive(Args)]
struct Owner {
    /// The owner's name, which with the passphrase makes the key
    #[arg(long, value_name = "NAME", required_unless_present = "key_file")]
    owner: Option<String>,
    /// File that holds the passphrase (one line end at its end is dropped)
    #[arg(long, value_name = "FILE", conflicts_with = "key_file")]
    passphrase_file: Option<PathBuf>,
    /// File of 32 bytes that is the key, instead of owner and passphrase
    #[arg(long, value_name = "FILE", conflicts_with = "owner")]
    key_file: Option<PathBuf>,
}

#[derive(Args)]
#[group(required = true, multiple = false)]
struct PayloadArgument {
    /// 1 to 8 characters: A-Z a-z 0-9 - . (the last not .)
    #[arg(long)]
    tag: Option<String>,
    /// A whole number below 2^48, instead of a tag
    #[arg(long)]
    number: Option<u64>,
}

type Failure = Box<dyn StdError>;

/// A file that `measure` wrote, where nobody asked for evidence.
#[derive(Debug, thiserror::Error)]
#[error(
    "{} is no model but evidence, a file that `measure` wrote; extract, verify and test read it with --evidence",
    .0.display()
)]
struct NotAsked(PathBuf);

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => error.exit(),
    };
    match run(arguments.command) {
        Ok((report, code)) => {
            print(&report);
            ExitCode::from(code)
        }
        Err(failure) => {
            let known = failure.downcast_ref::<Error>();
            let code = match failure.is::<NotAsked>() {
                true => "evidence.not-asked-for",
                false => known.map_or("io", Error::code),
            };
            let report = json!({
                "verdict": "cannot-check",
                "error": {
                    "code": code,
                    "message": failure.to_string(),
                    "path": known.and_then(Error::pointer),
                },
            });
            print(&report);
            eprintln!("meshmark: {failure}");
            ExitCode::from(CANNOT_CHECK)
        }
    }
}

/// Prints a report. Whoever closes the pipe has read enough.
fn print(report: &Value) {
    let _ = writeln!(stdout(), "{report:#}");
}

fn run(command: Command) -> Result<(Value, u8), Failure> {
    let mut clock = Clock::new();
    match command {
        Command::Embed {
            input,
            output,
            owner,
            payload,
            strength,
            carriers,
        } => {
            let payload = payload.read()?;
            let key = owner.key()?;
            let options = EmbedOptions { strength, carriers };
            let (model, files) = open(&input)?;
            let marked = embed(&model, &files, payload, &key, &options, &mut clock)?;
            store_all(&input, &output, &marked.model, &marked.files)?;
            Ok((report(&marked.report, clock)?, FOUND))
        }
        Command::Extract {
            suspect,
            owner,
            telling,
        } => {
            let key = owner.key()?;
            let extraction = examine(&suspect, &key, None, &mut clock)?;
            judge(telling.of(extraction), clock)
        }
        Command::Verify {
            suspect,
            owner,
            payload,
            telling,
        } => {
            let payload = payload.read()?;
            let key = owner.key()?;
            let extraction = examine(&suspect, &key, Some(payload), &mut clock)?;
            judge(telling.of(extraction), clock)
        }
        Command::Measure { input, evidence } => {
            let (model, files) = open(&input)?;
            let bytes = measure(&model, &files, &mut clock)?.to_bytes();
            store(&evidence, &bytes)?;
            Ok((report(&json!({ "bytes": bytes.len() }), clock)?, FOUND))
        }
        Command::Test { suspect, keys } => {
            let (readings, code) = test(&suspect, &keys, &mut clock)?;
            Ok((report(&readings, clock)?, code))
        }
        Command::Note {
            command:
                NoteCommand::Embed {
                    input,
                    text,
                    output,
                    owner,
                },
        } => {
            let key = owner.key()?;
            let (model, files) = open(&input)?;
            let noted = note::embed(&model, &files, &text, &key, &mut clock)?;
            store_all(&input, &output, &noted.model, &noted.files)?;
            Ok((report(&noted.report, clock)?, FOUND))
        }
        Command::Note {
            command: NoteCommand::Read { input, owner },
        } => {
            let key = owner.key()?;
            let (model, files) = open(&input)?;
            let reading = note::read(&model, &files, &key, &mut clock)?;
            let code = exit_code(reading.verdict);
            Ok((report(&reading, clock)?, code))
        }
        Command::Attack {
            input,
            output,
            steps,
            seed,
        } => {
            let mesh = gather(&input)?;
            let attacked = chain(&mesh, &steps, seed);
            store(&output, &to_glb(&attacked))?;
            let cost = json!({
                "steps": steps.iter().map(Step::to_string).collect::<Vec<_>>(),
                "seed": seed,
                "vertices": attacked.positions.len(),
                "triangles": attacked.triangles.len(),
                "quality": Quality::between(&mesh, &attacked),
            });
            Ok((report(&cost, clock)?, FOUND))
        }
        Command::Attacks => {
            let list = |attack: &'static Attack| {
                json!({
                    "name": attack.name,
                    "family": attack.family,
                    "steps": attack.steps().map(|step| step.to_string()).collect::<Vec<_>>(),
                })
            };
            Ok((CATALOGUE.iter().map(list).collect(), FOUND))
        }
        Command::Inspect { input } => {
            let (model, files) = open(&input)?;
            Ok((report(&inspect(&model, &files)?, clock)?, FOUND))
        }
        Command::Study {
            input,
            preparation,
            keys,
            seed,
        } => {
            let mesh = preparation.apply(&gather(&input)?);
            let study = study(&mesh, seed, keys, &mut clock).map_err(Error::from)?;
            Ok((report(&study, clock)?, FOUND))
        }
    }
}

/// The mesh of a model, as it is seen by whoever checks it.
fn gather(input: &Path) -> Result<Mesh, Failure> {
    let (model, files) = open(input)?;
    let document = Document::read(&model, &files).map_err(Error::from)?;
    Ok(Scene::gather(&document).map_err(Error::from)?.mesh)
}

fn judge(extraction: Extraction, clock: Clock) -> Result<(Value, u8), Failure> {
    let code = exit_code(extraction.verdict);
    Ok((report(&extraction, clock)?, code))
}

fn exit_code(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Found => FOUND,
        Verdict::CannotCheck => CANNOT_CHECK,
        _ => NOT_FOUND,
    }
}

/// A report as JSON with names in snake case, and the milliseconds of each stage.
fn report(report: &impl serde::Serialize, clock: Clock) -> Result<Value, Failure> {
    let mut value = snake_case(serde_json::to_value(report)?);
    if let Value::Object(fields) = &mut value {
        fields.insert("ms".to_owned(), clock.milliseconds());
    }
    Ok(value)
}

fn snake_case(value: Value) -> Value {
    let rename = |name: String| {
        name.chars().fold(String::new(), |mut out, c| {
            if c.is_ascii_uppercase() {
                out.push('_');
            }
            out.push(c.to_ascii_lowercase());
            out
        })
    };
    match value {
        Value::Object(fields) => Value::Object(
            fields
                .into_iter()
                .map(|(k, v)| (rename(k), snake_case(v)))
                .collect(),
        ),
        Value::Array(items) => items.into_iter().map(snake_case).collect(),
        other => other,
    }
}

fn attack_step(name: &str) -> Result<Step, String> {
    step(name).ok_or_else(|| "there is no such attack; `meshmark attacks` lists them".to_owned())
}

fn carrier(name: &str) -> Result<Carrier, String> {
    let known = || Carrier::ALL.map(Carrier::name).join(", ");
    Carrier::from_name(name).ok_or_else(|| format!("the carriers are: {}", known()))
}

fn preparation(name: &str) -> Result<Preparation, String> {
    let known = || Preparation::ALL.map(Preparation::name).join(", ");
    Preparation::from_name(name).ok_or_else(|| format!("the preparations are: {}", known()))
}

impl PayloadArgument {
    fn read(&self) -> Result<Payload, Failure> {
        let payload = match (&self.tag, self.number) {
            (Some(tag), _) => Payload::from_tag(tag),
            (None, number) => Payload::from_number(number.unwrap_or_default()),
        };
        Ok(payload.map_err(Error::from)?)
    }
}

impl Telling {
    fn of(&self, extraction: Extraction) -> Extraction {
        match self.details {
            true => extraction.with_details(),
            false => extraction,
        }
    }
}

impl Suspect {
    /// The evidence, where it was asked for.
    fn evidence(&self) -> Result<Option<Evidence>, Failure> {
        if !self.evidence {
            return Ok(None);
        }
        let evidence = Evidence::from_bytes(&load(&self.input)?);
        Ok(Some(evidence.map_err(Error::from)?))
    }
}

impl Owner {
    fn key(&self) -> Result<Key, Failure> {
        let key = match (&self.key_file, &self.owner) {
            (Some(file), _) => Key::from_bytes(&load(file)?),
            (None, owner) => {
                Key::from_passphrase(owner.as_deref().unwrap_or_default(), &self.passphrase()?)
            }
        };
        Ok(key.map_err(Error::from)?)
    }

    fn passphrase(&self) -> Result<String, Failure> {
        if let Some(file) = &self.passphrase_file {
            let text = String::from_utf8(load(file)?)?;
            let text = text.strip_suffix('\n').unwrap_or(&text);
            return Ok(text.strip_suffix('\r').unwrap_or(text).to_owned());
        }
        match std::env::var("MESHMARK_PASSPHRASE") {
            Ok(passphrase) => Ok(passphrase),
            Err(_) => Ok(rpassword::prompt_password("Passphrase: ")?),
        }
    }
}

/// Reads a model, or what was measured of one, with a key.
fn examine(
    suspect: &Suspect,
    key: &Key,
    expected: Option<Payload>,
    clock: &mut Clock,
) -> Result<Extraction, Failure> {
    let Some(evidence) = suspect.evidence()? else {
        let (model, files) = open(&suspect.input)?;
        return Ok(detect(&model, &files, key, expected, clock)?);
    };
    clock.start("test");
    Ok(match expected {
        Some(payload) => verify(&evidence, key, payload),
        None => extract(&evidence, key),
    })
}

/// Tests a suspect with every key of a list. That there are many is charged: a name is not found by asking often enough.
fn test(suspect: &Suspect, keys: &Path, clock: &mut Clock) -> Result<(Value, u8), Failure> {
    let (names, keys) = read_keys(&String::from_utf8(load(keys)?)?)?;
    let (evidence, input) = match suspect.evidence()? {
        Some(evidence) => (evidence, Input::Evidence),
        None => {
            let (model, files) = open(&suspect.input)?;
            (measure(&model, &files, clock)?, Input::Model)
        }
    };
    clock.start("test");
    let extractions = extract_many(&evidence, &keys);
    let is_found = |extraction: &Extraction| extraction.verdict == Verdict::Found;
    let code = match extractions.iter().any(is_found) {
        true => FOUND,
        false => NOT_FOUND,
    };
    let row = |(name, extraction): (String, &Extraction)| match is_found(extraction) {
        true => json!({
            "key": name,
            "found": true,
            "tag": extraction.tag,
            "number": extraction.number,
            "ln_p": extraction.details().ln_p,
        }),
        false => json!({ "key": name, "found": false }),
    };
    let rows: Vec<Value> = names.into_iter().zip(&extractions).map(row).collect();
    let readings = json!({
        "input": input,
        "num_keys": keys.len(),
        "ln_charge": libm::log(keys.len() as f64),
        "keys": rows,
    });
    Ok((readings, code))
}

/// Keys from lines of 64 hexadecimal digits, each with a name after them if it has one. Lines that are empty or begin with `#`
/// say nothing.
fn read_keys(text: &str) -> Result<(Vec<String>, Vec<Key>), Failure> {
    let (mut names, mut keys) = (Vec::new(), Vec::new());
    for (line, number) in text.lines().zip(1..) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let (digits, name) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let digit = |c: char| c.to_digit(16).map(|digit| digit as u8);
        let digits: Option<Vec<u8>> = digits.chars().map(digit).collect();
        let bytes = digits.and_then(|digits| {
            let (pairs, rest) = digits.as_chunks();
            let bytes = pairs.iter().map(|[high, low]| high << 4 | low);
            rest.is_empty().then(|| bytes.collect::<Vec<u8>>())
        });
        let key = bytes.and_then(|bytes| Key::from_bytes(&bytes).ok());
        let key =
            key.ok_or_else(|| format!("line {number} of the keys is not 64 hexadecimal digits"))?;
        let name = if name.is_empty() {
            format!("line {number}")
        } else {
            name.trim().to_owned()
        };
        names.push(name);
        keys.push(key);
    }
    if keys.is_empty() {
        return Err("there is no key in the list".into());
    }
    Ok((names, keys))
}

/// A model and the external buffers that it names, which are looked for beside it.
fn open(path: &Path) -> Result<(Vec<u8>, Files), Failure> {
    let model = load(path)?;
    if model.starts_with(EVIDENCE) {
        return Err(NotAsked(path.to_owned()).into());
    }
    let mut files = Files::new();
    let mut known = BTreeSet::new();
    // A model that cannot be read names no files; whoever reads it next says what is wrong.
    for uri in Document::file_names(&model).unwrap_or_default() {
        let buffer = sibling(path, &uri)?;
        // A small model could have a large file loaded as often as it finds another name for it.
        if let Ok(place) = buffer.canonicalize()
            && !known.insert(place)
        {
            return Err(format!("{uri:?} is the same file as another buffer's").into());
        }
        files.insert(uri, load(&buffer)?);
    }
    Ok((model, files))
}

/// A file beside another. A model's URIs are a stranger's words: they may not lead out of its folder.
fn sibling(path: &Path, name: &str) -> Result<PathBuf, Failure> {
    let inside = |component| matches!(component, Component::Normal(_) | Component::CurDir);
    if !Path::new(name).components().all(inside) {
        return Err(format!("{name:?} lies outside of the model's folder").into());
    }
    Ok(path.parent().unwrap_or(Path::new("")).join(name))
}

/// Writes a changed model and its changed buffers, but never over the buffers of the input.
fn store_all(input: &Path, output: &Path, model: &[u8], files: &Files) -> Result<(), Failure> {
    let mut outputs = vec![(output.to_owned(), model)];
    for (name, bytes) in files {
        let buffer = sibling(output, name)?;
        if same_file(&buffer, &sibling(input, name)?) {
            let path = buffer.display();
            return Err(format!(
                "{path} would be overwritten: write the marked model to another folder"
            )
            .into());
        }
        outputs.push((buffer, bytes));
    }
    outputs
        .iter()
        .try_for_each(|(path, bytes)| store(path, bytes))
}

fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

fn load(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()).into())
}

fn store(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    std::fs::write(path, bytes).map_err(|error| format!("{}: {error}", path.display()).into())
}

/// Times the stages of the work, and shows them where somebody watches.
struct Clock {
    stages: Vec<(&'static str, f64)>,
    running: Option<(&'static str, Instant)>,
}

impl Clock {
    fn new() -> Clock {
        Clock {
            stages: Vec::new(),
            running: None,
        }
    }

    fn start(&mut self, stage: &'static str) {
        if self.running.is_none_or(|(running, _)| running != stage) {
            self.stop();
            self.running = Some((stage, Instant::now()));
        }
    }

    fn stop(&mut self) {
        if let Some((stage, since)) = self.running.take() {
            self.stages
                .push((stage, since.elapsed().as_secs_f64() * 1e3));
        }
    }

    /// Milliseconds by stage; a stage that ran twice counts both times.
    fn milliseconds(mut self) -> Value {
        self.stop();
        if stderr().is_terminal() {
            eprint!("\r\x1b[K");
        }
        let mut sums = Map::new();
        for (stage, ms) in self.stages {
            let sum = sums.get(stage).and_then(Value::as_f64).unwrap_or_default() + ms;
            sums.insert(stage.to_owned(), json!((sum * 1e3).round() / 1e3));
        }
        Value::Object(sums)
    }
}

impl Progress for Clock {
    fn report(&mut self, stage: Stage, fraction: f64) -> ControlFlow<()> {
        self.start(stage.name());
        if stderr().is_terminal() {
            eprint!("\r\x1b[K{} {:.0} %", stage.name(), fraction * 100.0);
            let _ = stderr().flush();
        }
        ControlFlow::Continue(())
    }
}
