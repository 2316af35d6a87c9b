//! The wasm modules: compiled, bound, optimised, weighed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::manifest::{Manifest, Module};
use crate::process::{Failure, Result, file_failure, output, run};
use crate::stamp::{Stamp, read};
use crate::steps::Steps;
use crate::toolchain::{TARGET, Toolchain};
use crate::{npm, project, tools};

/// The library's name as the compiler writes it.
const LIBRARY: &str = "meshmark";

/// What wasm is built with.
pub struct Builder {
    toolchain: Toolchain,
    tools: PathBuf,
    manifest: Manifest,
}

/// Sets up what it takes and packages the modules.
pub fn build(steps: &mut Steps) -> Result<()> {
    let builder = Builder::set_up(steps)?;
    steps.run("npm packages", npm::set_up)?;
    steps.run("wasm modules", || builder.package())
}

impl Builder {
    pub fn set_up(steps: &mut Steps) -> Result<Self> {
        let manifest = Manifest::read()?;
        let toolchain = steps.run("wasm compiler", Toolchain::set_up)?;
        let tools = steps.run("wasm-bindgen tools", tools::set_up)?;
        Ok(Self {
            toolchain,
            tools,
            manifest,
        })
    }

    /// `cargo ARGUMENTS` for wasm, with the flags that modules are built with.
    pub fn cargo(&self, arguments: &str) -> Command {
        let mut command = self.toolchain.cargo(arguments);
        command.env(
            "CARGO_ENCODED_RUSTFLAGS",
            self.manifest.rust_flags.join("\x1f"),
        );
        command
    }

    /// Packages every module; needs the npm packages.
    pub fn package(&self) -> Result<()> {
        let modules = &self.manifest.modules;
        modules
            .iter()
            .try_for_each(|module| self.package_module(module))
    }

    /// Compiles a module and, where anything changed, binds and optimises it.
    fn package_module(&self, module: &Module) -> Result<()> {
        // A folder for each: Cargo gives the library the same name, whatever its features.
        let target = project::wasm_target().join(&module.feature);
        run(
            self.cargo("build --release --lib --no-default-features --features")
                .arg(&module.feature)
                .env("CARGO_TARGET_DIR", &target),
            "correct what the compiler names above",
        )?;
        let compiled = target.join(format!("{TARGET}/release/{LIBRARY}.wasm"));

        // The versions of wasm-bindgen and wasm-opt are in the compiled module and in npm's lock file.
        let inputs = [
            read(&compiled)?,
            read(&Manifest::path())?,
            read(&npm::lock_path())?,
        ];
        let stamp = Stamp::new(target.join("module.stamp"), &inputs);
        if stamp.is_fresh() && module.path().is_file() {
            println!("{} is as it was", module.path().display());
        } else {
            self.bind(&compiled, module)?;
            self.optimise(&module.path())?;
            stamp.write()?;
        }
        weigh(module)
    }

    fn bind(&self, compiled: &Path, module: &Module) -> Result<()> {
        let out_dir = project::root().join(&module.out_dir);
        if out_dir.exists() {
            fs::remove_dir_all(&out_dir).map_err(|error| file_failure(&out_dir, &error))?;
        }
        let mut command = Command::new(self.tools.join("wasm-bindgen"));
        command.args(["--target", &self.manifest.target]);
        command.args(["--out-name", &module.name, "--out-dir"]);
        command.arg(out_dir).arg(compiled);
        run(
            &mut command,
            "see that Cargo.toml pins wasm-bindgen to the version in Cargo.lock",
        )
    }

    fn optimise(&self, module: &Path) -> Result<()> {
        let mut command = npm::program("wasm-opt");
        command
            .args(&self.manifest.wasm_opt_flags)
            .arg(module)
            .arg("--output")
            .arg(module);
        run(&mut command, "see wasm-opt-flags in wasm-pack.toml")
    }
}

/// Prints the module's sizes and holds it to its budget.
fn weigh(module: &Module) -> Result<()> {
    const SIZES: &str = "const bytes = fs.readFileSync(process.argv[1]); console.log(
        bytes.length, zlib.gzipSync(bytes, { level: 9 }).length, zlib.brotliCompressSync(bytes).length)";
    let mut node = Command::new("node");
    let printed = output(
        node.args(["--eval", SIZES]).arg(module.path()),
        "see that Node runs",
    )?;
    let sizes: Vec<u64> = printed
        .split(' ')
        .filter_map(|size| size.parse().ok())
        .collect();
    let [raw, gzip, brotli] = sizes[..] else {
        let what = format!("node printed `{printed}` instead of three sizes");
        return Err(Failure::new(what, "see that Node runs"));
    };
    let budget = module.gzip_budget_bytes;
    println!(
        "{}: {raw} bytes, {gzip} by gzip (budget {budget}), {brotli} by brotli",
        module.name
    );
    if gzip > budget {
        let over = gzip - budget;
        let what = format!(
            "the module {} is {over} bytes over its budget of {budget} by gzip",
            module.name
        );
        let remedy = "make it smaller, or raise gzip-budget-bytes in wasm-pack.toml and say why";
        return Err(Failure::new(what, remedy));
    }
    Ok(())
}
