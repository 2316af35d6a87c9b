//! The built page: the npm package's and the app's dist folders.

use anyhow::Result;
use fs_err as fs;

use crate::freshness::is_fresh;
use crate::manifest::{Manifest, Module};
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
        fs::create_dir_all(&folder)?;
        fs::write(folder.join(format!("{}.js", module.name)), STAND_IN)?;
    }
    log.run(&mut npm::npm("run build --workspace meshmark"), REMEDY)?;
    // The types of what is missing are missing too, so there is no check of types; and no service worker may keep this page.
    let mut vite = npm::program("vite", "build");
    vite.current_dir(path("www/app"))
        .env("NODE_ENV", "development");
    log.run(&mut vite, REMEDY)
}
