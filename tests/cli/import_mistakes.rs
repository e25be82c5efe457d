//! What `import` says of data that are not what they should be, and other verbs of imported folders that are not.

use std::fs;
use std::path::PathBuf;

use crate::folder::{Folder, stderr};
use crate::import::{data, imported};

/// A folder that says it was imported holds nothing that can be run, and names runs that there can be.
#[test]
fn mistakes_in_an_imported_table_are_named() {
    let (folder, _) = imported("csv");
    let file = folder.path().join("theirs/experiment.toml");
    let text = fs::read_to_string(&file).unwrap();
    let own = format!("{text}\n\n[[optimiser]]\nrandom = {{}}\n");
    for (changed, expected) in [
        (own, "beside `imported`"),
        (
            text.replace("optimiser = 1\n", "optimiser = 2\n"),
            "found optimiser 2, expected one from 1 to 1",
        ),
        (
            text.replace("problems = [1]", "problems = [0]"),
            "found problem 0, expected one from 1 to 2",
        ),
        (text.replace("seeds = [7, 9]", "seeds = [7, 7]"), "twice, expected each run once"),
        (text.replace("format = \"csv\"", "format = \"tsv\""), "unknown variant `tsv`"),
        (text.replace("\"suite\":\"\"", "\"suit\":\"\""), "found no origin of an imported problem"),
    ] {
        assert_ne!(changed, text, "{expected}");
        fs::write(&file, changed).unwrap();
        let output = folder.run(&["status", "theirs"]);
        assert_eq!(output.status.code(), Some(2), "{expected}");
        assert!(one_line(&stderr(&output)).contains(expected), "{expected}: {}", stderr(&output));
    }
}

/// An error as one line, without what draws its frame.
fn one_line(error: &str) -> String {
    let words = error.lines().map(|line| line.trim_start_matches([' ', '│', '×', '╰', '─', '▶']));
    words.collect::<Vec<_>>().join(" ")
}

