//! Results survive: processes that are killed, that share a folder, that compact it while others read, and
//! disks that are full or read-only. Whatever happened, the tables are those of an undisturbed run.

use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use driftless::experiment::Store;
use driftless::search::Rng;
use polars::prelude::*;

use crate::folder::{Folder, stderr, stdout};

/// 48 runs of some milliseconds to some hundredths of a second.
const EXPERIMENT: &str = "name = 'brief'\nseeds = 6\nbudget = { evaluations = 2000 }\n\
    [sweep]\njerk_limit_deg_s3 = [40, 80]\n[[optimiser]]\npso = { population = 20 }\n\
    [[optimiser]]\nrandom = { formulation = 'scaled' }\n[[optimiser]]\nscp = { starts = 2 }\n\
    [[optimiser]]\nhybrid = { search = { de = {} } }\n";

/// Exports its runs.
const EXPORT: [&str; 6] = ["export", "calm", "--format", "ioh", "--out", "exported"];

/// What holds wall time or a date.
const TIMES: [&str; 3] = ["seconds", "seconds_in_problem", "date"];

/// The folder's results, sorted, without what holds wall time: bytes of each table.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let store = Store::existing(folder);
    let mut keys: Vec<String> = store.keys().unwrap().into_iter().collect();
    keys.sort();
    let read = |table: &str| store.read(table, keys.iter().map(String::as_str)).unwrap();
    let tables = ["runs", "traces"].map(|table| {
        let mut frame = read(table).drop_many(TIMES);
        let mut bytes = Vec::new();
        ParquetWriter::new(&mut bytes).finish(&mut frame).unwrap();
        (table.to_owned(), bytes)
    });
    let clocks = read("clocks");
    assert_eq!(clocks.height(), read("traces").height());
    tables.into_iter().chain(summaries(folder)).collect()
}

/// The tables that `report` writes, column by column, without those of wall time.
fn summaries(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let output = Folder::new().run(&["report", &folder.display().to_string()]);
    assert!(output.status.success(), "{}", stderr(&output));
    let entries = fs::read_dir(folder.join("tables")).unwrap().map(|entry| entry.unwrap().path());
    let tables = entries.filter(|path| path.extension().is_some_and(|e| e == "csv"));
    let tables: BTreeMap<_, _> = tables.map(|path| (path.display().to_string(), path)).collect();
    assert!(tables.len() > 5);
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    tables.into_values().map(|path| (name(&path), without_times(&path))).collect()
}

fn without_times(path: &Path) -> Vec<u8> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(path).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let kept: Vec<bool> = rows[0].iter().map(|name| name != "s/run").collect();
    let row = |row: &csv::StringRecord| {
        let cells = row.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(cell, _)| cell);
        cells.collect::<Vec<_>>().join(",")
    };
    rows.iter().map(row).collect::<Vec<_>>().join("\n").into_bytes()
}

/// Starts `driftless run` and leaves it to itself; what it says goes into a file.
pub(crate) fn start(folder: &Folder, log: &str, args: &[&str]) -> Child {
    let log = fs::File::create(folder.path().join(log)).unwrap();
    Command::new(env!("CARGO_BIN_EXE_driftless"))
        .arg("run")
        .args(args)
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(log)
        .spawn()
        .unwrap()
}

/// The runs that a process said were stored.
fn told(folder: &Folder, log: &str) -> Vec<String> {
    let text = fs::read_to_string(folder.path().join(log)).unwrap();
    let run = |line: &str| line.split_once(": J ").map(|(run, _)| run.to_owned());
    text.lines().filter_map(run).collect()
}

