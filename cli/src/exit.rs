//! How the program ends: a report on stdout, and a code.

use serde_json::Value;
use std::io::{Write, stdout};
use std::process::ExitCode;

pub const FOUND: u8 = 0;
pub const NOT_FOUND: u8 = 1;
pub const CANNOT_CHECK: u8 = 2;
pub const FRAGILE: u8 = 3;

/// Prints a report. Whoever closes the pipe has read enough.
pub fn with(report: &Value, code: u8) -> ExitCode {
    let _ = writeln!(stdout(), "{report:#}");
    ExitCode::from(code)
}
