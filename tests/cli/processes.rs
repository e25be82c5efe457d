//! What the system does to a process: signals, locks, limits, remains of others.

use std::fs::{self, File};
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, SystemTime};

use crate::folder::{Folder, stderr, stdout};
use crate::survival::start;

/// Four runs of some tenths of a second.
const LONG: &str =
    "name = 'long'\nseeds = 4\nbudget = { evaluations = 60000 }\n[[optimiser]]\nrandom = {}\n";
/// Two short runs.
const SHORT: &str =
    "name = 'short'\nseeds = 2\nbudget = { evaluations = 50 }\n[[optimiser]]\nrandom = {}\n";

/// Waits until a process has said something.
fn wait_for(folder: &Folder, log: &str, expected: &str) {
    let path = folder.path().join(log);
    for _ in 0..3_000 {
        if fs::read_to_string(&path).is_ok_and(|text| text.contains(expected)) {
            return;
        }
        sleep(Duration::from_millis(10));
    }
    panic!("{expected} was not said: {}", fs::read_to_string(path).unwrap());
}

/// A shell that ignores a signal hands that on, as `nohup` does.
#[cfg(target_os = "linux")]
#[test]
fn signals_that_were_ignored_stay_ignored() {
    for (trap, signal, code) in
        [("trap '' HUP", "HUP", 0), ("trap '' TERM", "TERM", 0), ("true", "HUP", 1)]
    {
        let folder = Folder::new().with("long.toml", LONG);
        let script = format!("{trap}; exec \"$0\" run long.toml --jobs 1 --out out");
        let mut process = Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_driftless")])
            .current_dir(folder.path())
            .stdout(File::create(folder.path().join("said")).unwrap())
            .stderr(File::create(folder.path().join("log")).unwrap())
            .spawn()
            .unwrap();
        wait_for(&folder, "log", "seed 1: ");
        let kill = Command::new("kill").args(["-s", signal, &process.id().to_string()]).status();
        assert!(kill.unwrap().success());
        let status = process.wait().unwrap();
        let log = fs::read_to_string(folder.path().join("log")).unwrap();
        assert_eq!(status.code(), Some(code), "{trap}: {log}");
        assert_eq!(log.contains("interrupted: "), code == 1, "{trap}: {log}");
        assert_eq!(log.contains("seed 4: "), code == 0, "{trap}: {log}");
    }
}

#[test]
fn fresh_says_that_it_waits() {
    let folder = Folder::new().with("short.toml", SHORT);
    let args = ["short.toml", "--out", "out", "--fresh"];
    assert!(start(&folder, "log", &args).wait().unwrap().success());
    let lock = File::options().write(true).open(folder.path().join("out/.compacting")).unwrap();
    lock.lock().unwrap();
    let mut process = start(&folder, "log", &args);
    wait_for(&folder, "log", "another process is merging files; waiting until it is done");
    assert!(process.try_wait().unwrap().is_none());
    lock.unlock().unwrap();
    assert!(process.wait().unwrap().success());
    assert!(!fs::read_to_string(folder.path().join("log")).unwrap().contains("stored already"));
}

