//! wasm-pack.toml: `key = "text"` or `key = number` lines, `[[module]]` and comments, the part of TOML that it needs.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use crate::process::{Failure, Result, file_failure};
use crate::project;

const FILE: &str = "wasm-pack.toml";

/// How wasm modules are packaged; what each key means is said in the file.
pub struct Manifest {
    pub target: String,
    pub rust_flags: Vec<String>,
    pub wasm_opt_flags: Vec<String>,
    pub modules: Vec<Module>,
}

/// One of the modules.
pub struct Module {
    pub name: String,
    pub feature: String,
    pub out_dir: String,
    pub gzip_budget_bytes: u64,
}

impl Module {
    /// The module itself, of the files in its folder.
    pub fn path(&self) -> PathBuf {
        project::root()
            .join(&self.out_dir)
            .join(format!("{}_bg.wasm", self.name))
    }
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
        let (mut shared, modules) = parse_tables(text)?;
        let words = |text: String| text.split_whitespace().map(str::to_owned).collect();
        let manifest = Self {
            target: shared.take("target")?.text()?,
            rust_flags: words(shared.take("rust-flags")?.text()?),
            wasm_opt_flags: words(shared.take("wasm-opt-flags")?.text()?),
            modules: modules
                .into_iter()
                .map(Module::parse)
                .collect::<std::result::Result<_, _>>()?,
        };
        shared.end()?;
        Ok(manifest)
    }
}

impl Module {
    fn parse(mut table: Table) -> std::result::Result<Self, String> {
        let module = Self {
            name: table.take("name")?.text()?,
            feature: table.take("feature")?.text()?,
            out_dir: table.take("out-dir")?.text()?,
            gzip_budget_bytes: table.take("gzip-budget-bytes")?.number()?,
        };
        table.end()?;
        Ok(module)
    }
}

#[derive(Default)]
struct Table<'a>(BTreeMap<&'a str, Value>);

impl Table<'_> {
    fn take(&mut self, key: &str) -> std::result::Result<Value, String> {
        self.0
            .remove(key)
            .ok_or_else(|| format!("`{key}` is missing"))
    }

    /// Everything has been taken.
    fn end(self) -> std::result::Result<(), String> {
        match self.0.keys().next() {
            Some(key) => Err(format!("`{key}` is not a key of it")),
            None => Ok(()),
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

/// What stands before the first `[[module]]`, and what stands under each.
fn parse_tables(text: &str) -> std::result::Result<(Table<'_>, Vec<Table<'_>>), String> {
    let (mut shared, mut modules) = (Table::default(), Vec::new());
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        if line == "[[module]]" {
            modules.push(Table::default());
            continue;
        }
        let (key, value) = line
            .split_once('=')
            .ok_or_else(|| format!("line {number} is not `key = value`"))?;
        let value = parse_value(value.trim())
            .ok_or_else(|| format!("line {number} has no value that is read here"))?;
        let table = modules.last_mut().unwrap_or(&mut shared);
        if table.0.insert(key.trim(), value).is_some() {
            return Err(format!("line {number} gives `{}` again", key.trim()));
        }
    }
    Ok((shared, modules))
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
        target = "web" # another
        rust-flags = "-Cx  -Cy"
        wasm-opt-flags = ""
        [[module]]
        name = "a"
        feature = "x"
        out-dir = "out#1"
        gzip-budget-bytes = 12
        [[module]]
        name = "b"
        feature = "y"
        out-dir = "out"
        gzip-budget-bytes = 3
    "##;

    #[test]
    fn reads_every_key() {
        let manifest = Manifest::parse(GOOD).expect("it is well formed");
        assert_eq!(manifest.rust_flags, ["-Cx", "-Cy"]);
        assert!(manifest.wasm_opt_flags.is_empty());
        let modules: Vec<_> = manifest
            .modules
            .iter()
            .map(|module| (&module.out_dir[..], module.gzip_budget_bytes))
            .collect();
        assert_eq!(modules, [("out#1", 12), ("out", 3)]);
    }

    #[test]
    fn says_what_is_wrong() {
        for (from, to, expected) in [
            ("name = \"a\"", "", "`name` is missing"),
            ("target = \"web\"", "", "`target` is missing"),
            ("target", "size = 1\ntarget", "`size` is not a key of it"),
            ("name = \"a\"", "name", "line 7 is not `key = value`"),
            ("name = \"a\"", "name = 1", "1 should be in quotes"),
            (
                "name = \"a\"",
                "name = \"a\" b",
                "line 7 has no value that is read here",
            ),
            (
                "name = \"a\"",
                "name = \"a\"\nname = \"b\"",
                "line 8 gives `name` again",
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
                "line 10 has no value that is read here",
            ),
        ] {
            let error = Manifest::parse(&GOOD.replacen(from, to, 1)).err();
            assert_eq!(error.as_deref(), Some(expected), "{from} -> {to}");
        }
    }
}
