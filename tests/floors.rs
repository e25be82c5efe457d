//! The structure of the crate, as `ARCHITECTURE.md` has it: a module uses only modules on floors below its own, the
//! harness nothing of the planner nor the planner of the harness, and no files of a module use each other in a circle.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Where a module stands.
#[derive(Debug, Clone, PartialEq)]
struct Place {
    wing: String,
    floor: u32,
}

/// Every module's place, from the table in `ARCHITECTURE.md`.
fn places() -> BTreeMap<String, Place> {
    let text = fs::read_to_string("ARCHITECTURE.md").unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.strip_prefix("| ")?.split(" | ").map(str::trim).collect();
        let [floor, wing, names, _] = cells[..] else { return None };
        let place = Place { wing: wing.to_owned(), floor: floor.parse().ok()? };
        let names = names.split('`').skip(1).step_by(2).map(str::to_owned);
        Some(names.map(|name| (name, place.clone())).collect::<Vec<_>>())
    };
    text.lines().filter_map(row).flatten().collect()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] });
    files.filter(|path| path.extension().is_some_and(|e| e == "rs")).collect()
}

/// A source file: its path within the crate, such as `[analysis, tables, best]`, and its text.
struct Source {
    path: Vec<String>,
    is_folder: bool,
    text: String,
}

/// All source files but the crate's root, without comments.
fn sources() -> Vec<Source> {
    let source = |file: PathBuf| {
        let text = fs::read_to_string(&file).unwrap();
        let code = |line: &str| line.split("//").next().unwrap().to_owned();
        let text: Vec<String> = text.lines().map(code).collect();
        let file = file.strip_prefix("src").unwrap().with_extension("");
        let mut path: Vec<String> =
            file.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
        let is_folder = path.last().is_some_and(|name| name == "mod");
        path.truncate(path.len() - usize::from(is_folder));
        Source { path, is_folder, text: text.join("\n") }
    };
    let sources = files(Path::new("src")).into_iter().map(source);
    sources.filter(|s| !["lib", "main"].contains(&s.path[0].as_str())).collect()
}

/// Every module named behind `crate::`, also within braces.
fn modules_used(text: &str) -> Vec<String> {
    let word =
        |s: &str| s.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap().to_owned();
    text.split("crate::")
        .skip(1)
        .flat_map(|rest| match rest.strip_prefix('{') {
            // What stands deeper in a list of imports belongs to a module named before it.
            Some(list) => {
                list.split('}').next().unwrap().split(',').map(|s| word(s.trim())).collect()
            }
            None => vec![word(rest)],
        })
        .collect()
}

#[test]
fn imports_point_downwards_and_stay_in_their_wing() {
    let places = places();
    let place = |module: &str| {
        places.get(module).unwrap_or_else(|| panic!("`{module}` has no floor in ARCHITECTURE.md"))
    };
    let mut seen = 0;
    for source in sources() {
        let module = &source.path[0];
        let own = place(module);
        for used in modules_used(&source.text) {
            let other = place(&used);
            let from = source.path.join("/");
            assert!(
                other.floor < own.floor || used == *module,
                "{from} ({own:?}) uses `{used}` ({other:?}): upwards"
            );
            let is_allowed =
                own.wing == "both" || other.wing == "basement" || other.wing == own.wing;
            assert!(is_allowed, "{from} ({own:?}) uses `{used}` ({other:?}): another wing");
            seen += 1;
        }
    }
    assert!(seen > 200, "only {seen} uses found: is the pattern still right?");
}

/// The folders that must know nothing of the task, whatever the table says, and what they must not name.
#[test]
fn the_harness_does_not_name_the_planner() {
    const HARNESS: [&str; 7] =
        ["experiment", "analysis", "plot", "report", "export", "optimiser", "search"];
    const PLANNER: [&str; 9] = [
        "task",
        "dynamics",
        "reorientation",
        "robot",
        "trajectory",
        "attitude",
        "momentum",
        "posture",
        "kinematics",
    ];
    for source in sources().iter().filter(|source| HARNESS.contains(&source.path[0].as_str())) {
        for used in modules_used(&source.text) {
            assert!(!PLANNER.contains(&used.as_str()), "{} uses `{used}`", source.path.join("/"));
        }
    }
}

/// The paths that the `use` declarations of a text name, in full, and whether they are re-exports.
fn imports(text: &str) -> Vec<(Vec<String>, bool)> {
    let mut imports = Vec::new();
    let starts = text.match_indices("use ").filter(|(at, _)| {
        let line = text[..*at].rsplit('\n').next().unwrap().trim();
        line.is_empty() || line.starts_with("pub")
    });
    for (at, word) in starts {
        let line = text[..at].rsplit('\n').next().unwrap();
        let Some(tree) = text[at + word.len()..].split(';').next() else { continue };
        let tree: String = tree.split_whitespace().collect::<Vec<_>>().join(" ");
        let mut paths = Vec::new();
        expand(&tree, &[], &mut paths);
        imports.extend(paths.into_iter().map(|path| (path, line.trim().starts_with("pub"))));
    }
    imports
}

/// Spells a tree of imports out.
fn expand(tree: &str, before: &[String], paths: &mut Vec<Vec<String>>) {
    let tree = tree.trim();
    let Some((head, list)) = tree.split_once('{') else {
        let tree = tree.split(" as ").next().unwrap();
        let own = tree.split("::").map(|part| part.trim().to_owned());
        paths.push(before.iter().cloned().chain(own).collect());
        return;
    };
    let head = head.trim_end_matches("::").split("::").filter(|part| !part.trim().is_empty());
    let head: Vec<String> =
        before.iter().cloned().chain(head.map(|part| part.trim().to_owned())).collect();
    let (mut depth, mut part) = (0, String::new());
    for c in list[..list.rfind('}').unwrap_or(list.len())].chars() {
        match c {
            ',' if depth == 0 => expand(&std::mem::take(&mut part), &head, paths),
            _ => {
                depth += i32::from(c == '{') - i32::from(c == '}');
                part.push(c);
            }
        }
    }
    if !part.trim().is_empty() {
        expand(&part, &head, paths);
    }
}