fn undisturbed() -> (Folder, BTreeMap<String, Vec<u8>>) {
    let folder = Folder::new().with("brief.toml", EXPERIMENT);
    let output = folder.run(&["run", "brief.toml", "--out", "calm", "--jobs", "1"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let results = results(&folder.path().join("calm"));
    (folder, results)
}

#[test]
fn killed_processes_lose_nothing_and_do_nothing_twice() {
    let (folder, calm) = undisturbed();
    let mut rng = Rng::new(20);
    let mut seen = HashSet::new();
    let mut cut = 0;
    for kill in 0..50 {
        let mut process = start(&folder, "log", &["brief.toml", "--out", "killed", "--jobs", "2"]);
        sleep(Duration::from_micros(rng.uniform(0.0, 150_000.0) as u64));
        process.kill().unwrap();
        process.wait().unwrap();
        for run in told(&folder, "log") {
            assert!(seen.insert(run.clone()), "{run} was done again after kill {kill}");
        }
        let stored = Store::existing(&folder.path().join("killed")).keys().unwrap().len();
        assert!(stored >= seen.len(), "{stored} stored, {} told", seen.len());
        cut += usize::from(stored < 48);
    }
    println!("{cut} of 50 kills came before the last run was stored");
    assert!(cut >= 10, "only {cut} kills came before the end");
    let output = folder.run(&["run", "brief.toml", "--out", "killed", "--jobs", "2"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(results(&folder.path().join("killed")), calm);
}

/// Four shards, the first of them twice; two processes at a time merge what there is, every other one is
/// killed; this one reads.
#[test]
fn shards_share_a_folder_that_is_compacted_and_read_meanwhile() {
    let (folder, calm) = undisturbed();
    let shared = folder.path().join("shared");
    let shards = ["0/4", "1/4", "2/4", "3/4", "0/4"].iter().enumerate();
    let mut shards: Vec<Child> = shards
        .map(|(i, shard)| {
            let args = ["brief.toml", "--out", "shared", "--shard", shard, "--jobs", "1"];
            start(&folder, &format!("log{i}"), &args)
        })
        .collect();
    let compact = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_driftless"));
        let command = command.args(["compact", "shared"]).current_dir(folder.path());
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    };
    let mut rng = Rng::new(30);
    let (mut before, mut compactions) = (0, 0);
    while shards.iter_mut().any(|shard| shard.try_wait().unwrap().is_none()) {
        let mut pair = [compact(), compact()];
        if rng.index(2) == 0 {
            sleep(Duration::from_micros(rng.uniform(0.0, 40_000.0) as u64));
            let _ = pair[0].kill();
        }
        while pair.iter_mut().any(|process| process.try_wait().unwrap().is_none()) {
            before = check_reading(&shared, before);
        }
        compactions += 1;
    }
    println!("{compactions} pairs of compactions");
    assert!(compactions > 2, "only {compactions} compactions");
    for (i, mut shard) in shards.into_iter().enumerate() {
        let log = fs::read_to_string(folder.path().join(format!("log{i}"))).unwrap();
        assert!(shard.wait().unwrap().success(), "{log}");
    }
    let output = folder.run(&["compact", "shared"]);
    assert_eq!(stdout(&output).matches("1 file per table").count(), 1, "{}", stdout(&output));
    assert_eq!(results(&shared), calm);
}

/// Reads all tables as they are now: no run twice, none that was there has gone, every trace whole.
fn check_reading(folder: &Path, before: usize) -> usize {
    let store = Store::existing(folder);
    let keys = store.keys().unwrap();
    assert!(keys.len() >= before, "{} of {before} runs", keys.len());
    let read = |table| store.read(table, keys.iter().map(String::as_str)).unwrap();
    let (runs, traces) = (read("runs"), read("traces"));
    assert_eq!(runs.height(), keys.len());
    if !keys.is_empty() {
        let count = |frame: &DataFrame| frame.column("key").unwrap().n_unique().unwrap();
        assert_eq!((count(&runs), count(&traces)), (keys.len(), keys.len()));
    }
    keys.len()
}

/// Runs shell commands where file systems can be mounted; nothing where the system does not allow it.
fn with_mounts(folder: &Folder, script: &str) -> Option<String> {
    let program = env!("CARGO_BIN_EXE_driftless");
    let script = format!("driftless() {{ \"{program}\" \"$@\" 2>&1; }}\nmkdir out\n{script}");
    let output = Command::new("unshare")
        .args(["--map-root-user", "--mount", "sh", "-c", &script])
        .current_dir(folder.path())
        .output();
    match output {
        Ok(output) if output.status.success() => Some(stdout(&output)),
        other => {
            println!("skipped: file systems cannot be mounted here: {other:?}");
            None
        }
    }
}

#[test]
fn full_disks_lose_nothing() {
    let (folder, calm) = undisturbed();
    let script = "mount -t tmpfs -o size=400k none out || exit 77\n\
        driftless run brief.toml --out out; echo exit $?\n\
        driftless status out --json\n\
        mount -o remount,size=50m out\n\
        driftless run brief.toml --out out; echo exit $?\n\
        cp -r out after";
    let Some(told) = with_mounts(&folder, script) else { return };
    assert!(told.contains("No space left on device"), "{told}");
    assert!(told.contains("cannot write out/"), "{told}");
    let json = told.lines().find(|line| line.starts_with('{')).unwrap();
    let status: serde_json::Value = serde_json::from_str(json).unwrap();
    let stored = status["stored"].as_u64().unwrap();
    assert!((1..48).contains(&stored), "{stored} stored");
    assert!(told.contains(&format!("{stored} of 48 runs are stored already")), "{told}");
    let exits: Vec<&str> = told.lines().filter(|line| line.starts_with("exit ")).collect();
    assert_eq!(exits, ["exit 1", "exit 0"]);
    assert_eq!(results(&folder.path().join("after")), calm);
}

#[test]
fn read_only_disks_are_told_of_and_can_be_read() {
    let (folder, calm) = undisturbed();
    let script = "mount -t tmpfs -o size=50m none out || exit 77\n\
        driftless run brief.toml --out out --shard 0/2; echo exit $?\n\
        mount -o remount,ro out\n\
        driftless run brief.toml --out out; echo exit $?\n\
        driftless compact out; echo exit $?\n\
        driftless status out --json\n\
        mount -o remount,rw out\n\
        driftless run brief.toml --out out; echo exit $?\n\
        cp -r out after";
    let Some(told) = with_mounts(&folder, script) else { return };
    assert_eq!(told.matches("Read-only file system").count(), 2, "{told}");
    let json = told.lines().find(|line| line.starts_with('{')).unwrap();
    let status: serde_json::Value = serde_json::from_str(json).unwrap();
    assert_eq!(status["stored"], 24);
    let exits: Vec<&str> = told.lines().filter(|line| line.starts_with("exit ")).collect();
    assert_eq!(exits, ["exit 0", "exit 1", "exit 1", "exit 0"]);
    assert_eq!(results(&folder.path().join("after")), calm);
}

/// Nobody listens: the work is done all the same.
#[test]
fn notes_that_cannot_be_written_stop_nothing() {
    let folder = Folder::new().with("brief.toml", EXPERIMENT);
    let full = || fs::OpenOptions::new().write(true).open("/dev/full");
    let Ok(full) = full() else { return println!("skipped: there is no /dev/full") };
    let output = folder.command(&["run", "brief.toml", "--out", "out"]).stderr(full).output();
    assert_eq!(output.unwrap().status.code(), Some(0));
    assert_eq!(Store::existing(&folder.path().join("out")).keys().unwrap().len(), 48);
}

/// A damaged file is named and all others are read; `run` sets it aside with the other two of its three and does their
/// runs again.
#[test]
fn damaged_files_are_named_and_done_again() {
    let (folder, calm) = undisturbed();
    let out = folder.path().join("calm");
    let key = Store::existing(&out).keys().unwrap().into_iter().min().unwrap();
    for (table, name) in
        [("runs", &key), ("traces", &format!("{key}-2")), ("clocks", &format!("{key}-3"))]
    {
        let path = out.join(table).join(format!("{key}.parquet"));
        let whole = fs::read(&path).unwrap();
        let half = &whole[..whole.len() / 2];
        fs::write(&path, half).unwrap();
        let named = format!("{table}/{key}.parquet ");
        for args in [&["report", "calm"][..], &["status", "calm"], &["compact", "calm"], &EXPORT] {
            let output = folder.run(args);
            assert!(output.status.success(), "{}", stderr(&output));
            let told = stderr(&output);
            assert_eq!(told.matches(&named).count(), 1, "{args:?}: {told}");
        }
        fs::remove_dir_all(folder.path().join("exported")).unwrap();
        let output = folder.run(&["status", "calm", "--json"]);
        let status: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        assert_eq!((&status["stored"], &status["missing"]), (&47.into(), &1.into()));
        let damaged = status["damaged"].as_array().unwrap();
        assert_eq!(damaged.len(), 1);
        assert!(damaged[0]["file"].as_str().unwrap().ends_with(named.trim_end()));
        let output = folder.run(&["run", "brief.toml", "--out", "calm"]);
        let told = stderr(&output);
        assert!(told.contains("47 of 48 runs are stored already"), "{told}");
        assert!(told.contains(&named) && told.contains("moved to calm/damaged, "), "{told}");
        assert_eq!(fs::read(out.join(format!("damaged/{name}/{table}.parquet"))).unwrap(), half);
        assert_eq!(results(&out), calm);
    }
    // Remains of killed processes go when they are a day old.
    let (old, young) =
        (out.join("traces/.tmp-driftless-old"), out.join("traces/.tmp-driftless-young"));
    for path in [&old, &young] {
        fs::write(path, "half").unwrap();
    }
    let yesterday = std::time::SystemTime::now() - Duration::from_hours(25);
    fs::File::options().write(true).open(&old).unwrap().set_modified(yesterday).unwrap();
    assert!(folder.run(&["compact", "calm"]).status.success());
    assert!(!old.exists() && young.exists());
    // What is no batch is none of ours, and a link that leads nowhere is no reason to wait.
    fs::write(out.join("runs/notes.parquet"), "not a table").unwrap();
    assert!(folder.run(&["status", "calm"]).status.success());
}

/// Another experiment's folder is left as it is.
#[test]
fn a_folder_belongs_to_one_experiment() {
    let (folder, _) = undisturbed();
    let kept = fs::read(folder.path().join("calm/experiment.toml")).unwrap();
    let folder = folder.with("other.toml", EXPERIMENT.replace("'brief'", "'other'"));
    let output = folder.run(&["run", "other.toml", "--out", "calm"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("`brief`"), "{}", stderr(&output));
    assert_eq!(fs::read(folder.path().join("calm/experiment.toml")).unwrap(), kept);
}

/// An experiment that this program cannot read is not replaced by another, nor are files that stand where there are
/// no results.
#[test]
fn what_is_not_understood_is_kept() {
    let (folder, _) = undisturbed();
    let experiment = folder.path().join("calm/experiment.toml");
    for text in ["name = ", "seeds = 3", "name = 'brief'\nfuture = 1\nname = 'brief'"] {
        fs::write(&experiment, text).unwrap();
        let output = folder.run(&["run", "brief.toml", "--out", "calm"]);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert_eq!(fs::read_to_string(&experiment).unwrap(), text);
    }
    let own = format!("# mine\n{EXPERIMENT}");
    fs::create_dir(folder.path().join("own")).unwrap();
    let folder = folder.with("own/experiment.toml", own.clone());
    let output = folder.run(&["run", "own/experiment.toml", "--out", "own"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(folder.path().join("own/experiment.toml")).unwrap(), own);
    assert!(!folder.path().join("own/runs").exists());
}

/// Whatever byte of a file is changed, the file is named and nothing of it is read.
#[test]
fn changed_bytes_are_no_panic() {
    let (folder, _) = undisturbed();
    let out = folder.path().join("calm");
    assert!(folder.run(&["compact", "calm"]).status.success());
    for table in ["runs", "traces", "clocks"] {
        let mut tables = fs::read_dir(out.join(table)).unwrap().map(|entry| entry.unwrap().path());
        let path = tables.find(|path| path.extension().is_some_and(|e| e == "parquet")).unwrap();
        let whole = fs::read(&path).unwrap();
        for (k, place) in (0..whole.len()).step_by(whole.len() / 30).enumerate() {
            let mut bytes = whole.clone();
            bytes[place] ^= [0x01, 0x27, 0x80, 0xff][k % 4];
            fs::write(&path, bytes).unwrap();
            let output = folder.run(&["status", "calm"]);
            assert!(output.status.success() && stdout(&output).contains("0 of 48 runs are stored"));
            let expected =
                format!("{} does not match its checksum", path.file_name().unwrap().display());
            assert!(stderr(&output).contains(&expected), "{}", stderr(&output));
        }
        fs::write(&path, whole).unwrap();
    }
    assert!(stdout(&folder.run(&["status", "calm"])).contains("48 of 48 runs are stored"));
}
