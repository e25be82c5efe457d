//! The commands of README and book, run in a folder of their own, page by page.
//!
//! In `console` blocks what a command prints is compared with the page; `…` stands for anything. In `sh` blocks commands of the
//! program have to succeed. A block after a comment `<!-- not run: WHY -->` is left out.
#![cfg(all(unix, feature = "harness", feature = "cli"))]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

/// What makes runs and plans of `sh` blocks short.
const SHORT: [(&str, &str); 2] =
    [("driftless run ", " --seeds 2 --budget 300"), ("driftless plan ", " --budget 200")];

#[derive(Debug, PartialEq)]
enum Part {
    /// A file that the reader is to save.
    File { name: String, text: String },
    /// A command, and what it prints where the page shows that.
    Command { line: String, prints: Option<String> },
}

/// What a page has the reader do, in order, and how many commands are left out: those of other programs, too.
fn parts(page: &str) -> (Vec<Part>, usize) {
    let (mut parts, mut left_out) = (Vec::new(), 0);
    let (mut name, mut is_left_out) = (None, false);
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        let Some(kind) = line.strip_prefix("```") else {
            // Across the empty line between a remark and its block, and no further.
            if !line.trim().is_empty() {
                is_left_out = line.starts_with("<!-- not run: ");
                let saved = line.split("as `").nth(1).and_then(|rest| rest.split('`').next());
                name = saved
                    .filter(|name| Path::new(name).extension().is_some_and(|e| e == "toml"))
                    .map(str::to_owned)
                    .or(name);
            }
            continue;
        };
        let block: Vec<&str> = lines.by_ref().take_while(|line| !line.starts_with("```")).collect();
        let own = match kind {
            "toml" => {
                let text = block.join("\n") + "\n";
                name.take().map(|name| Part::File { name, text }).into_iter().collect()
            }
            "sh" => {
                let (own, others): (Vec<&str>, Vec<&str>) =
                    block.iter().partition(|line| line.starts_with("driftless "));
                let is_command = |line: &&str| !line.is_empty() && !line.starts_with('#');
                left_out += others.into_iter().filter(is_command).count();
                let command = |line: &str| {
                    let line = line.split(" #").next().unwrap_or_default().trim().to_owned();
                    Part::Command { line, prints: None }
                };
                own.into_iter().map(command).collect()
            }
            "console" => shown(&block),
            _ => Vec::new(),
        };
        if is_left_out {
            left_out += own.iter().filter(|part| matches!(part, Part::Command { .. })).count();
        } else {
            parts.extend(own);
        }
        is_left_out = false;
    }
    (parts, left_out)
}

/// The commands of a `console` block with what they print.
fn shown(block: &[&str]) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    for line in block {
        match (line.strip_prefix("$ "), parts.last_mut()) {
            (Some(command), _) => {
                let prints = Some(String::new());
                parts.push(Part::Command { line: command.to_owned(), prints });
            }
            (None, Some(Part::Command { prints: Some(prints), .. })) => {
                prints.push_str(line);
                prints.push('\n');
            }
            _ => panic!("{line}: a block of kind `console` begins with a command"),
        }
    }
    parts
}

/// Whether a text is as expected, where `…` stands for anything within a line, and for any lines where it stands alone.
fn is_as_expected(found: &[&str], expected: &[&str]) -> bool {
    match expected {
        [] => found.is_empty(),
        ["…", rest @ ..] => (0..=found.len()).any(|skip| is_as_expected(&found[skip..], rest)),
        [line, rest @ ..] => {
            let is_line = |found: &&str| matches(found.trim_end(), line.trim_end());
            found.first().is_some_and(is_line) && is_as_expected(&found[1..], rest)
        }
    }
}

fn matches(found: &str, expected: &str) -> bool {
    let Some((before, after)) = expected.split_once('…') else { return found == expected };
    let Some(rest) = found.strip_prefix(before) else { return false };
    let mut places = rest.char_indices().map(|(at, _)| at).chain([rest.len()]);
    places.any(|at| matches(&rest[at..], after))
}

/// A folder in which the commands of a page are run.
struct Sandbox(TempDir);

impl Sandbox {
    /// What is printed, errors and output in the order in which they come; fails where the command does.
    fn run(&self, line: &str) -> String {
        let is_open =
            |(verb, _): &&(&str, &str)| line.starts_with(verb) && !line.contains(" --budget");
        let short = SHORT.iter().find(is_open).map_or("", |(_, options)| options);
        self.run_as_it_is(&format!("{line}{short}"))
    }

    fn run_as_it_is(&self, line: &str) -> String {
        let program = Path::new(env!("CARGO_BIN_EXE_driftless")).parent().unwrap();
        let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
        // Files of the repository stay where they are.
        let folder = if line.contains(" docs/") { Path::new(".") } else { self.0.path() };
        let mut shell = Command::new("sh");
        let shell = shell.args(["-c", &format!("exec 2>&1; {line}")]).current_dir(folder);
        let output = shell.env("PATH", path).env("COLUMNS", "100").output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success(), "{line}: {text}");
        text
    }
}