#[test]
fn more_threads_than_any_machine_has_are_refused() {
    let folder = Folder::new().with("short.toml", SHORT);
    let output = folder.run(&["run", "short.toml", "--jobs", "20000"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("20000 is not in 1..=1024"), "{}", stderr(&output));
}

/// A day and more ago.
fn made_old(path: &Path) {
    File::open(path).unwrap().set_modified(SystemTime::now() - Duration::from_hours(25)).unwrap();
}

/// Temporary files that are a day old are nobody's; young ones, and those of other programs, stay.
#[test]
fn remains_of_killed_processes_go() {
    let folder = Folder::new().with("short.toml", SHORT);
    assert!(folder.run(&["run", "short.toml", "--out", "out"]).status.success());
    let at = |name: &str| folder.path().join(name);
    let old =
        ["out/.tmp-driftless-a", "out/tables/.tmp-driftless-b", "out/figures/.tmp-driftless-c"];
    let kept = ["out/.tmp-driftless-d", "out/tables/.tmpother", ".tmpother", "out/.tmp-driftless"];
    for name in old.iter().chain(&kept) {
        fs::write(at(name), "half").unwrap();
    }
    fs::create_dir(at(".tmp-driftless-e")).unwrap();
    fs::write(at(".tmp-driftless-e/half"), "half").unwrap();
    old.iter().chain(&kept[1..]).chain(&[".tmp-driftless-e"]).for_each(|name| made_old(&at(name)));
    assert!(folder.run(&["report", "out"]).status.success());
    let output = folder.run(&["export", "out", "--format", "ioh", "--out", "exported"]);
    assert!(output.status.success(), "{}", stderr(&output));
    for name in old.iter().chain(&[".tmp-driftless-e"]) {
        assert!(!at(name).exists(), "{name}");
    }
    for name in kept {
        assert!(at(name).exists(), "{name}");
    }
}

/// Labels say nothing to a terminal but themselves: neither where a run ends, nor in tables, nor in errors.
#[test]
fn labels_give_a_terminal_no_orders() {
    let label = "label = \"a\\u001B[2J\\u0007\\u009Bb\"\n";
    let one = format!("{SHORT}{label}");
    let twice = format!("{one}[[optimiser]]\nde = {{}}\n{label}");
    let folder = Folder::new().with("one.toml", one).with("twice.toml", twice);
    for (args, code, out) in [
        (&["run", "one.toml", "--out", "out"][..], 0, true),
        (&["status", "out"], 0, true),
        (&["status", "out", "--json"], 0, true),
        (&["check", "twice.toml"], 2, false),
    ] {
        let output = folder.run(args);
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        let told = if out { stdout(&output) } else { stderr(&output) };
        assert!(told.contains("[2J"), "{args:?}: {told}");
        for text in [stdout(&output), stderr(&output)] {
            assert!(!text.chars().any(|c| c.is_control() && c != '\n'), "{args:?}: {text:?}");
        }
    }
    let output = folder.run(&["status", "out", "--json"]);
    let status: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(status["optimisers"][0]["optimiser"], "a\u{1b}[2J\u{7}\u{9b}b");
}

/// Runs the command with so much address space [kB].
#[cfg(target_os = "linux")]
fn within(folder: &Folder, kilobytes: u32, args: &[&str]) -> std::process::Output {
    let script = format!("ulimit -v {kilobytes} && exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_driftless")]).args(args);
    command.current_dir(folder.path()).env("NO_COLOR", "1").output().unwrap()
}

/// Experiments that are far too large are refused before they are spelt out, and large functions cost nothing until they
/// are searched: 500 of 1000 variables would take four gigabytes.
#[cfg(target_os = "linux")]
#[test]
fn planning_takes_little_memory() {
    let list: Vec<String> = (1..=30).map(|i| format!("0.{i:02}")).collect();
    let list = list.join(", ");
    let field = ["cognitive", "social", "delta", "velocity_limit"]
        .map(|key| format!("{key} = [{list}]"))
        .join("\n");
    let sizes: Vec<String> = (10..40).map(|i| i.to_string()).collect();
    let optimisers = format!(
        "name = 'x'\n[[optimiser]]\npso = {{}}\n[optimiser.sweep]\n{field}\npopulation = [{}]\n",
        sizes.join(", ")
    );
    let weights = format!("weight_base = [{list}]\n");
    let limits = ["rate_limit_deg_s", "acceleration_limit_deg_s2", "jerk_limit_deg_s3"]
        .map(|key| format!("{key} = [{list}]\n"));
    let task = format!(
        "name = 'x'\nseeds = 2\n[sweep]\n{weights}{}random_poses = {{ count = 10000 }}\n[[optimiser]]\nde = {{}}\n",
        limits.concat()
    );
    let many = "name = 'x'\nseeds = 15\n[functions]\nname = ['sphere']\ndimension = [1000]\ninstances = 500\n\
        [[optimiser]]\nrandom = {}\n";
    let folder = Folder::new()
        .with("optimisers.toml", optimisers)
        .with("task.toml", task)
        .with(
            "functions.toml",
            many.replace("[1000]", "[2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]")
                .replace("500", "10000"),
        )
        .with("many.toml", many);
    for (file, found) in [
        ("optimisers.toml", "24300000 optimisers, expected 10000 at most"),
        ("task.toml", "16200000000 runs, expected 1000000 at most"),
        ("functions.toml", "2100000 runs, expected 1000000 at most"),
    ] {
        let output = within(&folder, 3_000_000, &["check", file]);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(&format!("found {found}")), "{}", stderr(&output));
    }
    let output = within(&folder, 3_000_000, &["check", "many.toml", "--no-estimate"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("# 7500 runs: 500 instances"), "{}", stdout(&output));
}
