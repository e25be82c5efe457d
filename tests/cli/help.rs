//! Completions, man pages, and verbs given another kind of file than they take.

use crate::folder::{Folder, stderr, stdout};

#[test]
fn completions_are_printed_for_every_shell() {
    let folder = Folder::new();
    for (shell, expected) in [
        ("bash", "complete -F _driftless"),
        ("zsh", "#compdef driftless"),
        ("fish", "complete -c driftless"),
        ("elvish", "edit:completion:arg-completer[driftless]"),
        ("powershell", "Register-ArgumentCompleter -Native -CommandName 'driftless'"),
    ] {
        let output = folder.run(&["completions", shell]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stdout(&output).contains(expected), "{shell}");
        assert!(stdout(&output).contains("entry"), "{shell} lacks `plan --entry`");
    }
    assert_eq!(folder.run(&["completions", "cmd"]).status.code(), Some(2));
}

#[test]
fn every_verb_has_a_man_page() {
    let folder = Folder::new();
    let output = folder.run(&["man", "--out", "pages"]);
    assert!(output.status.success(), "{}", stderr(&output));
    for (page, expected) in [
        ("driftless.1", "driftless\\-plan(1)"),
        ("driftless-plan.1", "\\fB\\-\\-budget\\fR"),
        ("driftless-robot-convert.1", "\\fB\\-\\-to\\fR"),
        ("driftless-completions.1", "zsh"),
    ] {
        let text = std::fs::read_to_string(folder.path().join("pages").join(page)).unwrap();
        assert!(text.contains(".SH NAME") && text.contains(expected), "{page}: {text}");
    }
    let printed = stdout(&folder.run(&["man"]));
    let written = std::fs::read_to_string(folder.path().join("pages/driftless.1")).unwrap();
    assert_eq!(printed.trim_end(), written.trim_end());
}

/// Every kind of file, given to verbs that take another: both kinds are named, and the verb that takes it.
#[test]
fn files_of_another_kind_are_named() {
    let robot = include_str!("../../src/robot/shipped/ur5e.toml");
    let folder = Folder::new()
        .with("robot.toml", robot)
        .with("task.toml", "[task]\nrobot = 'ur5e'\n")
        .with("motion.toml", "[motion]\nt_f = 5\ncoefficients = [[0, 0]]\n")
        .with("experiment.toml", "name = 'e'\n[[optimiser]]\nrandom = {}\n")
        .with("robot.urdf", "<robot name='r'><link name='base'/></robot>")
        .with("motion.csv", "time,a\n0,0\n1,1\n");
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    std::fs::create_dir(folder.path().join("results")).unwrap();
    std::fs::write(folder.path().join("results/experiment.toml"), "name = 'e'\n").unwrap();
    let task = "expected a task file";
    let mut cases = vec![
        (
            "plan",
            "experiment.toml",
            "is an experiment file",
            task,
            "`driftless run`, `submit` and `check` take it",
        ),
        ("plan", "robot.toml", "is a robot", task, "a task names it"),
        ("plan", "robot.urdf", "is a robot", task, "a task names it"),
        (
            "plan",
            "motion.toml",
            "is a motion file",
            task,
            "`driftless replay` and `animate` take it",
        ),
        ("plan", "motion.csv", "is a trajectory", task, "`driftless replay` and `animate` take it"),
        ("plan", "empty", "is a folder", task, ""),
        ("plan", "results", "is a folder of results", task, "`driftless report`"),
        ("replay", "task.toml", "is a task file", "expected a motion file", "`driftless plan`"),
        ("replay", "experiment.toml", "is an experiment file", "expected a motion", "run"),
        ("check", "motion.csv", "is a trajectory", "expected a task, robot", "`driftless replay`"),
        ("check", "results", "is a folder of results", "expected", "`driftless report`"),
    ];
    if cfg!(feature = "harness") {
        let (experiment, results) = ("expected an experiment file", "expected a folder of results");
        cases.extend([
            ("run", "task.toml", "is a task file", experiment, "`driftless plan` takes it"),
            ("run", "robot.toml", "is a robot", experiment, "`driftless check`"),
            ("run", "ur5e", "is a robot", experiment, "`driftless check`"),
            ("run", "results", "is a folder of results", experiment, "`driftless report`"),
            ("serve", "experiment.toml", "is an experiment file", task, "`driftless run`"),
            ("report", "experiment.toml", "is an experiment file", results, "`driftless run`"),
            ("status", "task.toml", "is a task file", results, "`driftless plan` takes it"),
        ]);
    }
    let convert = ["robot", "convert", "task.toml"];
    let mut commands: Vec<(Vec<&str>, [&str; 3])> =
        vec![(convert.to_vec(), ["is a task file", "expected a robot", "`driftless plan`"])];
    for (verb, file, found, expected, help) in cases {
        commands.push((vec![verb, file], [found, expected, help]));
    }
    for (args, told) in commands {
        let output = folder.run(&args);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", stderr(&output));
        let message = stderr(&output).replace("\n  │ ", " ");
        let words = message.split_whitespace().collect::<Vec<_>>().join(" ");
        for text in told {
            assert!(words.contains(text), "{args:?}: {words}");
        }
    }
}

/// What robots that come with the program state is as published; another robot is warned of once, and only where it is looked at.
#[test]
fn impossible_inertias_are_told_once() {
    let robot = include_str!("../../src/robot/shipped/xiao2023.toml");
    let own = robot.replacen("name = \"xiao2023\"", "name = \"own\"", 1);
    assert_ne!(own, robot);
    let experiment = "name = 'e'\nseeds = 1\nbudget = { evaluations = 20 }\n\
        [task]\nrobot = 'own.toml'\nstart = { joints_deg = [10, 30, 45, -20, -25, 40], base_zyx_deg = [6, 15, 7] }\n\
        goal = { joints_deg = [40, 60, 90, -10, -30, 60], base_zyx_deg = [0, 0, 0] }\n\
        limits = { rate_deg_s = 60, acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }\n";
    let field = "[sweep]\njerk_limit_deg_s3 = [40, 80, 160]\n[[optimiser]]\nrandom = {}\n";
    let task = experiment.split_once("[task]").unwrap().1;
    let folder = Folder::new()
        .with("own.toml", own)
        .with("task.toml", format!("[task]{task}"))
        .with("e.toml", experiment.to_owned() + field);
    let count = |args: &[&str]| {
        let output = folder.run(args);
        assert!(output.status.success(), "{args:?}: {}", stderr(&output));
        stderr(&output).matches("breaks the triangle inequality").count()
    };
    assert_eq!(count(&["check", "own.toml"]), 1);
    assert_eq!(count(&["robot", "convert", "own.toml"]), 1);
    assert_eq!(count(&["plan", "task.toml", "--optimiser", "random", "--budget", "20"]), 1);
    for robot in ["xiao2023", "panda"] {
        assert_eq!(count(&["check", robot]), 0);
        assert_eq!(count(&["robot", "convert", robot, "--to", "toml"]), 0);
    }
    if cfg!(feature = "harness") {
        assert_eq!(count(&["check", "e.toml", "--no-estimate"]), 1);
        assert_eq!(count(&["run", "e.toml", "--out", "out"]), 0);
    }
}