/// The files of a module as a graph: which uses which.
struct Graph<'a> {
    files: BTreeMap<Vec<String>, &'a Source>,
}

impl Graph<'_> {
    /// Where a path leads that stands in a file: the file that defines what it names, through re-exports.
    fn resolve(&self, from: &[String], path: &[String], depth: usize) -> Option<Vec<String>> {
        let mut at = from.to_vec();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => {
                at.clear();
                rest = &path[1..];
            }
            "self" => rest = &path[1..],
            "super" => {
                while rest.first().is_some_and(|part| part == "super") {
                    at.pop();
                    rest = &rest[1..];
                }
            }
            // A child's name, in the file of a folder.
            name => {
                let child: Vec<String> = at.iter().cloned().chain([name.to_owned()]).collect();
                self.files.contains_key(&child).then_some(())?;
            }
        }
        while let Some(name) = rest.first() {
            let child: Vec<String> = at.iter().cloned().chain([name.clone()]).collect();
            if !self.files.contains_key(&child) {
                break;
            }
            at = child;
            rest = &rest[1..];
        }
        let file = self.files.get(&at)?;
        let Some(name) = rest.first().filter(|_| file.is_folder && depth > 0) else {
            return Some(at);
        };
        let exported = imports(&file.text)
            .into_iter()
            .find(|(path, is_export)| *is_export && path.last() == Some(name) && path.len() > 1);
        match exported {
            Some((path, _)) => self.resolve(&at, &path, depth - 1).or(Some(at)),
            None => Some(at),
        }
    }

    /// The files that a file uses, but for what a folder's file only hands on.
    fn used(&self, source: &Source) -> BTreeSet<Vec<String>> {
        let imports = imports(&source.text).into_iter();
        let own = imports.filter(|(_, is_export)| !(source.is_folder && *is_export));
        let used = own.filter_map(|(path, _)| self.resolve(&source.path, &path, 8));
        used.filter(|path| *path != source.path && path.first() == source.path.first()).collect()
    }
}

/// Whether a file is a test's.
fn is_test(source: &Source, folders: &BTreeMap<Vec<String>, &Source>) -> bool {
    let Some((name, folder)) = source.path.split_last() else { return false };
    let declares = |text: &str| {
        let declared = [format!("mod {name};"), format!("pub(crate) mod {name};")];
        declared.iter().any(|mod_line| text.contains(&format!("#[cfg(test)]\n{mod_line}")))
    };
    folders.get(folder).is_some_and(|folder| declares(&folder.text))
}

#[test]
fn no_files_of_a_module_use_each_other_in_a_circle() {
    let sources = sources();
    let all: BTreeMap<Vec<String>, &Source> =
        sources.iter().map(|source| (source.path.clone(), source)).collect();
    let without_tests = |source: &&Source| !is_test(source, &all);
    let files = sources.iter().filter(without_tests).map(|s| (s.path.clone(), s)).collect();
    let graph = Graph { files };
    let mut uses: BTreeMap<&Vec<String>, BTreeSet<Vec<String>>> = BTreeMap::new();
    for (path, source) in &graph.files {
        let code = source.text.split("#[cfg(test)]\nmod tests {").next().unwrap().to_owned();
        let code = Source { path: path.clone(), is_folder: source.is_folder, text: code };
        uses.insert(path, graph.used(&code));
    }
    assert!(uses.values().map(BTreeSet::len).sum::<usize>() > 200, "too few uses are seen");
    // Takes away files that use nothing of what is left, until none is left or only circles.
    loop {
        let free: Vec<Vec<String>> = uses
            .iter()
            .filter(|(_, used)| used.is_empty())
            .map(|(path, _)| (*path).clone())
            .collect();
        if free.is_empty() {
            break;
        }
        uses.retain(|path, _| !free.contains(path));
        for used in uses.values_mut() {
            used.retain(|path| !free.contains(path));
        }
    }
    // And those that nothing left uses.
    loop {
        let used: BTreeSet<Vec<String>> = uses.values().flatten().cloned().collect();
        let before = uses.len();
        uses.retain(|path, _| used.contains(*path));
        if uses.len() == before {
            break;
        }
    }
    let told: Vec<String> = uses
        .iter()
        .map(|(path, used)| {
            let used: Vec<String> = used.iter().map(|path| path.join("/")).collect();
            format!("{} -> {}", path.join("/"), used.join(", "))
        })
        .collect();
    assert!(told.is_empty(), "circles:\n{}", told.join("\n"));
}

/// A file that neither `tests/all.rs` nor `Cargo.toml` names would not be compiled.
#[test]
fn every_file_of_tests_is_run() {
    let [modules, programs] =
        ["tests/all.rs", "Cargo.toml"].map(|file| fs::read_to_string(file).unwrap());
    let files = files(Path::new("tests"));
    let own = files.iter().filter(|file| file.parent() == Some(Path::new("tests")));
    let names: Vec<_> = own.filter_map(|file| file.file_stem()?.to_str()).collect();
    assert!(names.len() > 30, "{names:?}");
    for name in names {
        let is_named = modules.contains(&format!("mod {name};"))
            || programs.contains(&format!("[[test]]\nname = \"{name}\""));
        assert!(is_named, "tests/all.rs does not name {name}");
    }
}
