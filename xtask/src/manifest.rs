//! wasm-pack.toml: `key = "text"` or `key = number` lines and comments, the part of TOML that it needs.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use crate::process::{Failure, Result, file_failure};
use crate::project;

const FILE: &str = "wasm-pack.toml";

/// How the wasm module is packaged; what each key means is said in the file.
pub struct Manifest {
    pub name: String,
    pub target: String,
    pub out_dir: String,
    pub rust_flags: Vec<String>,
    pub wasm_opt_flags: Vec<String>,
    pub gzip_budget_bytes: u64,
}

impl Manifest {
    pub fn path() -> PathBuf {
        project::root().join(FILE)
    }

    pub fn read() -> Result<Self> {
        let text = fs::read_to_string(Self::path())
            .map_err(|error| file_failure(&Self::path(), &error))?;
        Self::parse(&text)
            .map_err(|what| Failure::new(format!("{FILE}: {what}"), format!("correct {FILE}")))
    }

    fn parse(text: &str) -> std::result::Result<Self, String> {
        let mut values = parse_lines(text)?;
        let mut take = |key: &str| {
            values
                .remove(key)
                .ok_or_else(|| format!("`{key}` is missing"))
        };
        let words = |text: String| text.split_whitespace().map(str::to_owned).collect();
        let manifest = Self {
            name: take("name")?.text()?,
            target: take("target")?.text()?,
            out_dir: take("out-dir")?.text()?,
            rust_flags: words(take("rust-flags")?.text()?),
            wasm_opt_flags: words(take("wasm-opt-flags")?.text()?),
            gzip_budget_bytes: take("gzip-budget-bytes")?.number()?,
        };
        match values.keys().next() {
            Some(key) => Err(format!("`{key}` is not a key of it")),
            None => Ok(manifest),
        }
    }
}

enum Value {
    Text(String),
    Number(u64),
}

impl Value {
    fn text(self) -> std::result::Result<String, String> {
        match self {
            Self::Text(text) => Ok(text),
            Self::Number(number) => Err(format!("{number} should be in quotes")),
        }
    }

    fn number(self) -> std::result::Result<u64, String> {
        match self {
            Self::Number(number) => Ok(number),
            Self::Text(text) => Err(format!("\"{text}\" should be a number")),
        }
    }
}

fn parse_lines(text: &str) -> std::result::Result<BTreeMap<&str, Value>, String> {
    let mut values = BTreeMap::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let (key, value) = line
            .split_once('=')
            .ok_or_else(|| format!("line {number} is not `key = value`"))?;
        let value = parse_value(value.trim())
            .ok_or_else(|| format!("line {number} has no value that is read here"))?;
        if values.insert(key.trim(), value).is_some() {
            return Err(format!("line {number} gives `{}` again", key.trim()));
        }
    }
    Ok(values)
}

/// A text in quotes without escapes, or a whole number, and then nothing but a comment.
fn parse_value(text: &str) -> Option<Value> {
    let (value, rest) = if let Some(quoted) = text.strip_prefix('"') {
        let (inside, rest) = quoted.split_once('"')?;
        (Value::Text(inside.to_owned()).into(), rest)
    } else {
        let end = text
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(text.len());
        (text[..end].parse().ok().map(Value::Number), &text[end..])
    };
    let rest = rest.trim_start();
    if rest.is_empty() || rest.starts_with('#') {
        value
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::Manifest;

    const GOOD: &str = r##"
        # a comment
        name = "a"
        target = "web" # another
        out-dir = "out#1"
        rust-flags = "-Cx  -Cy"
        wasm-opt-flags = ""
        gzip-budget-bytes = 12
    "##;

    #[test]
    fn reads_every_key() {
        let manifest = Manifest::parse(GOOD).expect("it is well formed");
        assert_eq!(manifest.out_dir, "out#1");
        assert_eq!(manifest.rust_flags, ["-Cx", "-Cy"]);
        assert!(manifest.wasm_opt_flags.is_empty());
        assert_eq!(manifest.gzip_budget_bytes, 12);
    }

    #[test]
    fn says_what_is_wrong() {
        for (from, to, expected) in [
            ("name = \"a\"", "", "`name` is missing"),
            ("name = \"a\"", "name", "line 3 is not `key = value`"),
            ("name = \"a\"", "name = 1", "1 should be in quotes"),
            (
                "name = \"a\"",
                "name = \"a\" b",
                "line 3 has no value that is read here",
            ),
            (
                "name = \"a\"",
                "name = \"a\"\nname = \"b\"",
                "line 4 gives `name` again",
            ),
            (
                "name = \"a\"",
                "name = \"a\"\nsize = 1",
                "`size` is not a key of it",
            ),
            ("12", "\"12\"", "\"12\" should be a number"),
            (
                "12",
                "99999999999999999999",
                "line 8 has no value that is read here",
            ),
        ] {
            let error = Manifest::parse(&GOOD.replacen(from, to, 1)).err();
            assert_eq!(error.as_deref(), Some(expected), "{from} -> {to}");
        }
    }
}
