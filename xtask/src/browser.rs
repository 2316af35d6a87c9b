//! Chromium and its driver.

use std::path::PathBuf;

use anyhow::{Result, ensure};

use crate::process::{Log, TO_DO, command, find};

/// Finds both on PATH, or installs Debian's.
pub fn set_up(log: &mut Log) -> Result<()> {
    const BY_HAND: &str = "put `chromium` and `chromedriver` on PATH, then run this again";
    let is_there = || chromium().is_some() && find("chromedriver").is_some();
    if !is_there() {
        let mut install = command("sh xtask/apt-install.sh chromium chromium-driver");
        log.run(&mut install, BY_HAND)?;
    }
    ensure!(
        is_there(),
        "Chromium or its driver is not on PATH\n{TO_DO}{BY_HAND}"
    );
    Ok(())
}

pub fn chromium() -> Option<PathBuf> {
    let names = [
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
    ];
    names.into_iter().find_map(find)
}
