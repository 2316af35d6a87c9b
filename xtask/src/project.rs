//! Where things are.

use std::path::{Path, PathBuf};

/// The workspace's root.
pub fn root() -> &'static Path {
    let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
    xtask.parent().unwrap_or(xtask)
}

pub fn www() -> PathBuf {
    root().join("www")
}

/// Tools that only this project uses.
pub fn tools() -> PathBuf {
    root().join("target/tools")
}

/// What runs other people's programs in the lab.
pub fn real() -> PathBuf {
    root().join("lab/real")
}

/// Where those programs are.
pub fn real_tools() -> PathBuf {
    root().join("target/real")
}

/// The target directory of every wasm command: apart from the native one, for it can have another compiler.
pub fn wasm_target() -> PathBuf {
    root().join("target/wasm")
}
