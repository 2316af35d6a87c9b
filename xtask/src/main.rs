//! What a developer or CI does with the project: `cargo xtask`. Only std, and no logic of the product.

mod apt;
mod bench;
mod browser;
mod debian;
mod lab;
mod manifest;
mod npm;
mod page;
mod process;
mod project;
mod python;
mod real;
mod serve;
mod stamp;
mod steps;
mod test;
mod toolchain;
mod tools;
mod wasm;

use std::process::ExitCode;

use process::Failure;
use steps::Steps;

const USAGE: &str = "\
cargo xtask build                 the wasm modules, for the npm package and the page
cargo xtask serve [--port PORT]   the page on localhost, at port 8080 or the next free one
cargo xtask test                  every check there is
cargo xtask bench [--runs N]      docs/PERFORMANCE.md: size, and times of 9 runs
cargo xtask lab [--quick]         docs/ROBUSTNESS.md: what marks survive; more with --help
cargo xtask lab --real            what they survive in other people's programs; Blender too with --blender
cargo xtask study                 docs/STUDY.md: the seed paper's study; more with --help

Each installs what it needs and is missing.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut steps = Steps::default();
    let result = match arguments[..] {
        ["build"] => wasm::build(&mut steps),
        ["serve"] => serve::serve(&mut steps, serve::DEFAULT_PORT),
        ["serve", "--port", port] => port
            .parse()
            .map_err(|_| {
                Failure::new(
                    format!("{port} is not a port"),
                    "give a number from 0 to 65535",
                )
            })
            .and_then(|port| serve::serve(&mut steps, port)),
        ["test"] => test::test(&mut steps),
        ["bench"] => bench::bench(&mut steps, bench::DEFAULT_RUNS),
        ["bench", "--runs", runs] => {
            bench::parse_runs(runs).and_then(|runs| bench::bench(&mut steps, runs))
        }
        ["lab", ref arguments @ ..] => lab::lab(&mut steps, arguments),
        ["study", ref arguments @ ..] => lab::lab(&mut steps, &[&["--study"], arguments].concat()),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    steps.print_table();
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("\n{failure}");
            ExitCode::FAILURE
        }
    }
}
