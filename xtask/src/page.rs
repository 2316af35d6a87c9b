//! The built page: the npm package's and the app's dist folders.

use anyhow::Result;

use crate::freshness::is_fresh;
use crate::manifest::Manifest;
use crate::process::{Log, path};
use crate::steps::Steps;
use crate::{npm, wasm};

const REMEDY: &str = "correct what the build names above";

/// Builds the modules, the package and the page.
pub fn build() -> Result<()> {
    let manifest = Manifest::read()?;
    let mut steps = Steps::default();
    wasm::add_set_up(&mut steps, &[]);
    add(&mut steps, &manifest);
    steps.run()
}

/// Adds the steps that make the modules and, of them, the package and the page.
pub fn add<'a>(steps: &mut Steps<'a>, manifest: &'a Manifest) {
    let packaged = wasm::add_modules(steps, manifest, &manifest.modules);
    let packaged: Vec<&str> = packaged.iter().map(String::as_str).collect();
    steps.add("page", &packaged, make);
}

/// Builds both where a source or a module is newer.
fn make(log: &mut Log) -> Result<()> {
    // The package is built first.
    if is_fresh(&path("www/app/dist/index.html"), &[path("www")])? {
        return Ok(());
    }
    log.run(&mut npm::npm("run build"), REMEDY)
}

/// Builds the page before its other modules are there. Whoever asks for one of them is told so.
pub fn make_early(log: &mut Log) -> Result<()> {
    log.run(&mut npm::npm("run build:early"), REMEDY)
}
