//! Python's virtual environments.

use std::path::Path;
use std::process::Command;

use crate::apt;
use crate::process::{Result, find, output, run};
use crate::stamp::{Stamp, read};

/// What a virtual environment holds.
pub struct Environment {
    /// A requirements file with the exact version of every package, those that others import too.
    pub requirements: &'static str,
    /// What it is there for.
    pub modules: &'static str,
    /// Debian's packages of the shared libraries that the modules, and what they load later, look for.
    pub libraries: &'static [&'static str],
}

/// Makes an environment at `folder` by the file in `recipes`, unless it is there, and sees that its modules load.
pub fn set_up(environment: &Environment, recipes: &Path, folder: &Path) -> Result<()> {
    let requirements = recipes.join(environment.requirements);
    let version = output(
        Command::new("python3").arg("--version"),
        "install Python 3, then run this again",
    )?;
    let stamp = Stamp::new(
        folder.join(".stamp"),
        &[&read(&requirements)?[..], version.as_bytes()],
    );
    if stamp.is_fresh() {
        println!("{} is as in {}", folder.display(), requirements.display());
    } else {
        make(folder)?;
        run(
            Command::new(folder.join("bin/python"))
                .args([
                    "-m",
                    "pip",
                    "install",
                    "--quiet",
                    "--no-deps",
                    "--requirement",
                ])
                .arg(&requirements),
            &format!(
                "see that the registry can be reached and has the packages for {version}, then run this again"
            ),
        )?;
        stamp.write()?;
    }
    if find("apt-get").is_some() && !apt::has(environment.libraries) {
        apt::install(
            environment.libraries,
            "put these shared libraries where they are found",
        )?;
    }
    run(
        Command::new(folder.join("bin/python"))
            .args(["-c", &format!("import {}", environment.modules)]),
        "see which shared library the error above misses",
    )
}

/// An empty environment; Debian keeps what makes one in a package of its own.
fn make(folder: &Path) -> Result<()> {
    let venv = || {
        run(
            Command::new("python3")
                .args(["-m", "venv", "--clear"])
                .arg(folder),
            "install Python's venv module, then run this again",
        )
    };
    venv().or_else(|failure| {
        println!("{failure}");
        apt::install(&["python3-venv"], "install Python's venv module")?;
        venv()
    })
}
