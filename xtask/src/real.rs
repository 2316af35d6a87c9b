//! The programs that people use on models, for the lab: `lab/real` says which, target/real holds them.

use std::fs;
use std::path::Path;

use crate::process::{Result, file_failure};
use crate::python::{self, Environment};
use crate::{npm, project};

const PYTHON: Environment = Environment {
    requirements: "requirements.txt",
    modules: "open3d, pymeshlab, trimesh",
    libraries: &[
        "libegl1",
        "libgl1",
        "libopengl0",
        "libusb-1.0-0",
        "libx11-6",
    ],
};

const BLENDER: Environment = Environment {
    requirements: "requirements-blender.txt",
    modules: "bpy",
    libraries: &[
        "libgl1",
        "libsm6",
        "libx11-6",
        "libxext6",
        "libxfixes3",
        "libxi6",
        "libxkbcommon0",
        "libxrender1",
        "libxxf86vm1",
    ],
};

/// Installs every program; Blender, which is large, if it is wanted.
pub fn set_up(with_blender: bool) -> Result<()> {
    let (recipes, folder) = (project::real(), project::real_tools());
    copy(&recipes, &folder)?;
    npm::install(&folder)?;
    python::set_up(&PYTHON, &recipes, &folder.join("python"))?;
    if with_blender {
        python::set_up(&BLENDER, &recipes, &folder.join("blender"))?;
    }
    Ok(())
}

/// Puts the scripts beside the packages that they import.
fn copy(from: &Path, to: &Path) -> Result<()> {
    let failure = |error| file_failure(to, &error);
    fs::create_dir_all(to).map_err(failure)?;
    for file in fs::read_dir(from).map_err(|error| file_failure(from, &error))? {
        let file = file.map_err(failure)?;
        fs::copy(file.path(), to.join(file.file_name())).map_err(failure)?;
    }
    Ok(())
}
