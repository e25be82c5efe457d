//! Reports: looking at results destroys none, and labels do not go stale.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;

use polars::prelude::*;

use crate::experiments::{OWN_ARM, run};
use crate::folder::{Folder, stderr, stdout};

const SMALL: &str = "name = 'small'\nseeds = 3\nbudget = { evaluations = 600 }\n\
    functions = { name = ['sphere'], dimension = [3] }\n[[optimiser]]\npso = { population = 20 }\n\
    [[optimiser]]\nrandom = {}\n";

/// The files of a report with their bytes, but for PDFs, whose objects have no fixed order.
fn report(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for part in ["tables", "figures"] {
        for entry in fs::read_dir(folder.join(part)).unwrap().map(Result::unwrap) {
            let name = format!("{part}/{}", entry.file_name().display());
            if entry.path().extension().is_none_or(|extension| extension != "pdf") {
                files.insert(name, fs::read(entry.path()).unwrap());
            }
        }
    }
    files.insert("report.html".to_owned(), fs::read(folder.join("report.html")).unwrap());
    files
}

/// An experiment that was changed and hardly begun takes nothing from the report of the complete one, nor from its file.
#[test]
fn a_report_of_more_runs_stays() {
    let longer = SMALL.replace("600", "700").replace("seeds = 3", "seeds = 4");
    let folder = Folder::new().with("small.toml", SMALL).with("longer.toml", longer);
    run(&folder, &["small.toml", "--out", "out"]);
    let out = folder.path().join("out");
    let (complete, file) = (report(&out), fs::read(out.join("experiment.toml")).unwrap());
    assert!(complete.len() > 15);

    let begun = folder.run(&["run", "longer.toml", "--out", "out", "--shard", "0/4"]);
    assert!(begun.status.success(), "{}", stderr(&begun));
    assert!(stderr(&begun).contains("runs of another version of this experiment"));
    let looked = folder.run(&["report", "out"]);
    let told = stderr(&looked);
    assert_eq!(looked.status.code(), Some(1), "{told}");
    assert!(stdout(&looked).contains("2 of 8 runs are stored so far"));
    assert!(told.contains("report.html shows 6 runs") && told.contains("--replace"), "{told}");
    assert!(told.contains("6 stored runs belong to another version of the experiment"), "{told}");
    assert!(report(&out) == complete);

    let elsewhere = folder.run(&["report", "out", "--out", "elsewhere"]);
    assert!(elsewhere.status.success(), "{}", stderr(&elsewhere));
    assert!(folder.path().join("elsewhere/report.html").is_file());
    assert!(report(&out) == complete);

    let earlier = fs::read_dir(out.join("earlier")).unwrap().next().unwrap().unwrap().path();
    let earlier = earlier.join("experiment.toml");
    assert_eq!(fs::read(&earlier).unwrap(), file);
    assert!(folder.run(&["report", "out", "--replace"]).status.success());
    assert!(report(&out) != complete);
    let again = folder.run(&["run", &earlier.display().to_string(), "--out", "out"]);
    assert!(stderr(&again).contains("6 of 6 runs are stored already"), "{}", stderr(&again));
    assert!(report(&out) == complete);
}

/// One experiment file with one robot after another in `arm.toml`: each version that has runs is kept with its robot.
#[test]
fn robots_of_earlier_versions_are_kept() {
    let task =
        OWN_ARM.replace("acceleration_deg_s2 = 70", "acceleration_deg_s2 = 70, jerk_deg_s3 = 80");
    let text = SMALL.replace("functions = { name = ['sphere'], dimension = [3] }", &task);
    let mut folder = Folder::new().with("small.toml", text);
    for mass in ["mass = 600", "mass = 700", "mass = 800"] {
        let arm = include_str!("../../src/robot/shipped/xiao2023.toml").replace("mass = 600", mass);
        folder = folder.with("arm.toml", arm);
        run(&folder, &["small.toml", "--out", "out"]);
    }
    let base = |folder: &Path| {
        let robot: toml::Table =
            fs::read_to_string(folder.join("robot.toml")).unwrap().parse().unwrap();
        robot["base"]["mass"].as_float().unwrap()
    };
    let out = folder.path().join("out");
    let entries = fs::read_dir(out.join("earlier")).unwrap();
    let mut kept: Vec<f64> = entries.map(|entry| base(&entry.unwrap().path())).collect();
    kept.sort_by(f64::total_cmp);
    assert_eq!((kept, base(&out)), (vec![600.0, 700.0], 800.0));
}

/// More seeds are no other version: nothing is left out.
#[test]
fn an_experiment_that_grows_replaces_its_report() {
    let folder = Folder::new().with("small.toml", SMALL);
    run(&folder, &["small.toml", "--out", "out"]);
    let more = folder.run(&["run", "small.toml", "--out", "out", "--seeds", "4"]);
    assert!(more.status.success() && !stderr(&more).contains("another"), "{}", stderr(&more));
    let out = folder.path().join("out");
    assert!(!out.join("earlier").exists());
    let rows = fs::read_to_string(out.join("tables/runs.csv")).unwrap().lines().count();
    assert_eq!(rows, 1 + 8);
}

