//! Stamps: a file that keeps the fingerprint of what a result was made from, so that it is not made twice.

use std::collections::BTreeMap;
use std::fs;
use std::hash::{DefaultHasher, Hasher};
use std::io;
use std::path::{Path, PathBuf};

use crate::process::{Failure, Result, path};

pub struct Stamp {
    path: PathBuf,
    fingerprint: String,
}

impl Stamp {
    /// A stamp kept at `path` of a result that is made from `inputs` alone.
    pub fn new(path: PathBuf, inputs: &[impl AsRef<[u8]>]) -> Self {
        let mut hasher = DefaultHasher::new();
        for input in inputs {
            hasher.write_usize(input.as_ref().len());
            hasher.write(input.as_ref());
        }
        Self {
            path,
            fingerprint: format!("{:016x}\n", hasher.finish()),
        }
    }

    /// The same of a result that is made by `tool` from files and from every file in folders, but those of tests.
    pub fn of_files(stamp: PathBuf, places: &[&str], tool: &str) -> Result<Self> {
        let mut files = BTreeMap::new();
        for place in places.iter().map(|place| path(place)) {
            collect(&place, &mut files).map_err(|error| Failure::of_file(&place, &error))?;
        }
        let files = files
            .iter()
            .flat_map(|(path, bytes)| [path.as_os_str().as_encoded_bytes(), bytes]);
        let inputs: Vec<&[u8]> = files.chain([tool.as_bytes()]).collect();
        Ok(Self::new(stamp, &inputs))
    }

    /// Whether the result that was last made came from the same inputs.
    pub fn is_fresh(&self) -> bool {
        fs::read_to_string(&self.path).is_ok_and(|kept| kept == self.fingerprint)
    }

    /// Says that the result is made.
    pub fn write(&self) -> Result<()> {
        fs::write(&self.path, &self.fingerprint)
            .map_err(|error| Failure::of_file(&self.path, &error))
    }
}

pub fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).map_err(|error| Failure::of_file(path, &error))
}

fn collect(place: &Path, files: &mut BTreeMap<PathBuf, Vec<u8>>) -> io::Result<()> {
    if place.is_file() {
        files.insert(place.to_owned(), fs::read(place)?);
        return Ok(());
    }
    for entry in fs::read_dir(place)? {
        let entry = entry?;
        if entry.file_name() != "node_modules" && entry.file_name() != "tests" {
            collect(&entry.path(), files)?;
        }
    }
    Ok(())
}