/// What a page takes for granted.
fn prepare(page: &str, sandbox: &Sandbox) {
    let (files, _) = parts(&fs::read_to_string("README.md").unwrap());
    for part in files {
        if let Part::File { name, text } = part {
            fs::write(sandbox.0.path().join(name), text).unwrap();
        }
    }
    let lines: &[&str] = match page {
        "docs/animate.md" | "docs/gallery.md" | "docs/motions.md" => {
            &["driftless run example.toml"]
        }
        "docs/cluster.md" => &[
            "sed s/example/experiment/ example.toml > experiment.toml",
            "driftless run experiment.toml --shard 0/4",
        ],
        "docs/experiments.md" => &["driftless run example.toml --out results/mine"],
        "docs/import.md" => &[
            "driftless run example.toml --out results/ours",
            "driftless export results/ours --format ioh --out ioh-data",
            "driftless export results/ours --format coco --out exdata",
            "printf 'problem,optimiser,seed,evaluation,cost\\np,o,1,1,2.5\\np,o,1,7,0.5\\n' > runs.csv",
        ],
        "docs/robots.md" => &["driftless robot convert panda --out panda.urdf"],
        "docs/trajectories.md" => &["driftless plan my-task.toml --motion motion.csv"],
        _ => &[],
    };
    for line in lines {
        sandbox.run(line);
    }
}

/// Runs the commands of a page; gives how many those are, and how many are left out.
fn follow(page: &Path) -> (usize, usize) {
    let name = page.display().to_string();
    let (parts, left_out) = parts(&fs::read_to_string(page).unwrap());
    let is_command = |part: &&Part| matches!(part, Part::Command { .. });
    let count = parts.iter().filter(is_command).count();
    if count == 0 {
        return (0, left_out);
    }
    let sandbox = Sandbox(tempfile::tempdir().unwrap());
    prepare(&name, &sandbox);
    for part in &parts {
        match part {
            Part::File { name, text } => fs::write(sandbox.0.path().join(name), text).unwrap(),
            Part::Command { line, prints: None } => drop(sandbox.run(line)),
            Part::Command { line, prints: Some(expected) } => {
                let found = sandbox.run_as_it_is(line);
                let [a, b] = [&found, expected].map(|text| text.lines().collect::<Vec<_>>());
                assert!(
                    is_as_expected(&a, &b),
                    "{name}: {line} prints\n{found}\nexpected\n{expected}"
                );
            }
        }
    }
    (count, left_out)
}

fn pages(folder: &str) -> Vec<PathBuf> {
    let mut pages: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    pages.retain(|page| page.extension().is_some_and(|extension| extension == "md"));
    pages.sort();
    pages
}

#[test]
fn commands_do_what_pages_say() {
    let pages = [vec![PathBuf::from("README.md")], pages("docs"), pages("docs/reference")].concat();
    let (mut run, mut left_out) = (0, 0);
    for page in &pages {
        let (own, own_left_out) = follow(page);
        if own + own_left_out > 0 {
            println!("{}: {own} commands run, {own_left_out} left out", page.display());
        }
        run += own;
        left_out += own_left_out;
    }
    println!("all pages: {run} commands run, {left_out} left out");
    // A page whose blocks are no longer recognised would lose its commands unseen.
    assert!(run >= 45, "{run} {left_out}");
}

#[test]
fn pages_are_read_as_meant() {
    let page = "Save this as `a.toml`:\n\n```toml\nx = 1\n```\n```console\n$ driftless list\nopt…s\n…\nend\n```\n\
                <!-- not run: needs a cluster -->\n\n```sh\ndriftless submit a   # why\n```\n```sh\ndriftless check a.toml   # ok\nls\n```\n";
    let (found, left_out) = parts(page);
    let command = |line: &str, prints: Option<&str>| Part::Command {
        line: line.to_owned(),
        prints: prints.map(str::to_owned),
    };
    let file = Part::File { name: "a.toml".to_owned(), text: "x = 1\n".to_owned() };
    let shown = command("driftless list", Some("opt…s\n…\nend\n"));
    assert_eq!((found, left_out), (vec![file, shown, command("driftless check a.toml", None)], 2));
    assert!(is_as_expected(&["optimisers", "b", "c", "end"], &["opt…s", "…", "end"]));
    assert!(is_as_expected(&["optimisers", "end"], &["opt…s", "…", "end"]));
    assert!(!is_as_expected(&["optimiser", "end"], &["opt…s", "…", "end"]));
    assert!(!is_as_expected(&["optimisers", "end", "more"], &["opt…s", "…", "end"]));
}
