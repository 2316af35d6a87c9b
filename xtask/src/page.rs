//! The built page: the npm package's and the app's dist folders.

use std::fs;

use crate::manifest::{self, Manifest, Module};
use crate::process::{Failure, Log, Result, path};
use crate::stamp::Stamp;
use crate::steps::Steps;
use crate::{npm, wasm};

const REMEDY: &str = "correct what the build names above";

/// Builds the modules, the package and the page.
pub fn build() -> Result<()> {
    let manifest = manifest::read(manifest::FILE)?;
    let mut steps = Steps::default();
    wasm::add_set_up(&mut steps, &[]);
    add(&mut steps, &manifest);
    steps.run_beside_each_other()
}

/// Adds the steps that make the modules and, of them, the package and the page.
pub fn add<'a>(steps: &mut Steps<'a>, manifest: &'a Manifest) {
    let packaged = wasm::add_modules(steps, manifest, &manifest.modules);
    let packaged: Vec<&str> = packaged.iter().map(String::as_str).collect();
    steps.add("page", &packaged, make);
}

/// Builds both, unless they are what the last build left and their sources are too.
fn make(log: &mut Log) -> Result<()> {
    let mut folders = ["www/meshmark/dist", "www/app/dist"].iter();
    if folders.all(|dist| path(dist).is_dir()) && stamp()?.is_fresh() {
        log.say("www/app/dist is as it was");
        return Ok(());
    }
    log.run(&mut npm::npm("run build"), REMEDY)?;
    stamp()?.write()
}

/// Builds the page before `missing` modules are there. Whoever asks one of them is told so.
pub fn make_early(log: &mut Log, missing: &[&Module]) -> Result<()> {
    const STAND_IN: &str = r#"// Stands in for a module until `cargo xtask serve` has built it.
export default () =>
  Promise.reject({
    code: "module.building",
    message: "This part of the page is still being built: see the terminal. Load the page again when it is done.",
    path: null,
  });
"#;
    for module in missing {
        let folder = path(&module.out_dir);
        let write = || {
            fs::create_dir_all(&folder)?;
            fs::write(folder.join(format!("{}.js", module.name)), STAND_IN)
        };
        write().map_err(|error| Failure::of_file(&folder, &error))?;
    }
    log.run(&mut npm::npm("run build --workspace meshmark"), REMEDY)?;
    // The types of what is missing are missing too, so there is no check of types; and no service worker may keep this page.
    let mut vite = npm::program("vite", "build");
    vite.current_dir(path("www/app"))
        .env("NODE_ENV", "development");
    log.run(&mut vite, REMEDY)
}

/// Of every source and every built file.
fn stamp() -> Result<Stamp> {
    Stamp::of_files(path("target/page.stamp"), &["www"], "")
}
