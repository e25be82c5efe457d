//! What `run --shard` promises: a scheduler's variables are believed where they make sense, shards
//! that run side by side share a folder, and the last of them tells the result.

use std::process::{Child, Stdio};

use crate::folder::{Folder, stderr, stdout};

const SMALL: &str = "name = 'small'\nseeds = 8\nbudget = { evaluations = 2000 }\n\
    [functions]\nname = ['sphere']\n[[optimiser]]\npso = {}\n[[optimiser]]\nrandom = {}\n";

const ARRAY: [(&str, &str); 4] = [
    ("SLURM_ARRAY_TASK_ID", "3"),
    ("SLURM_ARRAY_TASK_MIN", "1"),
    ("SLURM_ARRAY_TASK_STEP", "2"),
    ("SLURM_ARRAY_TASK_COUNT", "4"),
];

#[test]
fn schedulers_tell_the_shard() {
    for (args, variables, told) in [
        (&["--shard"][..], &ARRAY[..], "shard 1/4, from SLURM_ARRAY_TASK_ID"),
        (&["--shard", "/8"], &ARRAY, "shard 3/8, from SLURM_ARRAY_TASK_ID"),
        (&["--shard", "/4"], &[("HQ_TASK_ID", "2")], "shard 2/4, from HQ_TASK_ID"),
        (
            &["--shard", "/4"],
            &[("JOB_COMPLETION_INDEX", "0")],
            "shard 0/4, from JOB_COMPLETION_INDEX",
        ),
    ] {
        let folder = Folder::new().with("small.toml", SMALL);
        let command = [&["run", "small.toml", "--out", "out"], args].concat();
        let output = folder.command(&command).envs(variables.iter().copied()).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stderr(&output).lines().any(|line| line == told), "{}", stderr(&output));
        let runs = std::fs::read_dir(folder.path().join("out/runs")).unwrap().count();
        assert_eq!(runs, if told.contains("/8") { 2 } else { 4 });
        // Others are to come, and what there is so far is no result.
        assert_eq!(stdout(&output).lines().count(), 1, "{}", stdout(&output));
        assert!(!folder.path().join("out/figures").exists());
    }
}

#[test]
fn what_a_scheduler_tells_has_to_make_sense() {
    for (name, value, variables) in [
        ("no_count", "", &[("HQ_TASK_ID", "2")][..]),
        ("out_of_range", "/4", &[("JOB_COMPLETION_INDEX", "4")]),
        ("not_a_number", "/4", &[("SLURM_ARRAY_TASK_ID", "four")]),
        ("not_set", "", &ARRAY[..3]),
        (
            "gap",
            "",
            &[ARRAY[0], ARRAY[1], ("SLURM_ARRAY_TASK_STEP", "1"), ("SLURM_ARRAY_TASK_COUNT", "2")],
        ),
    ] {
        let folder = Folder::new();
        let mut command = folder.command(&["run", "--shard", value]);
        let output = command.envs(variables.iter().copied()).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{name}: {}", stderr(&output));
        assert!(output.stdout.is_empty());
        insta::assert_snapshot!(name, stderr(&output));
    }
}

/// Four at once: every run is stored, no shard takes another's inputs for those of another experiment,
/// and whichever ends last prints the summary and draws the figures.
#[test]
fn shards_side_by_side_share_a_folder() {
    let folder = Folder::new().with("small.toml", SMALL);
    let start = |shard: &str| -> Child {
        let mut command = folder.command(&["run", "small.toml", "--out", "out", "--shard", shard]);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let shards: Vec<Child> = ["0/4", "1/4", "2/4", "3/4"].map(start).into_iter().collect();
    let outputs: Vec<_> =
        shards.into_iter().map(|shard| shard.wait_with_output().unwrap()).collect();
    for output in &outputs {
        assert!(output.status.success(), "{}", stderr(output));
        assert!(!stderr(output).contains("note:"), "{}", stderr(output));
    }
    assert_eq!(std::fs::read_dir(folder.path().join("out/runs")).unwrap().count(), 16);
    assert!(outputs.iter().any(|output| stdout(output).contains("random")));
    assert!(folder.path().join("out/figures/convergence.pdf").is_file());
    assert!(folder.path().join("out/report.html").is_file());
}