/// Names and texts of files.
type Files = Vec<(&'static str, String)>;

/// Every mistake has its file and, where there is one, its line, and nothing is left behind.
#[expect(clippy::too_many_lines, reason = "a list")]
#[test]
fn mistakes_are_named_and_leave_nothing() {
    let ioh = |text: &str| -> Files {
        let index = fs::read_to_string(data("ioh/uniform/IOHprofiler_f1_Sphere.json")).unwrap();
        let (old, new) = text.split_once(" -> ").unwrap();
        assert!(index.contains(old), "{old}");
        let table = fs::read_to_string(data("ioh/uniform/data_f1_Sphere/IOHprofiler_f1_DIM2.dat"));
        vec![
            ("IOHprofiler_f1_Sphere.json", index.replacen(old, new, 1)),
            ("data_f1_Sphere/IOHprofiler_f1_DIM2.dat", table.unwrap()),
        ]
    };
    let table = |text: &str| {
        let mut files = ioh("uniform -> uniform");
        files[1].1 = text.to_owned();
        files
    };
    let csv =
        |text: &str| vec![("runs.csv", format!("problem,optimiser,seed,evaluation,cost\n{text}"))];
    let coco = |head: &str, data: &str, rows: &str| {
        vec![("a.info", format!("{head}\n% c\n{data}\n")), ("a.dat", rows.to_owned())]
    };
    let head = "suite = 'x', funcId = 1, DIM = 2, algId = 'a', data_format = 'bbob-new2'";
    let cases: Vec<(&str, Files, &str)> = vec![
        ("ioh", vec![("a.txt", String::new())], "expected IOHprofiler_f*.json"),
        (
            "csv",
            vec![(
                "runs.csv",
                format!("problem,optimiser,seed,evaluation,cost,budget\np,o,1,1,1,{}\n", u64::MAX),
            )],
            "found the budget 18446744073709551615",
        ),
        ("ioh", ioh("\"maximization\": false -> \"maximization\": true"), "maximised"),
        ("ioh", ioh("\"function_id\": 1 -> \"function_id\": x"), "IOHprofiler_f1_Sphere.json:4: "),
        ("ioh", ioh("\"path\": \"data -> \"path\": \"../data"), "one below this file's folder"),
        (
            "ioh",
            ioh("\"evals\": 60 -> \"evals\": 59"),
            "found the evaluation 60 in run 1, expected 59",
        ),
        (
            "ioh",
            ioh("{\"instance\": 1, -> {\"instance\": 1, \"seed\": 1.5,"),
            "found the seed `1.5` of run 1 of data_f1_Sphere/IOHprofiler_f1_DIM2.dat, expected a whole number",
        ),
        (
            "ioh",
            ioh("{\"instance\": 1, -> {\"instance\": 1, \"seed\": 2,"),
            "with a seed and without, expected all to have one, or none",
        ),
        ("ioh", table("evaluations raw_y\n1 2.5\n"), "found 1 run, expected 4"),
        ("ioh", table("evaluations raw_y\n1 2.5\n2 x\n"), "DIM2.dat:3: found `x`, expected a cost"),
        (
            "ioh",
            table("evaluations y\n1 2.5\n"),
            "DIM2.dat:1: found `evaluations y`, expected the columns",
        ),
        ("ioh", table("1 2.5\n"), "DIM2.dat:1: found `1 2.5`, expected a heading"),
        ("csv", csv("p,o,1,1\n"), "runs.csv:2: found 4 fields, expected 5"),
        ("csv", csv("p,o,1,0,1\n"), "runs.csv:2: found `0` in the column `evaluation`"),
        ("csv", csv("p,o,-1,1,1\n"), "runs.csv:2: found `-1` in the column `seed`"),
        (
            "csv",
            csv("p,o,1,1,1\np,o,1,1,2\n"),
            "found the evaluation 1 of the run of `o` on `p` with seed 1 twice",
        ),
        ("csv", csv("p,,1,1,1\n"), "runs.csv:2: found `` in the column `optimiser`"),
        ("csv", csv(""), "found no runs"),
        (
            "csv",
            vec![("runs.csv", "problem,seed\n".to_owned())],
            "runs.csv:1: found no column `optimiser`",
        ),
        (
            "csv",
            vec![("runs.csv", "problem,sed\n".to_owned())],
            "runs.csv:1: found the column `sed`",
        ),
        (
            "coco",
            coco("suite = 'x'", "a.dat, 1:1|1", ""),
            "a.info:1: found `suite = 'x'`, expected funcId",
        ),
        (
            "coco",
            coco("funcId = 1, DIM = 2, algId = 'a', indicator = 'hyp'", "", ""),
            "two objectives",
        ),
        ("coco", coco(head, "a.dat, 1:1|1, one", ""), "a.info:3: found `one`, expected a table"),
        ("coco", coco(head, "/etc/a.dat, 1:1|1", ""), "one below this file's folder"),
        (
            "coco",
            coco(head, "a.dat, 1:1|1, 2:1|1", "%\n1 0 1 1 1\n"),
            "a.dat: found 1 run, expected 2",
        ),
        (
            "coco",
            coco(head, "a.dat, 1:1|1", "%\n1 0 1 1 1\n%\n1 0 1 1 1\n"),
            "a.dat: found more runs",
        ),
        (
            "coco",
            coco(head, "a.dat, 1:9|1", "%\n1 0 x 1 1\n"),
            "a.dat:2: found `x`, expected a number",
        ),
        ("coco", coco(head, "a.dat, 1:9|1", "%\n1 3 1 1 1\n"), "evaluations of constraints"),
        (
            "coco",
            coco(head, "a.dat, 1:9|1", "%\n5 0 1 1 1\n4 0 1 1 1\n"),
            "a.dat:3: found `4`, expected one from 5",
        ),
        (
            "coco",
            coco(head, "a.dat, 1:1|1", "%\n5 0 1 1 1\n"),
            "found the evaluation 5 in run 1, expected 1",
        ),
        ("coco", coco(head, "b.dat, 1:1|1", ""), "cannot read"),
    ];
    for (format, files, expected) in cases {
        let folder = Folder::new();
        for (name, text) in &files {
            let path: PathBuf = folder.path().join("data").join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let output = folder.run(&["import", "--format", format, "data", "--out", "theirs"]);
        let said = one_line(&stderr(&output));
        assert!(!output.status.success(), "{expected}");
        assert!(said.contains(expected), "{expected}: {said}");
        let left: Vec<_> =
            fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left, ["data"], "{expected}");
    }
}
