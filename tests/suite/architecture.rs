//! Who may know whom: docs/ARCHITECTURE.md's tables, held against the sources.
#![cfg(not(target_arch = "wasm32"))]

mod sources;

use sources::Sources;
use std::collections::BTreeSet;

/// A row of the document's tables: what it is about, and what is said of that.
type Row = (Vec<String>, Vec<String>);

/// The rows of the table in docs/ARCHITECTURE.md that has a heading, as names.
fn table(heading: &str) -> Vec<Row> {
    const DOCUMENT: &str = include_str!("../../docs/ARCHITECTURE.md");
    let (_, rows) = DOCUMENT.split_once(heading).expect("the table is there");
    let names = |cell: &str| -> Vec<String> {
        let names = cell.split([' ', ',', '`']).filter(|name| !name.is_empty());
        names
            .filter(|name| *name != "-")
            .map(str::to_owned)
            .collect()
    };
    let rows = rows.trim_start().lines().skip(1);
    let rows = rows.take_while(|line| line.starts_with('|'));
    let cells = rows.map(|line| line.trim_matches('|').split('|').collect::<Vec<_>>());
    cells
        .map(|cells| (names(cells[0]), names(cells[1])))
        .collect()
}

/// The room of a file.
fn room(file: &str) -> &str {
    file.split(['/', '.']).next().unwrap_or("")
}

#[test]
fn architecture_rooms_use_only_what_they_may() {
    let sources = Sources::of("src");
    assert!(sources.files.len() > 30, "the sources were found");
    let may_use = table("| room | may use |\n");
    let allowed = |room: &str| {
        let row = may_use
            .iter()
            .find(|(rooms, _)| rooms.iter().any(|other| other == room));
        &row.unwrap_or_else(|| panic!("{room} is not in the table"))
            .1
    };
    for (user, used) in sources.arrows() {
        let [user, used] = [user, used].map(|file| &*sources.files[file].name);
        let may = allowed(room(user));
        let is_allowed = may
            .iter()
            .any(|name| name == room(used) || name == "everything");
        assert!(room(user) == room(used) || is_allowed, "{user} uses {used}");
    }
}

#[test]
fn architecture_tables_have_every_room_and_arrows_that_lead_up() {
    let sources = Sources::of("src");
    let rooms: BTreeSet<&str> = sources.files.iter().map(|file| room(&file.name)).collect();
    let may_use = table("| room | may use |\n");
    let listed: Vec<&str> = may_use
        .iter()
        .flat_map(|(rooms, _)| rooms)
        .map(String::as_str)
        .collect();
    assert_eq!(listed.iter().copied().collect::<BTreeSet<_>>(), rooms);
    let described = table("| room | what it does |\n");
    let described: BTreeSet<&str> = described
        .iter()
        .flat_map(|(rooms, _)| rooms)
        .map(String::as_str)
        .collect();
    let roots = BTreeSet::from(["internals", "lib"]);
    assert_eq!(described, &rooms - &roots);
    let mut above = Vec::new();
    for (rooms, uses) in &may_use {
        let is_above = |name: &String| above.contains(&name) || name == "everything";
        assert!(uses.iter().all(is_above), "{rooms:?} use what stands below");
        above.extend(rooms);
    }
}

#[test]
fn architecture_crates_stay_in_their_rooms() {
    let only_in = table("| crate | only in |\n");
    assert!(!only_in.is_empty());
    for file in Sources::of("src").files {
        for (crates, rooms) in &only_in {
            for line in &file.lines {
                let used = crates
                    .iter()
                    .find(|name| line.contains(&format!("{name}::")));
                let is_allowed = rooms.iter().any(|name| name == room(&file.name));
                assert!(
                    used.is_none() || is_allowed,
                    "{} uses {used:?}: {line}",
                    file.name
                );
            }
        }
    }
}

#[test]
fn architecture_files_of_the_library_make_no_circle() {
    assert_eq!(Sources::of("src").circle(), None);
}

#[test]
fn architecture_files_of_the_lab_make_no_circle() {
    assert_eq!(Sources::of("lab/src").circle(), None);
}

#[test]
fn architecture_files_of_xtask_make_no_circle() {
    assert_eq!(Sources::of("xtask/src").circle(), None);
}

#[test]
fn architecture_files_of_the_command_line_make_no_circle() {
    assert_eq!(Sources::of("cli/src").circle(), None);
}
