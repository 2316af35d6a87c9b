//! The wasm modules: compiled, bound, optimised, weighed.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use fs_err as fs;

use crate::freshness::is_fresh;
use crate::manifest::{self, Manifest, Module};
use crate::npm;
use crate::process::{self, Log, TO_DO, output, path};
use crate::steps::Steps;
use crate::toolchain::{self, TARGET, TARGET_DIR};

/// Adds the steps that set up what wasm takes.
pub fn add_set_up(steps: &mut Steps, after: &[&str]) {
    steps.add("wasm compiler", after, toolchain::set_up_compiler);
    steps.add("wasm-bindgen tools", after, toolchain::set_up_tools);
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

/// A command by its words for wasm, with the flags that modules are built with.
pub fn command(manifest: &Manifest, words: &str) -> Result<Command> {
    let mut command = toolchain::command(words)?;
    let flags: Vec<&str> = manifest.rust_flags.split_whitespace().collect();
    command.env("CARGO_ENCODED_RUSTFLAGS", flags.join("\x1f"));
    Ok(command)
}

/// Compiles a module where anything changed. Cargo gives the library the same name whatever its features, and takes one module for
/// another that has changed: so it is not asked where nothing did.
fn compile_module(log: &mut Log, manifest: &Manifest, module: &Module) -> Result<()> {
    let kept = compiled_file(module);
    let sources = ["src", "Cargo.toml", "Cargo.lock", manifest::FILE];
    if is_fresh(&kept, &sources.map(path))? {
        return Ok(());
    }
    let build = "cargo rustc --release --lib --crate-type cdylib --no-default-features --features";
    let mut build = command(manifest, &format!("{build} {}", module.feature))?;
    build.env("CARGO_TARGET_DIR", modules_dir());
    log.run(&mut build, "correct what the compiler names above")?;
    fs::copy(
        modules_dir().join(format!("{TARGET}/release/meshmark.wasm")),
        &kept,
    )?;
    Ok(())
}

/// Where modules are compiled: beside the wasm tests, which use a folder at the same time.
fn modules_dir() -> PathBuf {
    path(TARGET_DIR).join("modules")
}

/// A module as the compiler left it.
fn compiled_file(module: &Module) -> PathBuf {
    modules_dir().join(format!("{}.wasm", module.feature))
}

/// Binds and optimises a module where anything changed, and weighs it. The module itself comes last: what was interrupted is made
/// again.
fn package_module(log: &mut Log, manifest: &Manifest, module: &Module) -> Result<()> {
    let (compiled, packaged) = (compiled_file(module), module.path());
    let sources = [compiled.clone(), path(manifest::FILE), path(npm::LOCK)];
    if !is_fresh(&packaged, &sources)? {
        let out_dir = path(&module.out_dir);
        if out_dir.exists() {
            fs::remove_dir_all(&out_dir)?;
        }
        let mut bind = Command::new(toolchain::tool("wasm-bindgen")?);
        bind.args(["--target", &manifest.target, "--out-name", &module.name])
            .arg("--out-dir")
            .args([&out_dir, &compiled]);
        let remedy = "see that Cargo.toml pins wasm-bindgen to the version in Cargo.lock";
        log.run(&mut bind, remedy)?;
        let bound = compiled.with_extension("bound");
        fs::rename(&packaged, &bound)?;
        let mut optimise = npm::program("wasm-opt", &manifest.wasm_opt_flags);
        optimise.arg(bound).arg("--output").arg(packaged);
        log.run(&mut optimise, "see wasm-opt-flags in wasm-pack.toml")?;
    }
    weigh(log, module)
}

/// Says the module's sizes and holds it to its budget.
fn weigh(log: &mut Log, module: &Module) -> Result<()> {
    const SIZES: &str = "const bytes = fs.readFileSync(process.argv[1]); console.log(
        bytes.length, zlib.gzipSync(bytes, { level: 9 }).length, zlib.brotliCompressSync(bytes).length)";
    let mut node = process::command("node --eval");
    let sizes = output(node.arg(SIZES).arg(module.path()))?;
    let (name, budget) = (&module.name, module.gzip_budget_bytes);
    log.say(format_args!(
        "{name}: bytes, by gzip, by brotli: {sizes} (budget by gzip: {budget})"
    ));
    let gzip = sizes.split(' ').nth(1).context("node printed no size")?;
    let over = gzip.parse::<u64>()?.saturating_sub(budget);
    ensure!(
        over == 0,
        "{name} is {over} bytes over its budget of {budget} by gzip\n\
         {TO_DO}make it smaller, or raise gzip-budget-bytes in {} and say why",
        manifest::FILE
    );
    Ok(())
}
