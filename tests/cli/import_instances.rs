//! Which instances imported exports are taken for: exports of one instance may have several numbers, and one number may stand for
//! several instances.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::folder::Folder;
use crate::import::{ok, rows};

/// One random run on an instance of the paper's task for each of these budgets. They are one instance for `numbers`, so the second
/// takes the next free number.
fn budgets(all: &str) -> String {
    format!("name = 'task'\nseeds = 1\n[sweep]\nbudget = [{all}]\n[[optimiser]]\nrandom = {{}}\n")
}

fn spheres(count: u32, optimiser: &str) -> String {
    format!(
        "name = 'spheres'\nseeds = 1\nbudget = {{ evaluations = 40 }}\n[functions]\nname = ['sphere']\n\
         dimension = [2]\ninstances = {count}\n[[optimiser]]\n{optimiser} = {{}}\n"
    )
}

/// How many runs a report has on each instance.
fn counts(report: &Path) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for row in rows(&report.join("tables/runs.csv")) {
        *counts.entry(row["instance"].clone()).or_default() += 1;
    }
    counts
}

fn expected<const N: usize>(counts: [(&str, usize); N]) -> BTreeMap<String, usize> {
    counts.map(|(label, count)| (label.to_owned(), count)).into()
}

/// The indexes of an export.
fn indexes(export: &Path) -> Vec<PathBuf> {
    let folders = fs::read_dir(export).unwrap().map(|entry| entry.unwrap().path());
    let files = folders.flat_map(|folder| fs::read_dir(folder).unwrap());
    let files = files.map(|entry| entry.unwrap().path());
    files.filter(|file| file.extension().is_some_and(|e| e == "json" || e == "info")).collect()
}

fn edit(export: &Path, change: impl Fn(&str) -> String) {
    let indexes = indexes(export);
    assert!(!indexes.is_empty());
    for index in indexes {
        let text = fs::read_to_string(&index).unwrap();
        let changed = change(&text);
        assert_ne!(changed, text);
        fs::write(&index, changed).unwrap();
    }
}

/// An index as exports without digests have it.
fn without_digests(text: &str) -> String {
    if let Some((before, behind)) = text.split_once("; digests of instances ") {
        let (_, after) = behind.split_once(';').unwrap();
        return format!("{before};{after}");
    }
    let lines = text.lines().filter(|line| !line.contains("\"digest\":"));
    lines.collect::<Vec<_>>().join("\n").replace(",\n        }", "\n        }")
}

#[test]
fn an_instance_is_met_under_whatever_number_it_was_exported() {
    let folder = Folder::new().with("two.toml", budgets("40, 80")).with("one.toml", budgets("80"));
    for name in ["one", "two"] {
        ok(&folder, &["run", &format!("{name}.toml"), "--out", name]);
    }
    for format in ["ioh", "coco"] {
        let exported = format!("exported-{format}");
        ok(&folder, &["export", "two", "--format", format, "--out", &exported]);
        ok(&folder, &["import", "--format", format, &exported, "--out", format]);
    }
    ok(&folder, &["report", "one", "ioh", "coco", "--out", "all"]);
    let counts = counts(&folder.path().join("all"));
    assert_eq!(counts.len(), 2, "{counts:?}");
    assert_eq!(counts["budget=80"], 3, "{counts:?}");
}

/// The same number with another digest is another instance, and with one that is known that one; in one folder, too.
#[test]
fn a_number_may_stand_for_several_instances() {
    let folder =
        Folder::new().with("one.toml", spheres(1, "pso")).with("two.toml", spheres(2, "random"));
    for name in ["one", "two"] {
        ok(&folder, &["run", &format!("{name}.toml"), "--out", name]);
        let exported = format!("exported/{name}");
        fs::create_dir_all(folder.path().join("exported")).unwrap();
        ok(&folder, &["export", name, "--format", "ioh", "--out", &exported]);
    }
    edit(&folder.path().join("exported/one"), |text| {
        text.replace("\"instance\": 1", "\"instance\": 2")
    });
    let told = ok(&folder, &["import", "--format", "ioh", "exported", "--out", "back"]);
    assert!(told.contains("3 runs of 2 optimisers on 2 instances"), "{told}");
    ok(&folder, &["report", "two", "back", "--out", "both"]);
    let of = [("sphere dimension=2 instance=1", 3), ("sphere dimension=2 instance=2", 2)];
    assert_eq!(counts(&folder.path().join("both")), expected(of));
}

/// Data without digests: numbers of test functions say what they are, numbers that were worked out do not.
#[test]
fn without_digests_only_known_numbers_count() {
    let folder =
        Folder::new().with("task.toml", budgets("80")).with("spheres.toml", spheres(2, "random"));
    for name in ["task", "spheres"] {
        ok(&folder, &["run", &format!("{name}.toml"), "--out", name]);
        for format in ["ioh", "coco"] {
            let [exported, back] =
                ["exported", "back"].map(|what| format!("{what}-{name}-{format}"));
            ok(&folder, &["export", name, "--format", format, "--out", &exported]);
            edit(&folder.path().join(&exported), without_digests);
            ok(&folder, &["import", "--format", format, &exported, "--out", &back]);
        }
        let imported = ["ioh", "coco"].map(|format| format!("back-{name}-{format}"));
        ok(&folder, &["report", name, &imported[0], &imported[1], "--out", &format!("all-{name}")]);
    }
    let of = [("sphere dimension=2 instance=1", 3), ("sphere dimension=2 instance=2", 3)];
    assert_eq!(counts(&folder.path().join("all-spheres")), expected(of));
    let tasks = counts(&folder.path().join("all-task"));
    assert_eq!((tasks.len(), tasks["budget=80"]), (3, 1), "{tasks:?}");
}
