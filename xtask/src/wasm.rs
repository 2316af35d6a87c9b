//! The wasm modules: compiled, bound, optimised, weighed.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::manifest::{self, Manifest, Module};
use crate::process::{Failure, Log, Result, check, command, output, path, program_with};
use crate::stamp::{Stamp, read};
use crate::steps::Steps;
use crate::toolchain::{self, TARGET, TARGET_DIR};
use crate::{npm, tools};

/// Adds the steps that set up what wasm takes.
pub fn add_set_up(steps: &mut Steps, after: &[&str]) {
    steps.add("wasm compiler", after, toolchain::set_up);
    steps.add("wasm-bindgen tools", after, tools::set_up);
    steps.add("npm packages", after, npm::set_up);
}

/// Adds the steps that make `modules`, and returns the names of the last of each.
pub fn add_modules<'a>(
    steps: &mut Steps<'a>,
    manifest: &'a Manifest,
    modules: &'a [Module],
) -> Vec<String> {
    let mut last = Vec::new();
    let mut after_compile = "wasm compiler".to_owned();
    for module in modules {
        let compile = format!("compile {}", module.name);
        let package = format!("package {}", module.name);
        // One after another, in one folder: what the library depends on is compiled once.
        steps.add(&compile, &[&after_compile], |log| {
            compile_module(log, manifest, module)
        });
        let after = [&compile, "wasm-bindgen tools", "npm packages"];
        steps.add(&package, &after, |log| {
            package_module(log, manifest, module)
        });
        after_compile = compile;
        last.push(package);
    }
    last
}

/// Compiles a module where anything changed. Cargo gives the library the same name whatever its features, and takes one module for
/// another that has changed: so it is not asked where nothing did.
fn compile_module(log: &mut Log, manifest: &Manifest, module: &Module) -> Result<()> {
    let kept = compiled_file(module);
    let rustc = output(&mut toolchain::program("rustc", "-vV")?, "install Rust")?;
    let sources = ["src", "Cargo.toml", "Cargo.lock", manifest::FILE];
    let stamp = Stamp::of_files(kept.with_extension("sources"), &sources, &rustc)?;
    if stamp.is_fresh() && kept.is_file() {
        log.say(format_args!("{} is as it was", kept.display()));
        return Ok(());
    }
    let build = "rustc --release --lib --crate-type cdylib --no-default-features --features";
    let mut build = cargo(manifest, &format!("{build} {}", module.feature))?;
    build.env("CARGO_TARGET_DIR", modules_dir());
    log.run(&mut build, "correct what the compiler names above")?;
    let compiled = modules_dir().join(format!("{TARGET}/release/meshmark.wasm"));
    fs::copy(&compiled, &kept).map_err(|error| Failure::of_file(&kept, &error))?;
    stamp.write()
}

/// `cargo ARGUMENTS` for wasm, with the flags that modules are built with.
pub fn cargo(manifest: &Manifest, arguments: &str) -> Result<Command> {
    let mut command = toolchain::cargo(arguments)?;
    let flags: Vec<&str> = manifest.rust_flags.split_whitespace().collect();
    command.env("CARGO_ENCODED_RUSTFLAGS", flags.join("\x1f"));
    Ok(command)
}

/// Where modules are compiled: beside the wasm tests, which use a folder at the same time.
fn modules_dir() -> PathBuf {
    path(TARGET_DIR).join("modules")
}

/// A module as the compiler left it.
fn compiled_file(module: &Module) -> PathBuf {
    modules_dir().join(format!("{}.wasm", module.feature))
}

/// Binds and optimises a module where anything changed, and weighs it.
fn package_module(log: &mut Log, manifest: &Manifest, module: &Module) -> Result<()> {
    let compiled = compiled_file(module);
    let packaged = module.path();
    // The versions of wasm-bindgen and wasm-opt are in the compiled module and in npm's lock file.
    let inputs = [
        read(&compiled)?,
        read(&path(manifest::FILE))?,
        read(&path(npm::LOCK))?,
    ];
    let stamp = Stamp::new(compiled.with_extension("stamp"), &inputs);
    if stamp.is_fresh() && packaged.is_file() {
        log.say(format_args!("{} is as it was", packaged.display()));
        return weigh(log, module);
    }
    let out_dir = path(&module.out_dir);
    if out_dir.exists() {
        fs::remove_dir_all(&out_dir).map_err(|error| Failure::of_file(&out_dir, &error))?;
    }
    let names = format!(
        "--target {} --out-name {} --out-dir",
        manifest.target, module.name
    );
    log.run(
        program_with(tools::folder().join("wasm-bindgen"), &names)
            .arg(out_dir)
            .arg(compiled),
        "see that Cargo.toml pins wasm-bindgen to the version in Cargo.lock",
    )?;
    log.run(
        npm::program("wasm-opt", &manifest.wasm_opt_flags)
            .arg(&packaged)
            .arg("--output")
            .arg(&packaged),
        "see wasm-opt-flags in wasm-pack.toml",
    )?;
    stamp.write()?;
    weigh(log, module)
}

/// Says the module's sizes and holds it to its budget.
fn weigh(log: &mut Log, module: &Module) -> Result<()> {
    const SIZES: &str = "const bytes = fs.readFileSync(process.argv[1]); console.log(
        bytes.length, zlib.gzipSync(bytes, { level: 9 }).length, zlib.brotliCompressSync(bytes).length)";
    let mut node = command("node --eval");
    let sizes = output(node.arg(SIZES).arg(module.path()), "see that Node runs")?;
    let (name, budget) = (&module.name, module.gzip_budget_bytes);
    log.say(format_args!(
        "{name}: bytes, by gzip, by brotli: {sizes} (budget by gzip: {budget})"
    ));
    let gzip = sizes.split(' ').nth(1).and_then(|size| size.parse().ok());
    let gzip: u64 =
        gzip.ok_or_else(|| Failure::new(format!("node printed {sizes}"), "see that Node runs"))?;
    let what = || {
        format!(
            "{name} is {} bytes over its budget of {budget} by gzip",
            gzip - budget
        )
    };
    let remedy = "make it smaller, or raise gzip-budget-bytes in wasm-pack.toml and say why";
    check(gzip <= budget, what, remedy)
}
