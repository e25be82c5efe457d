//! What `import` makes of other tools' files, and what `report` makes of that beside others. `tests/import/make.py` has made the
//! data with the tools whose formats they are; what is in `csv` and `old` was written by hand.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use polars::prelude::*;
use serde_json::Value;

use crate::folder::{Folder, stderr, stdout};

/// Where some data are.
pub(crate) fn data(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/import").join(name).display().to_string()
}

pub(crate) fn ok(folder: &Folder, args: &[&str]) -> String {
    let output = folder.run(args);
    assert!(output.status.success(), "{args:?}: {}", stderr(&output));
    stdout(&output) + &stderr(&output)
}

/// A folder with the results of data.
pub(crate) fn imported(format: &str) -> (Folder, String) {
    let folder = Folder::new();
    let told = ok(&folder, &["import", "--format", format, &data(format), "--out", "theirs"]);
    (folder, told)
}

/// The rows of a CSV table, by the names of columns.
pub(crate) fn rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    let text =
        fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    csv::Reader::from_reader(text.as_bytes()).deserialize().map(Result::unwrap).collect()
}

/// Traces by instance, optimiser and seed.
fn traces(results: &Path) -> BTreeMap<(String, String, u64), Vec<(u64, f64)>> {
    let table = |name: &str| {
        let files = fs::read_dir(results.join(name)).unwrap();
        let path = files.map(|file| file.unwrap().path()).next().unwrap();
        ParquetReader::new(fs::File::open(path).unwrap()).finish().unwrap()
    };
    let (runs, steps) = (table("runs"), table("traces"));
    let text = |frame: &DataFrame, name: &str, row: usize| {
        frame.column(name).unwrap().str().unwrap().get(row).unwrap().to_owned()
    };
    let mut traces = BTreeMap::new();
    for row in 0..runs.height() {
        let key = text(&runs, "key", row);
        let seed = runs.column("seed").unwrap().u64().unwrap().get(row).unwrap();
        let of = (text(&runs, "instance", row), text(&runs, "optimiser", row), seed);
        let own = (0..steps.height()).filter(|step| text(&steps, "key", *step) == key);
        let step = |step: usize| {
            let evaluation = steps.column("evaluation").unwrap().u64().unwrap().get(step).unwrap();
            (evaluation, steps.column("j").unwrap().f64().unwrap().get(step).unwrap())
        };
        traces.insert(of, own.map(step).collect());
    }
    traces
}

fn run(instance: &str, optimiser: &str, seed: u64) -> (String, String, u64) {
    (instance.to_owned(), optimiser.to_owned(), seed)
}

/// The first run of `uniform` on the sphere: the rows of its table, and the best of its index with all digits.
#[test]
fn iohprofiler_data_are_read_as_they_are() {
    let (folder, told) = imported("ioh");
    assert!(told.contains("theirs: 16 runs of 2 optimisers on 4 instances"), "{told}");
    assert!(told.contains("name no seeds") && told.contains("name no budget"), "{told}");
    let traces = traces(&folder.path().join("theirs"));
    assert_eq!(traces.len(), 16);
    let table =
        fs::read_to_string(data("ioh/uniform/data_f1_Sphere/IOHprofiler_f1_DIM2.dat")).unwrap();
    let row = |line: &str| {
        let mut words = line.split(' ');
        (words.next().unwrap().parse().unwrap(), words.next().unwrap().parse::<f64>().unwrap())
    };
    let first: Vec<(u64, f64)> =
        table.lines().skip(1).take_while(|line| !line.starts_with("eval")).map(row).collect();
    let found = &traces[&run("bbob f1 Sphere dimension=2 instance=1", "uniform", 1)];
    assert_eq!(found.len(), first.len());
    for ((evaluation, cost), (at, logged)) in found.iter().zip(&first).take(first.len() - 1) {
        assert_eq!(evaluation, at);
        assert!((cost - logged).abs() < 1e-9, "{cost} {logged}");
    }
    let (last, best) = found[found.len() - 1];
    assert_eq!(last, 60);
    assert!((best - 0.231_787_250_178_264_38).abs() < 1e-10);
    let rosenbrock = run("bbob f8 Rosenbrock dimension=2 instance=2", "narrow", 2);
    assert_eq!(traces[&rosenbrock].last().unwrap().0, 60);
}

