//! Whether a result has to be made again.

use std::path::Path;
use std::time::SystemTime;

use anyhow::Result;

/// Whether the file `made` is there, and no source was changed after it. A folder among the sources stands for every file in it but
/// tests, installed packages and built files.
pub fn is_fresh(made: &Path, sources: &[impl AsRef<Path>]) -> Result<bool> {
    let Ok(made) = made.metadata() else {
        return Ok(false);
    };
    let made = made.modified()?;
    for source in sources {
        if newest(source.as_ref())? > made {
            return Ok(false);
        }
    }
    Ok(true)
}

fn newest(place: &Path) -> Result<SystemTime> {
    let mut newest = fs_err::metadata(place)?.modified()?;
    if place.is_dir() {
        for entry in fs_err::read_dir(place)? {
            let entry = entry?.path();
            if !["dist", "node_modules", "tests"]
                .iter()
                .any(|name| entry.ends_with(name))
            {
                newest = newest.max(self::newest(&entry)?);
            }
        }
    }
    Ok(newest)
}
