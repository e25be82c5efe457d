//! Optimisers that are programs: what they may do, and what becomes of those that misbehave.
#![cfg(all(unix, feature = "harness"))]

mod packages;
mod serve;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use polars::prelude::*;

const ZOO: &str = include_str!("zoo.py");

/// How many evaluations depends on how fast the machine is.
const SOME: u64 = u64::MAX;

/// How long those are waited for that never go on; others as long as it takes.
const PATIENCE: [(&str, &str); 3] = [
    ("hangs-at-start", "start_s = 1.5"),
    ("hangs-between", "silence_s = 3"),
    ("searches-too-long", "search_s = 1.4"),
];

/// What comes of every solver of the zoo: status, evaluations, and what its record says.
const SPECIES: [(&str, &str, u64, &str); 27] = [
    ("behaves", "finished", 10, ""),
    ("overruns-by-one", "budget-spent", 40, ""),
    ("overruns-by-a-batch", "budget-spent", 40, ""),
    ("prints", "finished", 10, ""),
    (
        "exits-with-3",
        "failed",
        5,
        "ended (exit status: 3) before it was done; its last words: no licence",
    ),
    ("is-killed", "failed", 5, "ended (signal: 9 (SIGKILL)) before it was done"),
    ("hangs-at-start", "failed", 0, "did not say `hello` within 1.5 s"),
    ("hangs-between", "failed", 5, "said nothing for 3 s"),
    ("hangs-at-the-end", "finished", 5, ""),
    ("ignores-signals", "finished", 5, ""),
    ("leaves-grandchildren", "finished", 5, ""),
    ("floods-stderr", "finished", 5, ""),
    ("floods-stdout", "finished", 5, ""),
    ("sends-nan", "finished", 1, "1 point outside the box cost infinitely much"),
    ("sends-a-bare-nan", "failed", 0, "what is not finite is written \"nan\""),
    ("sends-a-wrong-length", "failed", 0, "sent a point with 3 variables, expected 2"),
    ("goes-outside", "finished", 5, "2 points outside the box cost infinitely much"),
    ("sends-no-utf-8", "failed", 0, "sent a line that is not UTF-8"),
    ("sends-a-long-line", "failed", 0, "sent a line of more than 64 MiB"),
    ("sends-no-json", "failed", 0, "sent a line that cannot be read"),
    ("says-no-hello", "failed", 0, "said something before it said `hello`"),
    ("asks-after-stop", "budget-spent", 40, ""),
    ("never-listens", "budget-spent", 40, ""),
    ("asks-for-derivatives", "no-derivatives", 0, "the problem has no derivatives"),
    ("searches-too-long", "failed", SOME, "took more than 1.4 s of its own time"),
    ("asks-for-nothing", "failed", 0, "asked for the costs of no points"),
    ("ends-without-done", "failed", 5, "ended (exit status: 0) before it was done"),
];

/// Runs `driftless` in a folder.
fn driftless(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_driftless"));
    // What is trusted is remembered there.
    command.args(args).current_dir(folder).env("XDG_STATE_HOME", folder.join("state"));
    command.env("NO_COLOR", "1").output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// All stored runs.
fn runs(results: &Path) -> DataFrame {
    let frames = fs::read_dir(results.join("runs")).unwrap().map(|entry| {
        let file = fs::File::open(entry.unwrap().path()).unwrap();
        ParquetReader::new(file).finish().unwrap()
    });
    frames.reduce(|all, more| all.vstack(&more).unwrap()).unwrap()
}

fn texts(frame: &DataFrame, column: &str) -> Vec<String> {
    let texts = frame.column(column).unwrap().str().unwrap().iter();
    texts.map(|text| text.unwrap_or_default().to_owned()).collect()
}

fn counts(frame: &DataFrame, column: &str) -> Vec<u64> {
    frame.column(column).unwrap().u64().unwrap().iter().map(Option::unwrap).collect()
}

/// Processes that work in a folder.
fn alive(folder: &Path) -> Vec<String> {
    let folder = folder.canonicalize().unwrap();
    let processes = fs::read_dir("/proc").unwrap().flatten().map(|entry| entry.path());
    let inside = processes.filter(|process| {
        fs::read_link(process.join("cwd")).is_ok_and(|cwd| cwd.starts_with(&folder))
    });
    inside.map(|process| fs::read_to_string(process.join("cmdline")).unwrap_or_default()).collect()
}

/// A folder with the zoo and an experiment on it, spoken with over standard streams.
fn zoo(head: &str, species: &[&str]) -> tempfile::TempDir {
    zoo_by(head, species, "")
}

/// The same with more keys for every solver.
fn zoo_by(head: &str, species: &[&str], keys: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("zoo.py"), ZOO).unwrap();
    let mut experiment = format!(
        "name = 'zoo'\nseeds = 1\nbudget = {{ evaluations = 40 }}\n{head}\
         functions = {{ name = ['sphere'], dimension = [2] }}\n"
    );
    for how in species {
        let patience = PATIENCE.iter().find(|(name, _)| name == how).map_or("", |(_, keys)| keys);
        let _ = write!(
            experiment,
            "[[optimiser]]\nlabel = '{how}'\nexternal = {{ command = ['python3', 'zoo.py', '{how}'], \
             timeout = {{ {patience} }}{keys} }}\n"
        );
    }
    fs::write(folder.path().join("zoo.toml"), experiment).unwrap();
    folder
}