/// A label that now stands for other settings: the list of the plan tells runs apart, as results/README.md joins them.
#[test]
fn listed_labels_are_those_of_today() {
    let more =
        SMALL.replace("[[optimiser]]\nrandom", "[[optimiser]]\npso = {}\n[[optimiser]]\nrandom");
    let folder = Folder::new().with("small.toml", SMALL).with("more.toml", more);
    run(&folder, &["small.toml", "--out", "out"]);
    run(&folder, &["more.toml", "--out", "out"]);
    let out = folder.path().join("out");
    let read = |path: &Path| ParquetReader::new(File::open(path).unwrap()).finish().unwrap();
    let plan = read(&out.join("plan.parquet"));
    let text = |frame: &DataFrame, column: &str| -> Vec<String> {
        frame.column(column).unwrap().str().unwrap().iter().map(|t| t.unwrap().to_owned()).collect()
    };
    let labels: BTreeMap<String, String> =
        text(&plan, "key").into_iter().zip(text(&plan, "optimiser")).collect();
    assert_eq!(labels.len(), 9);
    let mut settings: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for entry in fs::read_dir(out.join("runs")).unwrap() {
        let runs = read(&entry.unwrap().path());
        for (key, own) in text(&runs, "key").iter().zip(text(&runs, "settings")) {
            settings.entry(&labels[key]).or_default().push(own);
        }
    }
    assert_eq!(settings.len(), 3, "{settings:?}");
    for (label, own) in settings {
        assert!(own.len() == 3 && own.iter().all(|one| *one == own[0]), "{label}: {own:?}");
    }
}

/// An experiment, and the same in two parts whose folders have its runs: reported together they are the whole.
#[test]
fn parts_of_an_experiment_together_are_the_whole() {
    let whole = "name = 'whole'\nseeds = 3\nbudget = { evaluations = 600 }\n\
        functions = { name = ['sphere', 'rastrigin'], dimension = [3], instances = 2 }\n\
        [[optimiser]]\npso = { population = 20 }\n[[optimiser]]\nde = {}\n[[optimiser]]\nrandom = {}\n";
    let without = |texts: &[&str]| texts.iter().fold(whole.to_owned(), |t, s| t.replace(s, ""));
    let folder = Folder::new()
        .with("whole.toml", whole)
        .with("sphere.toml", without(&[", 'rastrigin'"]))
        .with("rastrigin.toml", without(&["'sphere', "]))
        .with("swarms.toml", without(&["[[optimiser]]\nde = {}\n", "[[optimiser]]\nrandom = {}\n"]))
        .with("others.toml", without(&["[[optimiser]]\npso = { population = 20 }\n"]));
    run(&folder, &["whole.toml", "--out", "whole"]);
    let path = |name: &str| folder.path().join(name);
    let tables = |folder: &Path| -> BTreeMap<String, Vec<u8>> {
        let files = report(folder).into_iter();
        files.filter(|(name, _)| name.starts_with("tables/") || name.contains(".svg")).collect()
    };
    for parts in [["sphere", "rastrigin"], ["swarms", "others"]] {
        for part in parts {
            for table in ["runs", "traces", "clocks"] {
                fs::create_dir_all(path(part).join(table)).unwrap();
                for entry in fs::read_dir(path("whole").join(table)).unwrap().map(Result::unwrap) {
                    fs::copy(entry.path(), path(part).join(table).join(entry.file_name())).unwrap();
                }
            }
            let file = format!("{part}.toml");
            let done = folder.run(&["run", &file, "--out", part]);
            assert!(stderr(&done).contains("are stored already"), "{}", stderr(&done));
        }
        let together = format!("{}-and-{}", parts[0], parts[1]);
        let alone = folder.run(&["report", parts[0], parts[1]]);
        assert!(stderr(&alone).contains("expected --out"), "{}", stderr(&alone));
        let output = folder.run(&["report", parts[0], parts[1], "--out", &together]);
        assert!(output.status.success(), "{}", stderr(&output));
        let (found, expected) = (tables(&path(&together)), tables(&path("whole")));
        assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
        for (name, bytes) in found {
            assert!(bytes == expected[&name], "{together}: {name}");
        }
    }
}

/// Different settings under one label, and different robots under none, keep their folder's name.
#[test]
fn what_differs_between_experiments_is_told_apart() {
    let folder = Folder::new()
        .with("small.toml", SMALL.replace("seeds = 3", "seeds = 1"))
        .with("large.toml", SMALL.replace("seeds = 3", "seeds = 1").replace("= 20", "= 30"));
    run(&folder, &["small.toml", "--out", "twenty"]);
    run(&folder, &["large.toml", "--out", "thirty"]);
    let output = folder.run(&["report", "twenty", "thirty", "--out", "both"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let table = fs::read_to_string(folder.path().join("both/tables/summary.csv")).unwrap();
    for label in ["pso (twenty)", "pso (thirty)", "random"] {
        assert_eq!(table.matches(&format!(",{label},")).count(), 1, "{label}: {table}");
    }
    let twice = folder.run(&["report", "twenty", "twenty", "--out", "both"]);
    assert!(stderr(&twice).contains("one folder of results twice"), "{}", stderr(&twice));
}
