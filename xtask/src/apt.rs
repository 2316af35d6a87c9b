//! Debian's packages.

use std::process::Command;

use crate::process::{Failure, Result, find, output, run};

/// Whether all of `packages` are installed.
pub fn has(packages: &[&str]) -> bool {
    packages.iter().all(|package| {
        let query = Command::new("dpkg-query")
            .args(["--show", "--showformat=${Status}", package])
            .output();
        query.is_ok_and(|query| query.stdout == b"install ok installed")
    })
}

/// Installs `packages`, as root or by sudo, and removes none; `otherwise` is another way to what they are for.
pub fn install(packages: &[&str], otherwise: &str) -> Result<()> {
    let packages = packages.join(" ");
    if find("apt-get").is_none() {
        return Err(Failure::new(
            format!("there is no apt-get to install {packages} with"),
            otherwise,
        ));
    }
    let by_hand = format!(
        "run `apt-get update && apt-get install {packages}` as root, then this again; or {otherwise}"
    );
    let is_root = output(Command::new("id").arg("-u"), &by_hand)? == "0";
    if !is_root && find("sudo").is_none() {
        return Err(Failure::new(
            "only root can install packages, and there is no sudo",
            by_hand,
        ));
    }
    let apt_get = |arguments: &str| {
        let mut command = Command::new(if is_root { "env" } else { "sudo" });
        command.args(["DEBIAN_FRONTEND=noninteractive", "apt-get", "--quiet"]);
        run(command.args(arguments.split(' ')), &by_hand)
    };
    apt_get("update")?;
    apt_get(&format!(
        "install --yes --no-install-recommends --no-remove {packages}"
    ))
}