/// A run of one evaluation ends where the next begins, with a heading between them or without.
#[test]
fn runs_of_one_evaluation_are_told_apart() {
    let index = "{\"suite\": \"\", \"function_id\": 1, \"algorithm\": {\"name\": \"a\"}, \"scenarios\": [{\"dimension\": 2,\
        \"path\": \"a.dat\", \"runs\": [{\"instance\": 1, \"evals\": 1}, {\"instance\": 1, \"evals\": 1}, {\"instance\": 1,\
        \"evals\": 3}]}]}";
    let folder = Folder::new()
        .with("IOHprofiler_f1.json", index)
        .with("a.dat", "evaluations raw_y\n1 5\n1 4\n1 3\n3 2\n");
    ok(&folder, &["import", "--format", "ioh", "IOHprofiler_f1.json", "--out", "theirs"]);
    let traces = traces(&folder.path().join("theirs"));
    let on = "f1 dimension=2 instance=1";
    assert_eq!(traces[&run(on, "a", 1)], [(1, 5.0)]);
    assert_eq!(traces[&run(on, "a", 2)], [(1, 4.0)]);
    assert_eq!(traces[&run(on, "a", 3)], [(1, 3.0), (3, 2.0)]);
}

/// The rows of `.dat` on the sphere are kept, with those of `.tdat` that are improvements, too.
#[test]
fn coco_data_are_differences_from_the_optimum() {
    let (folder, told) = imported("coco");
    assert!(told.contains("theirs: 8 runs of 1 optimiser on 8 instances"), "{told}");
    assert!(told.contains("costs are differences from the optimum"), "{told}");
    let expected: Vec<(u64, f64)> = [
        (1, 2.559_067_294),
        (13, 0.811_934_385_2),
        (18, 0.548_757_404_5),
        (38, 0.231_787_250_2),
        (60, 0.231_787_250_2),
    ]
    .to_vec();
    let traces = traces(&folder.path().join("theirs"));
    let found = &traces[&run("bbob f1 Sphere dimension=2 instance=1", "uniform", 1)];
    let is_row = |step: &&(u64, f64)| expected.iter().any(|row| row.0 == step.0);
    assert_eq!(found.iter().filter(is_row).copied().collect::<Vec<_>>(), expected);
    let experiment = fs::read_to_string(folder.path().join("theirs/experiment.toml")).unwrap();
    assert_eq!(experiment.matches("least_cost = 0").count(), 8, "{experiment}");
}

/// Both tools' loggers have seen the same points of the same functions, and tell the same of them: what IOHprofiler calls
/// `uniform` and COCO calls so are level on every instance that both have.
#[test]
fn bbob_of_both_tools_meets_beside_ours() {
    let folder = Folder::new().with("ours.toml", FUNCTIONS);
    ok(&folder, &["run", "ours.toml", "--out", "ours", "--seeds", "1"]);
    ok(&folder, &["import", "--format", "ioh", &data("ioh"), "--out", "ioh"]);
    ok(&folder, &["import", "--format", "coco", &data("coco"), "--out", "coco"]);
    let told = ok(&folder, &["report", "ours", "ioh", "coco", "--out", "all"]);
    assert!(told.contains("from IOHprofiler data in `ioh`: narrow and uniform (ioh)"), "{told}");
    let runs = rows(&folder.path().join("all/tables/runs.csv"));
    assert_eq!(runs.len(), 24 + 16 + 8);
    for number in [1, 2] {
        for function in ["f1 Sphere", "f8 Rosenbrock"] {
            let on = format!("bbob {function} dimension=2 instance={number}");
            let costs = |optimiser: &str| -> Vec<f64> {
                let own =
                    runs.iter().filter(|r| r["instance"] == on && r["optimiser"] == optimiser);
                own.map(|row| row["best f"].parse().unwrap()).collect()
            };
            let (ioh, coco) = (costs("uniform (ioh)"), costs("uniform (coco)"));
            assert_eq!((ioh.len(), coco.len()), (2, 1), "{on}: {runs:?}");
            assert!((ioh[0] - coco[0]).abs() < 1e-9 * coco[0], "{on}: {ioh:?} {coco:?}");
        }
    }
}

/// Files of 2009: no suite, other columns, paths of Windows, several tables of an entry, a run that was not ended.
#[test]
fn old_coco_data_are_read() {
    let folder = Folder::new();
    let told = ok(&folder, &["import", "--format", "coco", &data("old"), "--out", "old"]);
    assert!(told.contains("3 runs of 1 optimiser on 2 instances"), "{told}");
    assert!(told.contains("costs are differences"), "{told}");
    let traces = traces(&folder.path().join("old"));
    let name = "Old, 'quoted' and all";
    let expected = [
        (("f2 dimension=2 instance=1", 1), vec![(1, 8.0), (10, 0.5), (20, -1e-9)]),
        (("f2 dimension=2 instance=1", 2), vec![(1, 6.0), (30, 0.4)]),
        (("f2 dimension=2 instance=2", 1), vec![(1, 3.0), (4, 2.0)]),
    ];
    assert_eq!(traces.len(), expected.len());
    for ((instance, seed), trace) in expected {
        assert_eq!(traces[&run(instance, name, seed)], trace, "{instance} {seed}");
    }
}

