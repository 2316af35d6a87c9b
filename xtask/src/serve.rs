//! The built page on localhost.

use std::os::unix::process::CommandExt;

use crate::process::{Failure, Result};
use crate::steps::Steps;
use crate::{npm, page, project, wasm};

pub const DEFAULT_PORT: u16 = 8080;

/// Builds the page and serves it, at `port` or the next free one, until stopped.
pub fn serve(steps: &mut Steps, port: u16) -> Result<()> {
    wasm::build(steps)?;
    steps.run("page", page::build)?;
    steps.print_table();
    let mut server = npm::program("vite");
    server
        .args([
            "preview",
            "--host",
            "127.0.0.1",
            "--port",
            &port.to_string(),
        ])
        .current_dir(project::www().join("app"));
    let error = server.exec(); // takes this process's place, so that a signal reaches the server itself
    Err(Failure::new(
        format!("vite cannot be started: {error}"),
        "remove www/node_modules, then run this again",
    ))
}
