//! Chromium and its driver.

use std::path::PathBuf;

use crate::process::{Log, Result, check, command, find};

/// Finds both on PATH, or installs Debian's.
pub fn set_up(log: &mut Log) -> Result<()> {
    const BY_HAND: &str = "put `chromium` and `chromedriver` on PATH, then run this again";
    let is_there = || chromium().is_some() && find("chromedriver").is_some();
    if !is_there() {
        log.run(
            &mut command("sh xtask/apt-install.sh chromium chromium-driver"),
            BY_HAND,
        )?;
    }
    check(
        is_there(),
        || "Chromium or its driver is not on PATH".to_owned(),
        BY_HAND,
    )
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
