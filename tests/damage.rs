//! Stored files that are damaged, or not what a run leaves: each is named and set aside, nothing else changes, and what was
//! in it is done again.

#![cfg(feature = "harness")]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use driftless::experiment::{
    Damage, Experiment, Folder, Options, Progress, Record, RunSpec, Store, load, standing,
};
use driftless::input::Document;
use driftless::registry;
use driftless::search::{Rng, Watch};
use polars::prelude::*;

/// 100 runs of eight evaluations, in a few batches.
const MANY: &str = "name = 'many'\nseeds = 25\nbudget = { evaluations = 8 }\n[sweep]\nweight_base = [0.5, 1]\n\
    [[optimiser]]\nrandom = {}\n[[optimiser]]\nde = {}\n";
/// Six runs, each a batch of its own.
const FEW: &str = "name = 'few'\nseeds = 3\nbudget = { evaluations = 500 }\n\
    [[optimiser]]\nrandom = {}\n[[optimiser]]\nrandom = { formulation = 'scaled' }\n";

const TABLES: [&str; 3] = ["traces", "clocks", "runs"];
/// What holds wall time or a date.
const TIMES: [&str; 3] = ["seconds", "seconds_in_problem", "date"];

/// Keeps what was set aside.
#[derive(Default)]
struct Told(Mutex<Vec<Damage>>);

impl Progress for Told {
    fn finished(&self, _: &RunSpec, _: &Record) {}

    fn set_aside(&self, damage: &Damage) {
        self.0.lock().unwrap().push(damage.clone());
    }
}

fn create(path: &Path, experiment: &str) -> Folder {
    let experiment = Experiment::read(&Document::embedded("test", experiment), &registry());
    Folder::create(path, experiment.unwrap().plan().unwrap()).unwrap()
}

/// Does what is missing; what was set aside for it.
fn run(folder: &Folder) -> Vec<Damage> {
    let told = Told::default();
    folder.run(Options::default().with_jobs(1), &Watch::default(), &told).unwrap();
    told.0.into_inner().unwrap()
}

fn open(path: &Path) -> Folder {
    Folder::open(path, &registry()).unwrap()
}

/// All that is stored, in the plan's order, without what holds wall time.
fn tables(folder: &Folder) -> Vec<DataFrame> {
    let keys = || folder.plan.runs.iter().map(|run| run.key.as_str());
    let read = |table| folder.store.read(table, keys()).unwrap().drop_many(TIMES);
    ["runs", "traces"].into_iter().map(read).collect()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let list = |table| fs::read_dir(folder.join(table)).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = TABLES.into_iter().flat_map(list).collect();
    files.sort();
    files
}

/// The three files of a batch.
fn batch(folder: &Path, name: &str) -> [PathBuf; 3] {
    TABLES.map(|table| folder.join(table).join(format!("{name}.parquet")))
}

fn name(file: &Path) -> String {
    file.file_stem().unwrap().to_str().unwrap().to_owned()
}

#[test]
fn no_flipped_bit_goes_unnoticed() {
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path();
    let folder = create(path, MANY);
    run(&folder);
    let (whole, files) = (tables(&folder), files(path));
    assert_eq!((whole[0].height(), folder.store.damaged()), (100, Vec::new()));
    assert!((6..=60).contains(&files.len()), "{} files", files.len());
    let mut rng = Rng::new(50);
    let mut last = None;
    for flip in 0..2_000 {
        let file = &files[rng.index(files.len())];
        let bytes = fs::read(file).unwrap();
        let mut flipped = bytes.clone();
        let bit = rng.index(8 * bytes.len());
        flipped[bit / 8] ^= 1 << (bit % 8);
        fs::write(file, &flipped).unwrap();
        let store = Store::existing(path);
        let (rest, damaged) = (store.keys().unwrap(), store.damaged());
        assert_eq!(damaged.len(), 1, "bit {bit} of {}", file.display());
        assert_eq!(&damaged[0].path, file);
        assert_eq!(damaged[0].reason, "does not match its checksum");
        assert!((1..100).contains(&rest.len()), "{} runs", rest.len());
        if flip % 100 == 0 {
            let folder = open(path);
            let runs = load(&folder.plan, &folder.store).unwrap();
            assert_eq!(runs.len(), rest.len());
            assert!(runs.iter().all(|run| rest.contains(&run.key) && !run.trace.is_empty()));
        }
        last = Some((file.clone(), flipped));
        fs::write(file, bytes).unwrap();
    }
    assert_eq!(tables(&open(path)).as_slice(), whole.as_slice());
    // The last one stays, and is set aside and done again.
    let (file, flipped) = last.unwrap();
    fs::write(&file, &flipped).unwrap();
    let folder = open(path);
    let aside = run(&folder);
    assert_eq!(aside.iter().map(|damage| &damage.path).collect::<Vec<_>>(), [&file]);
    let table = file.parent().unwrap().file_name().unwrap().to_str().unwrap();
    let kept = path.join("damaged").join(name(&file)).join(format!("{table}.parquet"));
    assert_eq!(fs::read(kept).unwrap(), flipped);
    assert_eq!(tables(&open(path)).as_slice(), whole.as_slice());
    assert_eq!(run(&open(path)), []);
}

