//! A module uses only modules on floors below its own; the floors are those of `ARCHITECTURE.md`.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Module and floor, from the table in `ARCHITECTURE.md`.
fn floors() -> HashMap<String, u32> {
    let text = fs::read_to_string("ARCHITECTURE.md").unwrap();
    let rows = text.lines().filter_map(|line| {
        let mut cells = line.strip_prefix("| ")?.split(" | ");
        let floor = cells.next()?.trim().parse().ok()?;
        let names = cells.next()?.split('`').skip(1).step_by(2);
        Some(names.map(|n| (n.to_owned(), floor)).collect::<Vec<_>>())
    });
    rows.flatten().collect()
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .collect()
}

/// Every module named behind `crate::`, also within braces.
fn uses(text: &str) -> Vec<String> {
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
fn imports_point_downwards() {
    let floors = floors();
    let mut seen = 0;
    for path in sources(Path::new("src")) {
        let module = path.strip_prefix("src").unwrap().components().next().unwrap();
        let module = module.as_os_str().to_str().unwrap().trim_end_matches(".rs").to_owned();
        if module == "lib" || module == "main" {
            continue;
        }
        let own = floors.get(&module).unwrap_or_else(|| panic!("`{module}` has no floor"));
        for used in uses(&fs::read_to_string(&path).unwrap()) {
            let floor = floors.get(&used).unwrap_or_else(|| panic!("`{used}` has no floor"));
            assert!(
                floor < own || used == module,
                "{} (floor {own}) uses `{used}` (floor {floor})",
                path.display()
            );
            seen += 1;
        }
    }
    assert!(seen > 50, "only {seen} uses found: is the pattern still right?");
}
