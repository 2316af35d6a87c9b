//! The built page: the npm package's and the app's dist folders.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::process::{Result, file_failure, run};
use crate::stamp::Stamp;
use crate::{npm, project};

/// Builds both, unless they are what the last build left and their sources are too.
pub fn build() -> Result<()> {
    let is_built = ["meshmark/dist", "app/dist"]
        .iter()
        .all(|dist| project::www().join(dist).is_dir());
    if is_built && stamp()?.is_fresh() {
        println!("www/app/dist is as it was");
        return Ok(());
    }
    run(
        npm::npm().args(["run", "build"]),
        "correct what the build names above",
    )?;
    stamp()?.write()
}

/// Of every source and every built file.
fn stamp() -> Result<Stamp> {
    let mut files = BTreeMap::new();
    collect(&project::www(), &mut files).map_err(|error| file_failure(&project::www(), &error))?;
    let inputs: Vec<&[u8]> = files
        .iter()
        .flat_map(|(path, bytes)| [path.as_os_str().as_encoded_bytes(), bytes])
        .collect();
    Ok(Stamp::new(
        project::root().join("target/page.stamp"),
        &inputs,
    ))
}

fn collect(folder: &Path, files: &mut BTreeMap<PathBuf, Vec<u8>>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let path = entry.path();
        if entry.file_type()?.is_file() {
            let bytes = fs::read(&path)?;
            files.insert(path, bytes);
        } else if entry.file_type()?.is_dir()
            && entry.file_name() != "node_modules"
            && entry.file_name() != "tests"
        {
            collect(&path, files)?;
        }
    }
    Ok(())
}
