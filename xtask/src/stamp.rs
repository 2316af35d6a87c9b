//! Stamps: a file that keeps the fingerprint of what a result was made from, so that it is not made twice.

use std::fs;
use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};

use crate::process::{Failure, Result};

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