/// Every solver of the zoo runs to its record, which says what happened, and nothing of it stays alive.
#[cfg(target_os = "linux")]
#[test]
fn every_end_is_told_and_nothing_stays_alive() {
    for keys in ["", ", socket = true"] {
        ends_are_told(keys);
    }
}

#[cfg(target_os = "linux")]
fn ends_are_told(keys: &str) {
    let species: Vec<&str> = SPECIES.iter().map(|(how, ..)| *how).collect();
    let folder = zoo_by("", &species, keys);
    let output = driftless(folder.path(), &["run", "zoo.toml", "--out", "out", "--jobs", "8"]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(said(&output).contains("starts `python3 zoo.py behaves`"), "{}", said(&output));
    assert_eq!(alive(folder.path()), Vec::<String>::new());
    let runs = runs(&folder.path().join("out"));
    let (labels, statuses) = (texts(&runs, "optimiser"), texts(&runs, "status"));
    let (evaluations, messages) = (counts(&runs, "evaluations"), texts(&runs, "message"));
    let found: BTreeMap<&str, _> = (0..labels.len())
        .map(|i| (&*labels[i], (&*statuses[i], evaluations[i], &*messages[i])))
        .collect();
    assert_eq!(found.len(), SPECIES.len());
    for (how, status, evaluations, message) in SPECIES {
        let found = found[how];
        assert_eq!(found.0, status, "{how}: {}", found.2);
        assert!(evaluations == SOME || found.1 == evaluations, "{how}: {} {}", found.1, found.2);
        let fits = if message.is_empty() { found.2.is_empty() } else { found.2.contains(message) };
        assert!(fits, "{how}: {}", found.2);
    }
}

/// `driftless` killed in the middle: its solvers end with it, and the same command does what is missing.
#[cfg(target_os = "linux")]
#[test]
fn solvers_end_with_a_killed_program_and_runs_resume() {
    let folder = zoo("", &["takes-its-time"]);
    let args = ["run", "zoo.toml", "--out", "out", "--seeds", "12", "--jobs", "2"];
    let mut killed = Command::new(env!("CARGO_BIN_EXE_driftless"))
        .args(args)
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let stored = || {
        let runs = fs::read_dir(folder.path().join("out/runs")).into_iter().flatten().flatten();
        runs.filter(|entry| entry.path().extension().is_some_and(|e| e == "parquet")).count()
    };
    wait_until(|| stored() > 1);
    killed.kill().unwrap();
    killed.wait().unwrap();
    wait_until(|| alive(folder.path()).is_empty());
    let before = stored();
    assert!((2..12).contains(&before), "{before}");
    let again = driftless(folder.path(), &args);
    assert!(again.status.success(), "{}", said(&again));
    assert!(said(&again).contains(" of 12 runs are stored already"), "{}", said(&again));
    let runs = runs(&folder.path().join("out"));
    assert_eq!(counts(&runs, "evaluations"), [10; 12]);
    let mut seeds = counts(&runs, "seed");
    seeds.sort_unstable();
    assert_eq!(seeds, (1..=12).collect::<Vec<u64>>());
}

/// Waits for what is certain to come, at most as long as a test may hang.
fn wait_until(holds: impl Fn() -> bool) {
    for _ in 0..6000 {
        if holds() {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("did not happen within a minute");
}

/// What misbehaves once it is asked more than five times, beside what the records say; nothing where runs end as they should.
const PROBLEMS: [(&str, &str); 11] = [
    ("behaves", ""),
    ("prints", ""),
    ("answers-not-finite", ""),
    ("is-killed", "ended (signal: 9 (SIGKILL))"),
    ("says-why-it-fails", "failed: no convergence at this point"),
    ("hangs", "said nothing for"),
    ("answers-too-few", " for "),
    ("answers-below-the-least", "below the least cost 0e0 that it told of"),
    ("is-violated-by-less-than-nothing", "sent a violation of -1, expected"),
    ("answers-another", "expected an answer to"),
    ("sends-no-json", "sent a line that cannot be read"),
];

/// A folder with the problems and an experiment on some of them.
fn problems(kinds: &[&str], optimisers: &[&str], keys: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("problems.py"), include_str!("problems.py")).unwrap();
    let mut experiment = "name = 'problems'\nseeds = 1\nbudget = { evaluations = 40 }\n".to_owned();
    for how in kinds {
        let patience = match *how {
            "hangs-at-start" => "start_s = 1.5",
            "hangs" => "silence_s = 0.05",
            _ => "",
        };
        let _ = write!(
            experiment,
            "[[problem]]\nlabel = '{how}'\nexternal = {{ command = ['python3', 'problems.py', '{how}'], \
             timeout = {{ {patience} }}{keys} }}\n"
        );
    }
    for optimiser in optimisers {
        let _ = write!(experiment, "[[optimiser]]\n{optimiser} = {{}}\n");
    }
    fs::write(folder.path().join("problems.toml"), experiment).unwrap();
    folder
}

/// Problems that are programs, raced by all optimisers that need no derivatives: what fails is a record that says why.
#[cfg(target_os = "linux")]
#[test]
fn problems_fail_in_their_records_alone() {
    for keys in ["", ", socket = true"] {
        problems_fail_alone(keys);
    }
}

#[cfg(target_os = "linux")]
fn problems_fail_alone(keys: &str) {
    let optimisers = ["random", "pso", "de", "l-shade", "nelder-mead", "cma-es"];
    let kinds: Vec<&str> = PROBLEMS.iter().map(|(how, _)| *how).collect();
    let folder = problems(&kinds, &optimisers, keys);
    let output = driftless(folder.path(), &["run", "problems.toml", "--out", "out", "--jobs", "4"]);
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(alive(folder.path()), Vec::<String>::new());
    let runs = runs(&folder.path().join("out"));
    let (labels, statuses) = (texts(&runs, "instance"), texts(&runs, "status"));
    let messages = texts(&runs, "message");
    assert_eq!(runs.height(), PROBLEMS.len() * optimisers.len());
    for (how, message) in PROBLEMS {
        for i in (0..labels.len()).filter(|&i| labels[i] == how) {
            assert_eq!(statuses[i] == "failed", !message.is_empty(), "{how}: {}", messages[i]);
            assert!(messages[i].contains(message), "{how}: {}", messages[i]);
        }
    }
    // Reading what was found starts nothing, also where the program is gone.
    fs::remove_file(folder.path().join("problems.py")).unwrap();
    for verb in ["report", "status"] {
        let read = driftless(folder.path(), &[verb, "out"]);
        assert!(read.status.success(), "{verb}: {}", said(&read));
    }
    let again = driftless(folder.path(), &["run", "out/experiment.toml", "--out", "out"]);
    assert_eq!(again.status.code(), Some(2), "{}", said(&again));
    assert!(said(&again).contains("--trust"), "{}", said(&again));
}

/// A program that does not say what problem it is: one error, and nothing is written.
#[test]
fn a_program_that_is_no_problem_is_refused() {
    for (how, message) in [
        ("hangs-at-start", "did not say `hello` within 1.5 s"),
        ("tells-of-no-box", "expected the lower bound first"),
        ("tells-of-too-few-bounds", "told of 3 variables, 2 lower and 2 upper bounds"),
    ] {
        let folder = problems(&[how], &["random"], "");
        let output = driftless(folder.path(), &["run", "problems.toml", "--out", "out"]);
        assert_eq!(output.status.code(), Some(2), "{how}: {}", said(&output));
        let said = said(&output).replace('│', " ");
        let error = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(error.contains(message), "{how}: {error}");
        assert!(!folder.path().join("out").exists());
    }
}

/// Two solvers that differ in a file that they name are two, and one that has changed since is run again.
#[test]
fn an_edited_solver_is_another() {
    let folder = zoo("", &["behaves"]);
    let run = |args: &[&str]| driftless(folder.path(), &[&["run", "zoo.toml"], args].concat());
    assert!(run(&["--out", "out"]).status.success());
    let same = run(&["--out", "out"]);
    assert!(said(&same).contains("1 of 1 run is stored already"), "{}", said(&same));
    let edited = ZOO.replace("ask_all(10)", "ask_all(11)");
    fs::write(folder.path().join("zoo.py"), edited).unwrap();
    let other = run(&["--out", "out"]);
    assert!(other.status.success() && !said(&other).contains("stored already"), "{}", said(&other));
    let mut evaluations = counts(&runs(&folder.path().join("out")), "evaluations");
    evaluations.sort_unstable();
    assert_eq!(evaluations, [10, 11]);
}

/// A run during which its solver is edited is none of the solver's that the experiment names.
#[test]
fn runs_of_solvers_that_change_meanwhile_fail() {
    let folder = zoo("", &["edits-itself"]);
    let output = driftless(folder.path(), &["run", "zoo.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", said(&output));
    let runs = runs(&folder.path().join("out"));
    assert_eq!((&*texts(&runs, "status")[0], counts(&runs, "evaluations")[0]), ("failed", 5));
    let message = &texts(&runs, "message")[0];
    assert!(message.contains("zoo.py is not what it was"), "{message}");
}

/// Answers that nobody reads do not pile up.
#[test]
fn programs_that_do_not_read_are_given_up() {
    let folder = zoo("", &["does-not-read"]);
    let file = folder.path().join("zoo.toml");
    let text =
        fs::read_to_string(&file).unwrap().replace("timeout = {  }", "timeout = { silence_s = 2 }");
    fs::write(&file, text).unwrap();
    let output =
        driftless(folder.path(), &["run", "zoo.toml", "--out", "out", "--budget", "1000000"]);
    assert!(output.status.success(), "{}", said(&output));
    let runs = runs(&folder.path().join("out"));
    let message = &texts(&runs, "message")[0];
    assert!(message.contains("does not read its answers"), "{message}");
    // Of some thousand characters each, 16 MiB are as many answers, and what fits into the pipes beside.
    let evaluations = counts(&runs, "evaluations")[0];
    assert!((10_000..40_000).contains(&evaluations), "{evaluations}");
}

/// `--retry` does again what has failed, and nothing else.
#[test]
fn failed_runs_are_done_again() {
    let folder = zoo("", &["behaves", "fails-once"]);
    let run = |args: &[&str]| {
        let output =
            driftless(folder.path(), &[&["run", "zoo.toml", "--out", "out"], args].concat());
        assert!(output.status.success(), "{}", said(&output));
        said(&output)
    };
    let statuses = || {
        let mut statuses = texts(&runs(&folder.path().join("out")), "status");
        statuses.sort_unstable();
        statuses
    };
    run(&[]);
    assert_eq!(statuses(), ["failed", "finished"]);
    assert!(run(&[]).contains("2 of 2 runs are stored already"));
    assert!(run(&["--retry"]).contains("1 of 2 runs are stored already"));
    assert_eq!(statuses(), ["finished", "finished"]);
    assert!(run(&["--retry"]).contains("2 of 2 runs are stored already"));
}

/// A program that is not there is an error before anything is written, and no failed run.
#[test]
fn programs_that_are_not_there_are_refused() {
    for (command, message) in [
        ("['no-such-program']", "found no program `no-such-program` in the search path"),
        ("['./no-such-program']", "No such file"),
        ("['./folder']", "folder: it is not a file"),
        ("['./zoo.py']", "zoo.py: it is not executable"),
        ("['python3', 'zoo.py'], files = ['/dev/zero']", "/dev/zero: it is not a file"),
    ] {
        let folder = zoo("", &["behaves"]);
        fs::create_dir(folder.path().join("folder")).unwrap();
        let file = folder.path().join("zoo.toml");
        let text = fs::read_to_string(&file).unwrap();
        fs::write(&file, text.replace("['python3', 'zoo.py', 'behaves']", command)).unwrap();
        let output = driftless(folder.path(), &["run", "zoo.toml", "--out", "out"]);
        assert_eq!(output.status.code(), Some(2), "{command}: {}", said(&output));
        let said = said(&output).replace(['│', '\n'], " ");
        let error = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(error.contains(message), "{command}: {error}");
        assert!(!folder.path().join("out").exists());
    }
}

/// Files of results name programs that may come from anybody: nothing is started without a word from the user.
#[test]
fn programs_of_results_are_started_where_they_are_trusted() {
    let folder = zoo("", &["behaves"]);
    assert!(driftless(folder.path(), &["run", "zoo.toml", "--out", "out"]).status.success());
    fs::remove_dir_all(folder.path().join("out/runs")).unwrap();
    let refused = driftless(folder.path(), &["run", "out/experiment.toml", "--out", "out"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("starts `python3 zoo.py behaves`"), "{}", said(&refused));
    // A file that does not say that it is one of results, in a folder of results.
    let file = folder.path().join("out/experiment.toml");
    let kept = fs::read_to_string(&file).unwrap();
    let is_own = |line: &&str| !line.starts_with("folder = ") && !line.contains("sha256");
    let silent: Vec<&str> = kept.lines().filter(is_own).collect();
    fs::write(&file, silent.join("\n").replace("\"zoo.py\" = ", "# ")).unwrap();
    let refused = driftless(folder.path(), &["run", "out/experiment.toml", "--out", "out"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("pass --trust"), "{}", said(&refused));
    fs::write(&file, kept).unwrap();
    let trusted =
        driftless(folder.path(), &["run", "out/experiment.toml", "--out", "out", "--trust"]);
    assert!(trusted.status.success(), "{}", said(&trusted));
    assert_eq!(counts(&runs(&folder.path().join("out")), "evaluations"), [10]);
    // Trusted once, it is not asked for again, until it is another program.
    fs::remove_dir_all(folder.path().join("out/runs")).unwrap();
    let again = driftless(folder.path(), &["run", "out/experiment.toml", "--out", "out"]);
    assert!(again.status.success(), "{}", said(&again));
    let kept = fs::read_to_string(&file).unwrap();
    fs::write(&file, kept.replace("\"behaves\"", "\"prints\"")).unwrap();
    let other = driftless(folder.path(), &["run", "out/experiment.toml", "--out", "out"]);
    assert_eq!(other.status.code(), Some(2), "{}", said(&other));
    fs::write(&file, kept).unwrap();
    // A file that is not what results were made with: what they were is kept.
    fs::write(folder.path().join("zoo.py"), "print('{\"hello\": {}}')").unwrap();
    let changed =
        driftless(folder.path(), &["run", "out/experiment.toml", "--out", "out", "--fresh"]);
    assert_eq!(changed.status.code(), Some(2));
    let words = said(&changed).replace(['│', '\n'], " ");
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("zoo.py is not what it was"), "{words}");
    assert_eq!(counts(&runs(&folder.path().join("out")), "evaluations"), [10]);
}

/// The programs of docs/solvers that this machine has the languages for, on the problem beside them: each spends its budget.
#[test]
fn solvers_to_start_from_work() {
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir("docs/solvers").unwrap().map(Result::unwrap) {
        fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    let succeeds = |program: &str, args: &[&str]| {
        let mut command = Command::new(program);
        let output = command.args(args).current_dir(folder.path()).output();
        output.is_ok_and(|output| output.status.success())
    };
    let mut commands = vec!["['python3', 'gaussian_search.py']"];
    if succeeds("python3", &["-c", "import numpy"]) {
        commands.push("['python3', 'swarm.py']");
    }
    let compiled = ["-O2", "-std=c++17", "-o", "gaussian_search", "gaussian_search.cpp"];
    if succeeds("c++", &["--version"]) {
        assert!(succeeds("c++", &compiled));
        commands.push("['./gaussian_search']");
    }
    if succeeds("octave-cli", &["--version"]) {
        commands.push("['octave-cli', '--quiet', 'gaussian_search.m']");
    }
    if succeeds("octave-cli", &["--quiet", "--eval", "pkg load instrument-control"]) {
        commands.push("['octave-cli', '--quiet', 'gaussian_search_socket.m'], socket = true");
    } else {
        eprintln!("skipped: Octave, or its package instrument-control, is not installed");
    }
    let mut experiment = "name = 'solvers'\nseeds = 2\nbudget = { evaluations = 1000 }\n\
        [problem]\nexternal = { command = ['python3', 'problem.py'], settings = { dimension = 3 } }\n"
        .to_owned();
    for (i, command) in commands.iter().enumerate() {
        let table = format!("label = '{i}'\nexternal = {{ command = {command} }}\n");
        experiment += "[[optimiser]]\n";
        experiment += &table;
    }
    fs::write(folder.path().join("solvers.toml"), experiment).unwrap();
    let output = driftless(folder.path(), &["run", "solvers.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", said(&output));
    let runs = runs(&folder.path().join("out"));
    assert_eq!(texts(&runs, "message"), vec![""; 2 * commands.len()]);
    assert_eq!(texts(&runs, "status"), vec!["budget-spent"; 2 * commands.len()]);
    assert_eq!(counts(&runs, "evaluations"), vec![1000; 2 * commands.len()]);
    // A point drawn at random costs 911 in the mean: twice 100 · (4/3 + 16/5) + 7/3.
    let costs = runs.column("certified_j").unwrap().f64().unwrap().clone();
    assert!(costs.iter().all(|cost| cost.unwrap() < 20.0), "{costs:?}");
}
