//! Solvers that need packages, and languages beside Python: `tests/external/run.sh` installs them.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use super::{counts, driftless, runs, said, texts};

/// Copies docs/solvers into a folder.
fn copy_solvers(folder: &Path) {
    for entry in fs::read_dir("docs/solvers").unwrap().map(Result::unwrap) {
        fs::copy(entry.path(), folder.join(entry.file_name())).unwrap();
    }
}

/// The optimisers of other packages, each through its script.
const PACKAGES: [(&str, &str, &str); 6] = [
    ("jSO", "use_minion.py", "algorithm = 'jSO'"),
    ("L-SRTDE", "use_minion.py", "algorithm = 'LSRTDE'"),
    ("pycma", "use_cma.py", ""),
    ("COBYQA", "use_scipy.py", "method = 'COBYQA'"),
    ("SLSQP", "use_scipy.py", "method = 'SLSQP'"),
    ("NGOpt", "use_nevergrad.py", "optimizer = 'NGOpt'"),
];

/// Each script spends its budget, or ends once its package has converged, and finds what its package can find.
#[test]
#[ignore = "needs minionpy, cma, SciPy and nevergrad: tests/external/run.sh"]
fn scripts_of_other_packages_search() {
    let folder = tempfile::tempdir().unwrap();
    copy_solvers(folder.path());
    let mut experiment = "name = 'packages'\nseeds = 2\nbudget = { evaluations = 1500 }\n\
        functions = { name = ['sphere'], dimension = [4] }\n"
        .to_owned();
    for (label, script, settings) in PACKAGES {
        let _ = write!(
            experiment,
            "[[optimiser]]\nlabel = '{label}'\nexternal = {{ command = ['python3', '{script}'], \
             files = ['{script}', 'door.py'], settings = {{ {settings} }} }}\n"
        );
    }
    fs::write(folder.path().join("packages.toml"), experiment).unwrap();
    let output = driftless(folder.path(), &["run", "packages.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", said(&output));
    let runs = runs(&folder.path().join("out"));
    assert_eq!(texts(&runs, "message"), vec![""; 12]);
    for (status, evaluations) in texts(&runs, "status").iter().zip(counts(&runs, "evaluations")) {
        match &**status {
            "budget-spent" => assert_eq!(evaluations, 1500),
            status => {
                assert!(status == "finished" && evaluations <= 1500, "{status}: {evaluations}");
            }
        }
    }
    let costs = runs.column("certified_j").unwrap().f64().unwrap().clone();
    for (label, cost) in texts(&runs, "optimiser").iter().zip(costs.iter()) {
        // A point drawn at random costs 35 in the mean.
        assert!(cost.unwrap() < 0.5, "{label}: {cost:?}");
    }
}

/// One swarm through both doors, on the default task and four functions: killed in the middle, resumed, and reported
/// together, no run is lost and every one has spent its budget; in the median the two end alike.
#[test]
#[ignore = "needs numpy: tests/external/run.sh"]
fn a_swarm_goes_through_both_doors() {
    let folder = tempfile::tempdir().unwrap();
    copy_solvers(folder.path());
    let program = Path::new(env!("CARGO_BIN_EXE_driftless")).with_file_name("examples/swarm");
    for name in ["swarms", "swarms_on_the_task"] {
        let race = || {
            let mut race = Command::new(&program);
            let file = format!("{name}.toml");
            race.args([&*file, name]).current_dir(folder.path()).stdout(Stdio::null());
            race
        };
        let results = folder.path().join(name);
        let stored = || {
            let entries = fs::read_dir(results.join("runs")).into_iter().flatten().flatten();
            let batches = entries.filter(|e| e.path().extension().is_some_and(|e| e == "parquet"));
            batches.count()
        };
        let mut first = race().spawn().unwrap();
        super::wait_until(|| stored() >= 8);
        first.kill().unwrap();
        first.wait().unwrap();
        assert!(race().status().unwrap().success());
        let runs = runs(&results);
        let instances = if name == "swarms" { 4 } else { 1 };
        assert_eq!(runs.height(), 2 * 15 * instances);
        assert_eq!(texts(&runs, "status"), vec!["budget-spent"; runs.height()]);
        assert_eq!(counts(&runs, "evaluations"), vec![20_000; runs.height()]);
        let costs = runs.column("certified_j").unwrap().f64().unwrap().clone();
        let (labels, instances) = (texts(&runs, "optimiser"), texts(&runs, "instance"));
        let mut kinds = instances.clone();
        kinds.sort_unstable();
        kinds.dedup();
        for kind in kinds {
            let median = |swarm: &str| {
                // On the task a label has the formulation behind it.
                let own = |i: &usize| labels[*i].starts_with(swarm) && instances[*i] == kind;
                let mut costs: Vec<f64> =
                    (0..labels.len()).filter(own).map(|i| costs.get(i).unwrap()).collect();
                assert_eq!(costs.len(), 15);
                costs.sort_by(f64::total_cmp);
                costs[7]
            };
            let (python, rust) = (median("swarm in Python"), median("swarm in Rust"));
            // Medians of 15 runs of one method: the decades that one of them spans are far fewer than those to a point drawn at
            // random, 35 to 1e-5 on the sphere.
            assert!(
                (python.max(1e-9) / rust.max(1e-9)).log10().abs() < 1.0,
                "{kind}: {python} {rust}"
            );
        }
    }
    let report =
        driftless(folder.path(), &["report", "swarms", "swarms_on_the_task", "--out", "together"]);
    assert!(report.status.success(), "{}", said(&report));
    let summary = String::from_utf8_lossy(&report.stdout);
    assert!(summary.contains("swarm in Python") && summary.contains("swarm in Rust"), "{summary}");
    assert!(folder.path().join("together/report.html").is_file());
}