/// The bytes of a table as another program would write them, without a checksum.
fn rewritten(path: &Path, change: impl FnOnce(DataFrame) -> DataFrame) {
    let mut frame = change(ParquetReader::new(fs::File::open(path).unwrap()).finish().unwrap());
    ParquetWriter::new(fs::File::create(path).unwrap()).finish(&mut frame).unwrap();
}

fn with(mut frame: DataFrame, column: impl Into<Column>) -> DataFrame {
    frame.with_column(column.into()).unwrap();
    frame
}

/// A list column of one row.
fn list(name: &str, values: &[f64]) -> Series {
    Series::new(name.into(), [Series::new("".into(), values)])
}

#[test]
fn files_without_a_checksum_are_read() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = create(temporary.path(), FEW);
    run(&folder);
    let whole = tables(&folder);
    for file in files(temporary.path()) {
        rewritten(&file, |frame| frame);
    }
    let folder = open(temporary.path());
    assert_eq!(tables(&folder), whole);
    assert_eq!(run(&folder), []);
}

/// What a change of a batch's three files, given the six batches' names, does to the first batch.
type Change = Box<dyn Fn(&Path, &[String])>;

fn of_table(table: &'static str, change: impl Fn(DataFrame) -> DataFrame + 'static) -> Change {
    let place = TABLES.iter().position(|name| *name == table).unwrap();
    Box::new(move |path, names| rewritten(&batch(path, &names[0])[place], &change))
}

fn of_file(table: &'static str, change: impl Fn(&Path) + 'static) -> Change {
    let place = TABLES.iter().position(|name| *name == table).unwrap();
    Box::new(move |path, names| {
        let file = &batch(path, &names[0])[place];
        fs::remove_file(file).unwrap();
        change(file);
    })
}

/// What others may have made of a batch: the table at fault and what is said of it.
fn changes() -> Vec<(&'static str, &'static str, Change)> {
    let renamed: Change = Box::new(|path, names| {
        for (from, to) in batch(path, &names[1]).iter().zip(batch(path, &names[0])) {
            fs::copy(from, to).unwrap();
        }
    });
    let mixed: Change = Box::new(|path, names| {
        fs::copy(&batch(path, &names[1])[0], &batch(path, &names[0])[0]).unwrap();
    });
    let nine = |frame: DataFrame| (0..8).fold(frame.clone(), |all, _| all.vstack(&frame).unwrap());
    let real = |name: &'static str, value: Option<f64>| {
        of_table("runs", move |frame| with(frame, Series::new(name.into(), [value])))
    };
    let in_trace = |name: &'static str, value: f64| {
        of_table("traces", move |frame| {
            let rows = frame.height();
            let mut values: Vec<f64> =
                frame.column(name).unwrap().f64().unwrap().into_no_null_iter().collect();
            values[rows - 1] = value;
            with(frame, Series::new(name.into(), values))
        })
    };
    let recipe = |frame: DataFrame| {
        let recipe = frame.column("recipe").unwrap().str().unwrap().get(0).unwrap().to_owned();
        with(frame, Series::new("recipe".into(), [recipe.replace("\"seed\":", "\"seed\":1")]))
    };
    vec![
        ("runs", "expected the run that it is named by", renamed),
        ("runs", "with a recipe that gives another key", of_table("runs", recipe)),
        ("traces", "which is no run of its batch", mixed),
        ("runs", "more than once", of_table("runs", nine)),
        ("runs", "has 3 numbers in `x`", of_table("runs", |f| with(f, list("x", &[0.1; 3])))),
        (
            "runs",
            "has 1 number in `coefficients`, expected 12",
            of_table("runs", |frame| with(frame, list("coefficients", &[0.1]))),
        ),
        ("runs", "in the column `seconds`", real("seconds", Some(f64::NAN))),
        ("runs", "a null in the column `seconds`", real("seconds", None)),
        ("runs", "in the column `j`", real("j", Some(f64::INFINITY))),
        (
            "runs",
            "has f64 in the column `evaluations`, expected u64",
            real("evaluations", Some(1.0)),
        ),
        ("runs", "has no column `status`", of_table("runs", |frame| frame.drop("status").unwrap())),
        (
            "runs",
            "not finite in the column `x`",
            of_table("runs", |frame| with(frame, list("x", &[f64::NAN; 12]))),
        ),
        ("traces", "not finite in the column `j`", in_trace("j", f64::NAN)),
        ("traces", "out of order", in_trace("j", 1e9)),
        ("traces", "has no trace of the run", of_table("traces", |frame| frame.head(Some(0)))),
        (
            "clocks",
            "does not have the rows of the batch's traces",
            of_table("clocks", |frame| frame.head(Some(1))),
        ),
        ("runs", "is no table that can be read", of_file("runs", |f| fs::write(f, "").unwrap())),
        ("clocks", "is not a file", of_file("clocks", |file| fs::create_dir(file).unwrap())),
        #[cfg(unix)]
        (
            "traces",
            "is a link that leads nowhere",
            of_file("traces", |file| std::os::unix::fs::symlink("nowhere", file).unwrap()),
        ),
        #[cfg(unix)]
        (
            "traces",
            "is a link that leads nowhere",
            of_file("traces", |file| std::os::unix::fs::symlink(file, file).unwrap()),
        ),
    ]
}

