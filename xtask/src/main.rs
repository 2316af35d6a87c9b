//! What a developer or CI does with the project: `cargo xtask`. No logic of the product.

mod bench;
mod browser;
mod freshness;
mod fuzz;
mod manifest;
mod npm;
mod page;
mod process;
mod serve;
mod steps;
mod test;
mod toolchain;
mod wasm;

use std::process::ExitCode;
use std::str::FromStr;

use anyhow::{Context, Result};

use process::{Log, command};

const USAGE: &str = "\
cargo xtask build                 the wasm modules, the npm package and the page
cargo xtask serve [--port PORT]   the page on localhost, at port 8080 or the next free one
cargo xtask test                  what must pass with every commit
cargo xtask test --all            that, and what takes longer: every check there is
cargo xtask fuzz [--seconds N]    each fuzz target, for a minute
cargo xtask bench [--runs N]      docs/PERFORMANCE.md: size, and times of 9 runs
cargo xtask lab [--quick]         docs/ROBUSTNESS.md: what marks survive; more with --help
cargo xtask lab --real            what they survive in other people's programs; Blender too with --blender
cargo xtask study                 docs/STUDY.md: the seed paper's study; more with --help

Each installs what it needs and is missing.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let log = &mut Log(None);
    let result = match arguments[..] {
        ["build"] => page::build(),
        ["serve"] => serve::serve(8080),
        ["serve", "--port", port] => number(port).and_then(serve::serve),
        ["test"] => test::test(false),
        ["test", "--all"] => test::test(true),
        ["fuzz"] => fuzz::fuzz(log, fuzz::SECONDS),
        ["fuzz", "--seconds", seconds] => number(seconds).and_then(|n| fuzz::fuzz(log, n)),
        ["bench"] => bench::bench(log, 9),
        ["bench", "--runs", runs] => number(runs).and_then(|runs| bench::bench(log, runs)),
        ["lab", ref arguments @ ..] => lab(log, arguments),
        ["study", ref arguments @ ..] => lab(log, &[&["--study"], arguments].concat()),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    if let Err(error) = result {
        eprintln!("\nerror: {error:#}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn number<N: FromStr<Err = std::num::ParseIntError>>(text: &str) -> Result<N> {
    let number = text.parse();
    number.with_context(|| format!("`{text}` cannot be used: give a whole number in range"))
}

/// Starts the lab, which does all of it.
fn lab(log: &mut Log, arguments: &[&str]) -> Result<()> {
    let mut lab = command("cargo run --release --package meshmark-lab --");
    log.run(lab.args(arguments), "see the error above")
}