#[test]
fn rows_of_a_long_table_may_stand_in_any_order() {
    let (folder, _) = imported("csv");
    let traces = traces(&folder.path().join("theirs"));
    let on = "sphere dimension=2 instance=1";
    assert_eq!(traces[&run(on, "theirs", 7)], [(1, 4.0), (10, 1.0), (30, 0.25)]);
    assert_eq!(traces[&run(on, "theirs", 9)], [(5, 0.5), (100, 0.5)]);
    assert_eq!(traces[&run("well, \"known\"", "theirs", 1)], [(3, -2.0)]);
}

/// Nothing that is not known stops a verb; what is imported is called so.
#[test]
fn every_verb_takes_an_imported_folder() {
    for format in ["ioh", "coco", "csv"] {
        let (folder, _) = imported(format);
        let status = ok(&folder, &["status", "theirs"]);
        assert!(status.contains("imported from") && status.contains("0 missing"), "{status}");
        let status: Value =
            serde_json::from_str(&ok(&folder, &["status", "theirs", "--json"])).unwrap();
        assert!(status["imported"].as_str().unwrap().contains(format), "{status}");
        assert_eq!(status["damaged"].as_array().unwrap().len(), 0, "{status}");
        let report = ok(&folder, &["report", "theirs"]);
        assert!(report.contains("Is anything imported?"), "{report}");
        assert!(!report.contains("found nothing"), "{report}");
        let page = fs::read_to_string(folder.path().join("theirs/report.html")).unwrap();
        assert!(page.contains("Imported from"));
        let figures = fs::read_dir(folder.path().join("theirs/figures")).unwrap().count();
        assert!(figures >= 9, "{figures}");
        ok(&folder, &["compact", "theirs"]);
        for export in ["ioh", "coco"] {
            ok(&folder, &["export", "theirs", "--format", export, "--out", export]);
        }
        let again = folder.run(&["run", "theirs/experiment.toml", "--out", "theirs"]);
        assert!(stderr(&again).contains("were imported"), "{}", stderr(&again));
        assert_eq!(again.status.code(), Some(2));
        let own = Folder::new().with("theirs.toml", FUNCTIONS.replace("ours", "theirs"));
        let onto = folder.path().join("theirs").display().to_string();
        let output = own.run(&["run", "theirs.toml", "--out", &onto]);
        assert!(stderr(&output).contains("holds the imported results"), "{}", stderr(&output));
        let twice = folder.run(&["import", "--format", format, &data(format), "--out", "theirs"]);
        assert!(!twice.status.success());
    }
}

/// Two functions, two numbers of variables, three instances.
const FUNCTIONS: &str = "name = 'ours'\nseeds = 3\nbudget = { evaluations = 600 }\n[functions]\n\
    name = ['sphere', 'rosenbrock']\ndimension = [2, 3]\ninstances = 3\n\
    [[optimiser]]\ncma-es = {}\n[[optimiser]]\nnelder-mead = {}\n";

/// The rows of a table of a report, by group and optimiser without its folder, and a further column.
fn by_cell(
    table: &Path,
    folder: &str,
    further: &str,
) -> BTreeMap<[String; 3], BTreeMap<String, String>> {
    let suffix = format!(" ({folder})");
    let own = rows(table).into_iter().filter_map(|row| {
        let optimiser = row["optimiser"].strip_suffix(&suffix)?.to_owned();
        let further = row.get(further).cloned().unwrap_or_default();
        Some(([row["group"].clone(), optimiser, further], row))
    });
    own.collect()
}

