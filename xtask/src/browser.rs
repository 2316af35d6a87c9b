//! Chromium and its driver.

use std::path::PathBuf;

use crate::apt;
use crate::process::{Failure, Result, find};

const NAMES: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];

pub struct Browser {
    pub chromium: PathBuf,
    pub driver: PathBuf,
}

/// Finds both on PATH, or installs Debian's.
pub fn set_up() -> Result<Browser> {
    const BY_HAND: &str = "put `chromium` and `chromedriver` on PATH, then run this again";
    if installed().is_none() {
        apt::install(&["chromium", "chromium-driver"], BY_HAND)?;
    }
    let browser = installed()
        .ok_or_else(|| Failure::new("Chromium or its driver is not on PATH", BY_HAND))?;
    println!(
        "{} and {}",
        browser.chromium.display(),
        browser.driver.display()
    );
    Ok(browser)
}

fn installed() -> Option<Browser> {
    Some(Browser {
        chromium: NAMES.into_iter().find_map(find)?,
        driver: find("chromedriver")?,
    })
}
