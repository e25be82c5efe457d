//! What `submit` promises: it shows a job that a shell takes as it is, starts it where told to, and says what is wrong before.

use std::os::unix::fs::PermissionsExt as _;
use std::process::Output;

use crate::folder::{Folder, stderr, stdout};

const SMALL: &str = "name = 'small'\nseeds = 8\nbudget = { evaluations = 2000 }\n\
    [functions]\nname = ['sphere']\n[[optimiser]]\npso = {}\n[[optimiser]]\nrandom = {}\n";

/// A name that a shell would take apart.
const ODD: &str = "it's $HOME, \"b\" & c.toml";

/// What it prints, with short names for the program and the folder.
fn job(folder: &Folder, output: &Output) -> String {
    assert!(output.status.success(), "{}", stderr(output));
    let here = folder.path().canonicalize().unwrap();
    let text = stdout(output).replace(env!("CARGO_BIN_EXE_driftless"), "DRIFTLESS");
    text.replace(here.to_str().unwrap(), "HERE")
}

/// A command of this name on the PATH, as a shell script.
fn with_command(folder: Folder, name: &str, script: &str) -> Folder {
    let path = folder.path().join("bin").join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, format!("#!/bin/sh\n{script}")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    folder
}

/// Runs it with such commands.
fn run(folder: &Folder, args: &[&str]) -> Output {
    let path =
        format!("{}:{}", folder.path().join("bin").display(), std::env::var("PATH").unwrap());
    folder.command(args).env("PATH", path).output().unwrap()
}