/// Our own exports come home: imported runs stand on the instances that were exported, and all statistics that their formats
/// have the data for are those of the original.
#[test]
fn exports_come_home() {
    let folder = Folder::new().with("ours.toml", FUNCTIONS);
    ok(&folder, &["run", "ours.toml", "--out", "ours"]);
    for format in ["ioh", "coco"] {
        let exported = format!("exported-{format}");
        ok(&folder, &["export", "ours", "--format", format, "--out", &exported]);
        ok(&folder, &["import", "--format", format, &exported, "--out", format]);
    }
    for order in [["ours", "ioh", "coco"], ["coco", "ioh", "ours"]] {
        let told = ok(&folder, &[&["report"], &order[..], &["--out", "all", "--replace"]].concat());
        assert!(told.contains("Imported from"), "{told}");
        let tables = folder.path().join("all/tables");
        let instances: std::collections::BTreeSet<String> =
            rows(&tables.join("runs.csv")).into_iter().map(|row| row["instance"].clone()).collect();
        assert_eq!(instances.len(), 12, "{instances:?}");
        let columns = |table: &str| -> (&str, Vec<&str>) {
            match table {
                "summary" => (
                    "",
                    vec![
                        "runs",
                        "failed",
                        "best f",
                        "quartile 1",
                        "median",
                        "quartile 3",
                        "evaluations",
                    ],
                ),
                _ => ("target", vec!["runs", "successes", "ERT"]),
            }
        };
        for table in ["summary", "fixed-target"] {
            let (further, columns) = columns(table);
            let path = tables.join(format!("{table}.csv"));
            let original = by_cell(&path, "ours", further);
            assert_eq!(original.len() % 8, 0);
            assert!(!original.is_empty());
            for format in ["ioh", "coco"] {
                let imported = by_cell(&path, format, further);
                assert_eq!(imported.len(), original.len(), "{table} {format}");
                for (cell, row) in &original {
                    for column in &columns {
                        assert_eq!(
                            imported[cell][*column], row[*column],
                            "{format} {cell:?} {column}"
                        );
                    }
                }
            }
        }
    }
}

/// A long table meets instances by the labels that tables show.
#[test]
fn a_long_table_meets_what_it_names() {
    let table = "problem,optimiser,seed,evaluation,cost\n\
        sphere dimension=2 instance=1,theirs,1,1,0.5\nsphere dimension=2 instance=9,theirs,1,1,0.5\n";
    let folder = Folder::new().with("ours.toml", FUNCTIONS).with("table.csv", table);
    ok(&folder, &["run", "ours.toml", "--out", "ours", "--seeds", "1"]);
    ok(&folder, &["import", "--format", "csv", "table.csv", "--out", "theirs"]);
    ok(&folder, &["report", "theirs", "ours", "--out", "both"]);
    let runs = rows(&folder.path().join("both/tables/runs.csv"));
    let on = |label: &str| runs.iter().filter(|row| row["instance"] == label).count();
    assert_eq!(on("sphere dimension=2 instance=1"), 3);
    assert_eq!(on("sphere dimension=2 instance=9"), 1);
}

/// Imported runs beside the task's: they have no motion, so the best motion shown is one of ours, whatever they found.
/// An empty folder is replaced also where the command stands in it.
#[test]
fn the_present_folder_is_filled() {
    let folder = Folder::new().with("t.csv", "problem,optimiser,seed,evaluation,cost\np,o,1,1,1\n");
    let empty = folder.path().join("empty");
    fs::create_dir(&empty).unwrap();
    let args = ["import", "--format", "csv", "../t.csv", "--out", "../empty"];
    let output = folder.command(&args).current_dir(&empty).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(empty.join("experiment.toml").is_file());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn imported_runs_stand_beside_motions() {
    let task = "name = 'task'\nseeds = 2\nbudget = { evaluations = 300 }\n[[optimiser]]\nscp = { starts = 1 }\n\
        [[optimiser]]\nrandom = {}\n";
    let table = "problem,optimiser,seed,evaluation,cost\n,theirs,1,1,5\n,theirs,1,90,0.1\n,theirs,2,40,0.9\n";
    let folder = Folder::new().with("task.toml", task).with("table.csv", table);
    ok(&folder, &["run", "task.toml", "--out", "task"]);
    ok(&folder, &["export", "task", "--format", "ioh", "--out", "exported"]);
    ok(&folder, &["import", "--format", "ioh", "exported", "--out", "back"]);
    ok(&folder, &["import", "--format", "csv", "table.csv", "--out", "table"]);
    let told = ok(&folder, &["report", "table", "back", "task", "--out", "all"]);
    assert!(told.contains("best motion: scp"), "{told}");
    let runs = rows(&folder.path().join("all/tables/runs.csv"));
    assert_eq!(runs.len(), 10);
    assert!(runs.iter().all(|row| row["instance"] == runs[0]["instance"]), "{runs:?}");
    // Exports hold costs of the search; the same cost with a motion, certified, is shown as the best.
    ok(&folder, &["report", "back", "task", "--out", "pair"]);
    let best = rows(&folder.path().join("pair/tables/best.csv"));
    assert_eq!(best.len(), 1);
    let duration = best[0].iter().find(|(heading, _)| heading.starts_with("t_f"));
    assert!(duration.is_some_and(|(_, value)| !value.is_empty()), "{best:?}");
    let limits = rows(&folder.path().join("all/tables/first-feasible.csv"));
    assert_eq!(limits.len(), 2, "{limits:?}");
    let page = fs::read_to_string(folder.path().join("all/report.html")).unwrap();
    assert!(page.contains("Imported from") && page.contains("CSV data in `table.csv`"));
}
