//! The built page on localhost.

use std::os::unix::process::CommandExt;
use std::process::Command;

use anyhow::{Result, bail};

use crate::manifest::Manifest;
use crate::process::path;
use crate::steps::Steps;
use crate::{npm, page, wasm};

/// Builds the page and serves it, at `port` or the next free one, until stopped. The first time the page is there with its first
/// module, that of marking and checking; the others are built behind it.
pub fn serve(port: u16) -> Result<()> {
    let manifest = Manifest::read()?;
    let (first, others) = manifest.modules.split_at(1);
    if others.iter().all(|module| module.path().is_file()) {
        page::build()?;
    } else {
        let mut steps = Steps::default();
        wasm::add_set_up(&mut steps, &[]);
        let packaged = wasm::add_modules(&mut steps, &manifest, first);
        let after: Vec<&str> = packaged.iter().map(String::as_str).collect();
        steps.add("page without the other modules", &after, page::make_early);
        steps.run()?;
        // Goes on beside the server.
        Command::new(std::env::current_exe()?)
            .arg("build")
            .spawn()?;
    }
    let mut server = npm::program("vite", "preview --host 127.0.0.1 --port");
    server.arg(port.to_string()).current_dir(path("www/app"));
    let error = server.exec(); // takes this process's place, so that a signal reaches the server itself
    bail!("vite cannot be started: {error}")
}
