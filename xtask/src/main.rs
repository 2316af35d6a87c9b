//! What a developer or CI does with the project: `cargo xtask`. No logic of the product.

mod bench;
mod browser;
mod fuzz;
mod lab;
mod manifest;
mod npm;
mod page;
mod process;
mod serve;
mod stamp;
mod steps;
mod test;
mod toolchain;
mod tools;
mod wasm;

use std::process::ExitCode;

use process::Failure;

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
    let number = |text: &str, range: std::ops::RangeInclusive<u32>| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| {
            let remedy = format!(
                "give a whole number from {} to {}",
                range.start(),
                range.end()
            );
            Failure::new(format!("`{text}` cannot be used"), remedy)
        })
    };
    let result = match arguments[..] {
        ["build"] => page::build(),
        ["serve"] => serve::serve(8080),
        ["serve", "--port", port] => number(port, 0..=65535).and_then(serve::serve),
        ["test"] => test::test(false),
        ["test", "--all"] => test::test(true),
        ["fuzz"] => fuzz::fuzz(fuzz::SECONDS),
        ["fuzz", "--seconds", seconds] => number(seconds, 1..=u32::MAX).and_then(fuzz::fuzz),
        ["bench"] => bench::bench(9),
        ["bench", "--runs", runs] => number(runs, 1..=u32::MAX).and_then(bench::bench),
        ["lab", ref arguments @ ..] => lab::lab(arguments),
        ["study", ref arguments @ ..] => lab::lab(&[&["--study"], arguments].concat()),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    if let Err(failure) = result {
        eprintln!("\n{failure}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