#[test]
fn jobs_are_shown_and_nothing_is_written() {
    let folder = Folder::new().with("small.toml", SMALL);
    for (args, expected) in [
        (
            &["--to", "hyperqueue", "--jobs", "2", "--seeds", "9"][..],
            "mkdir -p HERE/results/small/logs &&\n\
             hq submit --name small --array 0-3 --cpus 2 --stdout 'HERE/results/small/logs/%{TASK_ID}.out' \
             --stderr 'HERE/results/small/logs/%{TASK_ID}.err' \\\n    \
             -- DRIFTLESS run HERE/small.toml --out HERE/results/small --seeds 9 --jobs 2 --shard /4\n",
        ),
        (
            &[
                "--to",
                "slurm",
                "--out",
                "50%",
                "--workers",
                "3",
                "--",
                "--time=4:00:00",
                "-A",
                "us all",
            ],
            "mkdir -p 'HERE/50%/logs' &&\n\
             sbatch --job-name small --array 0-3%3 --cpus-per-task 1 --requeue --open-mode append \
             --output 'HERE/50%%/logs/%A_%a.log' '--time=4:00:00' -A 'us all' \\\n    \
             --wrap 'exec DRIFTLESS run HERE/small.toml --out '\\''HERE/50%'\\'' --jobs 1 --shard /4'\n",
        ),
        (
            &["--to", "parallel", "--workers", "3", "--budget", "100"],
            "mkdir -p HERE/results/small/logs &&\n\
             seq 0 3 | parallel --jobs 3 --joblog HERE/results/small/logs/parallel.tsv --retries 3 --quote \\\n    \
             DRIFTLESS run HERE/small.toml --out HERE/results/small --budget 100 --jobs 1 --shard {}/4\n",
        ),
    ] {
        let output = folder.run(&[&["submit", "small.toml", "--shards", "4"], args].concat());
        assert_eq!(job(&folder, &output), expected);
        assert!(stderr(&output).contains(" runs in 4 tasks; pass --go to submit the job"));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// The scheduler's command gets every word as it is, and what it then does is a shard.
#[test]
fn go_starts_the_job() {
    for (scheduler, command, script) in [
        (
            "hyperqueue",
            "hq",
            "while [ \"$1\" != -- ]; do shift; done; shift; HQ_TASK_ID=1 exec \"$@\"",
        ),
        ("slurm", "sbatch", "for last; do :; done; SLURM_ARRAY_TASK_ID=1 exec sh -c \"$last\""),
        (
            "parallel",
            "parallel",
            "while [ \"$1\" != --quote ]; do shift; done; shift; n=$#; \
             for word; do set -- \"$@\" \"$(printf %s \"$word\" | sed 's/{}/1/')\"; done; shift \"$n\"; exec \"$@\"",
        ),
    ] {
        let folder = with_command(Folder::new().with(ODD, SMALL), command, script);
        let args = ["submit", ODD, "--to", scheduler, "--shards", "4", "--out", "a b'c", "--go"];
        let output = run(&folder, &args);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(
            stdout(&output).contains("shard 1/4: 4 runs, all stored in"),
            "{}",
            stdout(&output)
        );
        assert_eq!(std::fs::read_dir(folder.path().join("a b'c/runs")).unwrap().count(), 4);
        assert!(folder.path().join("a b'c/logs").is_dir());
    }
}

#[test]
fn a_scheduler_that_is_missing_or_refuses_is_an_error() {
    let folder = Folder::new().with("small.toml", SMALL);
    let args = ["submit", "small.toml", "--to", "slurm", "--shards", "4", "--go"];
    let output = folder.command(&args).env("PATH", folder.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    assert!(stderr(&output).contains("found no `sbatch` on the PATH"), "{}", stderr(&output));
    assert!(stderr(&output).contains("without --go the job is shown"), "{}", stderr(&output));

    let folder = with_command(folder, "sbatch", "exit 3");
    let output = run(&folder, &args);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("`sbatch` ended with exit status: 3"), "{}", stderr(&output));
}

#[test]
fn mistakes_are_told_before_anything_is_submitted() {
    let programs = "name = 'programs'\nseeds = 2\nbudget = { evaluations = 9 }\n[functions]\nname = ['sphere']\n\
        [[optimiser]]\nexternal = { command = ['true'] }\n";
    let folder = Folder::new().with("small.toml", SMALL).with("{#}.toml", SMALL);
    let folder = with_command(folder.with("programs.toml", programs), "sbatch", "touch submitted");
    std::fs::create_dir_all(folder.path().join("other/runs")).unwrap();
    let other = SMALL.replace("small", "other");
    std::fs::write(folder.path().join("other/experiment.toml"), &other).unwrap();
    std::fs::write(folder.path().join("other/programs.toml"), programs).unwrap();
    for (args, message) in [
        (&["small.toml", "--to", "slurm", "--shards", "17"][..], "found 17 shards for 16 runs"),
        (&["small.toml", "--to", "slurm", "--shards", "0"], "invalid value '0' for '--shards <N>'"),
        (&["small.toml", "--to", "pbs"], "possible values: hyperqueue, slurm, parallel"),
        (&["none.toml", "--to", "slurm"], "cannot read none.toml"),
        (&["{#}.toml", "--to", "parallel"], "which GNU parallel may replace"),
        (&["small.toml", "--to", "slurm", "--out", "other"], "holds the results of the experiment"),
        (&["other/programs.toml", "--to", "slurm"], "pass --trust to start them"),
    ] {
        let output = run(&folder, &[&["submit", "--go"], args].concat());
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", stderr(&output));
        assert!(output.stdout.is_empty());
        assert!(stderr(&output).contains(message), "{args:?}: {}", stderr(&output));
    }
    assert!(!folder.path().join("submitted").exists());

    // Tasks have no terminal to be asked on: they go by what is remembered, or are told.
    let trusted = ["submit", "other/programs.toml", "--to", "slurm", "--shards", "2", "--trust"];
    assert!(job(&folder, &run(&folder, &trusted)).contains(" --jobs 1 --trust --shard /2'"));
    let named = programs.replace("['true']", "['true', 'small.toml']");
    std::fs::write(folder.path().join("other/programs.toml"), named).unwrap();
    std::fs::write(folder.path().join("other/small.toml"), SMALL).unwrap();
    assert!(job(&folder, &run(&folder, &trusted)).contains(" --jobs 1 --shard /2'"));
    let task = run(&folder, &["run", "other/programs.toml", "--out", "out", "--shard", "0/2"]);
    assert!(!stderr(&task).contains("--trust"), "{}", stderr(&task));
}

/// Without a number there are as many shards as make sense, which `check` tells as well.
#[test]
fn the_number_of_shards_follows_from_the_time_of_runs() {
    let folder = Folder::new().with("small.toml", SMALL);
    let output = folder.run(&["check", "small.toml"]);
    let line = stdout(&output);
    let line = line.lines().find(|line| line.contains("shards make sense")).unwrap();
    assert!(
        line.contains(
            " for 8 workers of a scheduler; with one shard each, the workers would be idle for "
        ),
        "{line}"
    );
    let job = job(&folder, &folder.run(&["submit", "small.toml", "--to", "hyperqueue"]));
    let shards: usize = job.trim().rsplit_once("--shard /").unwrap().1.parse().unwrap();
    assert!((2..=16).contains(&shards), "{job}");
}
