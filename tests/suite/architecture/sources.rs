//! The source files of a crate, and which of them uses which.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A path of modules and items from the crate's root.
type Place = Vec<String>;

/// A source file.
pub struct File {
    /// From the folder of the sources, with slashes.
    pub name: String,
    /// Lines of code: comments are free to mention anything.
    pub lines: Vec<String>,
    module: Place,
    /// What its `use` items bring in: a name, and where it is from.
    uses: Vec<(String, Place)>,
    /// Other paths that begin with `crate`, `self` or `super`.
    paths: Vec<Place>,
}

/// The files of a crate.
pub struct Sources {
    pub files: Vec<File>,
    by_module: BTreeMap<Place, usize>,
}

impl Sources {
    /// All files in a folder of the repository.
    pub fn of(folder: &str) -> Sources {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let mut paths = Vec::new();
        collect(&root, &mut paths);
        paths.sort();
        let files: Vec<File> = paths.iter().map(|path| File::read(&root, path)).collect();
        let modules = files.iter().map(|file| file.module.clone());
        Sources {
            by_module: modules.zip(0..).collect(),
            files,
        }
    }

    /// Pairs of files, the first of which uses the second. A name that a module only passes on is followed to the file that has it.
    pub fn arrows(&self) -> BTreeSet<(usize, usize)> {
        let mut arrows = BTreeSet::new();
        for (user, file) in self.files.iter().enumerate() {
            let uses = file.uses.iter().map(|(_, place)| place);
            let used = uses.chain(&file.paths).filter_map(|place| self.find(place));
            arrows.extend(used.filter(|used| *used != user).map(|used| (user, used)));
        }
        arrows
    }

    /// Files that use each other, in a circle, if there are any. That a module declares, and passes on, what is in its own folder
    /// makes none.
    pub fn circle(&self) -> Option<Vec<&str>> {
        let module = |file: usize| &self.files[file].module;
        let is_own = |&(user, used): &(usize, usize)| module(used).starts_with(module(user));
        let arrows: BTreeSet<_> = self
            .arrows()
            .into_iter()
            .filter(|arrow| !is_own(arrow))
            .collect();
        (0..self.files.len()).find_map(|start| {
            let mut ways = vec![vec![start]];
            let mut seen = BTreeSet::new();
            while let Some(way) = ways.pop() {
                let last = way[way.len() - 1];
                for &(_, next) in arrows.range((last, 0)..(last + 1, 0)) {
                    if next == start {
                        return Some(way.iter().map(|&file| &*self.files[file].name).collect());
                    }
                    if seen.insert(next) {
                        ways.push([&way[..], &[next]].concat());
                    }
                }
            }
            None
        })
    }

    /// The file that has what is at a place.
    fn find(&self, place: &[String]) -> Option<usize> {
        let mut place = place.to_vec();
        // Passed on from module to module, at most so often.
        for _ in 0..8 {
            let (depth, file) = (0..=place.len())
                .rev()
                .find_map(|depth| Some((depth, *self.by_module.get(&place[..depth])?)))?;
            let passed_on = place.get(depth).and_then(|name| {
                let mut uses = self.files[file].uses.iter();
                uses.find(|(own, _)| own == name)
            });
            match passed_on {
                Some((_, from)) if *from != place => place = [from, &place[depth + 1..]].concat(),
                _ => return Some(file),
            }
        }
        None
    }
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, paths);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            paths.push(path);
        }
    }
}

impl File {
    fn read(root: &Path, path: &Path) -> File {
        let name = path.strip_prefix(root).unwrap().to_str().unwrap();
        let name = name.replace(std::path::MAIN_SEPARATOR, "/");
        let mut module: Place = name
            .trim_end_matches(".rs")
            .split('/')
            .map(str::to_owned)
            .collect();
        if matches!(
            module.last().map(String::as_str),
            Some("mod" | "lib" | "main")
        ) {
            module.pop();
        }
        let source = fs::read_to_string(path).unwrap();
        let lines = source
            .lines()
            .map(|line| line.split("// ").next().unwrap_or(""));
        let lines = lines.filter(|line| !line.trim_start().starts_with("//"));
        let mut file = File {
            lines: lines.map(str::to_owned).collect(),
            name,
            module,
            uses: Vec::new(),
            paths: Vec::new(),
        };
        file.read_lines();
        file
    }

    fn read_lines(&mut self) {
        let mut at = self.module.clone();
        let mut item = String::new();
        for line in self.lines.clone() {
            let words = line.trim_start();
            // A module within a file, which ends where its brace is closed at the margin.
            if let Some(name) = line
                .strip_prefix("mod ")
                .and_then(|rest| rest.strip_suffix(" {"))
            {
                at.push(name.to_owned());
            } else if line == "}" {
                at.clone_from(&self.module);
            }
            let begins =
                words.starts_with("use ") || words.starts_with("pub") && words.contains(" use ");
            if begins || !item.is_empty() {
                item.push_str(words);
                if line.ends_with(';') {
                    let (_, tree) = item.split_once("use ").unwrap();
                    let tree = tree.trim_end_matches(';');
                    expand(&[], tree, &mut |name, path| {
                        self.uses
                            .extend(absolute(&at, &path).map(|place| (name, place)));
                    });
                    item.clear();
                }
            } else {
                let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
                for path in line.split(|c| !is_path(c)) {
                    let path: Place = path
                        .trim_matches(':')
                        .split("::")
                        .map(str::to_owned)
                        .collect();
                    if path.len() > 1 {
                        self.paths.extend(absolute(&at, &path));
                    }
                }
            }
        }
    }
}

/// Calls `each` with every name that a tree of `use` brings in, and its path.
fn expand(before: &[String], tree: &str, each: &mut impl FnMut(String, Place)) {
    let tree = tree.trim();
    if let Some((head, group)) = tree.split_once('{') {
        let head = head.trim().trim_end_matches("::");
        let head = head
            .split("::")
            .filter(|part| !part.is_empty())
            .map(str::to_owned);
        let before: Place = before.iter().cloned().chain(head).collect();
        let group = group.trim_end().trim_end_matches('}');
        let (mut depth, mut start) = (0, 0);
        for (place, c) in group.char_indices().chain([(group.len(), ',')]) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    if !group[start..place].trim().is_empty() {
                        expand(&before, &group[start..place], each);
                    }
                    start = place + 1;
                }
                _ => {}
            }
        }
        return;
    }
    let (path, name) = tree.split_once(" as ").unwrap_or((tree, ""));
    let mut path: Place = before
        .iter()
        .cloned()
        .chain(path.split("::").map(|part| part.trim().to_owned()))
        .collect();
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let name = if name.is_empty() {
        path[path.len() - 1].clone()
    } else {
        name.trim().to_owned()
    };
    each(name, path);
}

/// Where a path leads that is written in a module; `None` for paths into other crates.
fn absolute(module: &[String], path: &[String]) -> Option<Place> {
    let mut place = match path[0].as_str() {
        "crate" => Vec::new(),
        "self" | "super" => module.to_vec(),
        _ => {
            return Some([module, path].concat())
                .filter(|_| path[0].starts_with(char::is_lowercase));
        }
    };
    for part in path {
        match part.as_str() {
            "crate" | "self" => {}
            "super" => {
                place.pop()?;
            }
            _ => place.push(part.clone()),
        }
    }
    Some(place)
}