#[test]
fn what_no_run_leaves_is_named_and_done_again() {
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path();
    let folder = create(path, FEW);
    run(&folder);
    let whole = tables(&folder);
    let names: Vec<String> = folder.plan.runs.iter().map(|run| run.key.clone()).collect();
    let changes = changes();
    for (n, (table, reason, change)) in (1..).zip(&changes) {
        change(path, &names);
        let folder = open(path);
        assert_eq!(load(&folder.plan, &folder.store).unwrap().len(), 5, "{reason}");
        let standing = standing(&folder.plan, &folder.store).unwrap();
        assert_eq!((standing.tallies[0].stored, standing.tallies[0].missing()), (2, 1), "{reason}");
        let damaged = folder.store.damaged();
        let at_fault = path.join(table).join(format!("{}.parquet", names[0]));
        assert_eq!(damaged.iter().map(|d| &d.path).collect::<Vec<_>>(), [&at_fault], "{reason}");
        assert!(damaged[0].reason.contains(reason), "{}, not {reason}", damaged[0].reason);
        if n == changes.len() {
            // Compaction takes the others together and leaves this one where it is.
            let done = folder.store.compact(&Watch::default()).unwrap().unwrap();
            assert_eq!((done.before, done.after), (6, 2));
            assert!(fs::symlink_metadata(&at_fault).is_ok());
        }
        assert_eq!(run(&open(path)), damaged);
        let number = if n == 1 { String::new() } else { format!("-{n}") };
        let aside = path.join(format!("damaged/{}{number}", names[0]));
        assert_eq!(fs::read_dir(aside).unwrap().count(), 3, "{reason}");
        assert_eq!(tables(&open(path)), whole, "{reason}");
    }
}

/// A file that the system does not let us read may be whole: it is named, and nothing is set aside or done instead.
#[cfg(target_os = "linux")]
#[test]
fn what_may_be_whole_stays_where_it_is() {
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path();
    let folder = create(path, FEW);
    run(&folder);
    // Batches are looked through in the order of their names: the damaged one comes first.
    let mut files = files(path);
    files.retain(|file| file.parent().unwrap().ends_with("runs"));
    let [damaged, .., file] = &files[..] else { panic!("{files:?}") };
    fs::write(damaged, "").unwrap();
    fs::remove_file(file).unwrap();
    // A file that gives an input/output error to whoever reads it.
    std::os::unix::fs::symlink("/proc/self/mem", file).unwrap();
    let folder = open(path);
    assert_eq!(load(&folder.plan, &folder.store).unwrap().len(), 4);
    let told: Vec<_> = folder
        .store
        .damaged()
        .into_iter()
        .map(|damage| (damage.path, damage.may_be_whole))
        .collect();
    assert_eq!(told, [(damaged.clone(), false), (file.clone(), true)]);
    let outcome = open(path).run(Options::default(), &Watch::default(), &());
    assert!(outcome.unwrap_err().to_string().contains("cannot be read"));
    assert!(file.is_symlink() && damaged.is_file() && !path.join("damaged").exists());
}
