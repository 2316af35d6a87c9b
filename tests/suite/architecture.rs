//! Who may know whom: docs/ARCHITECTURE.md's table, held against the sources.
#![cfg(not(target_arch = "wasm32"))]

use std::fs;
use std::path::Path;

/// Each room, and all that it may use of the others.
const MAY_USE: [(&str, &[&str]); 20] = [
    ("bits", &[]),
    ("digest", &[]),
    ("progress", &[]),
    ("order", &[]),
    ("random", &[]),
    ("detection", &[]),
    ("document", &["order"]),
    ("key", &[]),
    ("code", &["bits", "key"]),
    ("mesh", &["random"]),
    ("geometry", &["mesh", "order"]),
    ("scene", &["document", "mesh", "geometry", "order"]),
    (
        "carrier",
        &[
            "mesh",
            "geometry",
            "key",
            "code",
            "detection",
            "order",
            "progress",
            "random",
        ],
    ),
    ("evidence", &["carrier", "mesh"]),
    ("attack", &["mesh", "geometry", "random"]),
    (
        "watermark",
        &[
            "attack",
            "bits",
            "digest",
            "progress",
            "detection",
            "document",
            "key",
            "code",
            "mesh",
            "geometry",
            "scene",
            "carrier",
            "evidence",
        ],
    ),
    (
        "paper",
        &[
            "attack",
            "carrier",
            "code",
            "detection",
            "geometry",
            "key",
            "mesh",
            "order",
            "progress",
            "random",
            "watermark",
        ],
    ),
    ("wasm", &["*"]),
    ("lib", &["*"]),
    ("bin", &["*"]),
];

/// Crates that only some rooms may use.
const ONLY_IN: [(&[&str], &[&str]); 8] = [
    (&["gltf", "serde_json", "base64"], &["document", "bin"]),
    (
        &["argon2", "hkdf", "siphasher", "unicode_normalization"],
        &["key"],
    ),
    (&["zeroize"], &["key", "wasm"]),
    (&["sha2"], &["key", "digest"]),
    (
        &["wasm_bindgen", "js_sys", "web_sys", "serde_wasm_bindgen"],
        &["wasm"],
    ),
    (&["clap", "rpassword"], &["bin"]),
    (&["nalgebra"], &["geometry"]),
    (&["labrador_ldpc"], &["code"]),
];

/// Every source file with the room it is in.
fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = Vec::new();
    let mut open = vec![root.clone()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let inside = path
                    .strip_prefix(&root)
                    .unwrap()
                    .to_str()
                    .unwrap()
                    .to_owned();
                let room = inside.split(['/', '.']).next().unwrap().to_owned();
                sources.push((room, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    sources
}

/// Lines of code: comments are free to mention anything.
fn code(source: &str) -> impl Iterator<Item = &str> {
    source
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
}

/// The rooms that a line names as `crate::room`.
fn rooms_named(line: &str) -> impl Iterator<Item = &str> {
    line.split("crate::").skip(1).map(|rest| {
        rest.split(|c: char| !c.is_alphanumeric() && c != '_')
            .next()
            .unwrap_or("")
    })
}

#[test]
fn architecture_rooms_use_only_what_they_may() {
    let sources = sources();
    assert!(sources.len() > 30, "the sources were found");
    for (room, source) in &sources {
        let (_, may_use) = MAY_USE
            .iter()
            .find(|(name, _)| name == room)
            .unwrap_or_else(|| panic!("{room} is not in the table"));
        for line in code(source) {
            for named in rooms_named(line) {
                let allowed = may_use.contains(&"*") || named == room || may_use.contains(&named);
                assert!(allowed, "{room} uses {named}: {line}");
            }
        }
    }
}

#[test]
fn architecture_crates_stay_in_their_rooms() {
    for (room, source) in sources() {
        for (crates, rooms) in ONLY_IN {
            for line in code(&source) {
                let used = crates
                    .iter()
                    .find(|name| line.contains(&format!("{name}::")));
                assert!(
                    used.is_none() || rooms.contains(&room.as_str()),
                    "{room} uses {used:?}: {line}"
                );
            }
        }
    }
}
