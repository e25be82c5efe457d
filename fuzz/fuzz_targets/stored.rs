//! A folder of stored runs with bytes of one file changed: runs are read as they were or not at all, and nothing panics.
#![no_main]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use driftless::experiment::{Experiment, Folder, Options, Plan, load};
use driftless::input::Document;
use driftless::registry;
use driftless::search::Watch;
use libfuzzer_sys::fuzz_target;

const EXPERIMENT: &str = "name = 'stored'\nseeds = 2\nbudget = { evaluations = 600 }\n\
    [functions]\nname = ['sphere']\ndimension = [2]\n[[optimiser]]\nde = {}\n";

struct Stored {
    _folder: tempfile::TempDir,
    path: PathBuf,
    files: Vec<PathBuf>,
    costs: BTreeMap<u64, u64>,
}

fn plan() -> Plan {
    let document = Document::embedded("stored.toml", EXPERIMENT);
    Experiment::read(&document, &registry()).expect("an experiment").plan().expect("a plan")
}

static STORED: LazyLock<Stored> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("results");
    let results = Folder::create(&path, plan()).expect("a folder of results");
    results.run(Options::default(), &Watch::default(), &()).expect("runs");
    let mut files = Vec::new();
    for part in ["runs", "traces", "clocks"] {
        let entries = fs::read_dir(path.join(part)).expect("tables");
        files.extend(entries.map(|entry| entry.expect("a table").path()));
    }
    files.sort();
    let costs = costs(&path).expect("sound runs");
    Stored { _folder: folder, path, files, costs }
});

/// Bits of the costs that are read, by seed.
fn costs(path: &Path) -> Option<BTreeMap<u64, u64>> {
    let results = Folder::open(path, &registry()).ok()?;
    let runs = load(&results.plan, &results.store).ok()?;
    Some(runs.iter().map(|run| (run.seed, run.cost.to_bits())).collect())
}

fuzz_target!(|bytes: &[u8]| {
    let [which, at @ .., value] = bytes else { return };
    let Ok(at) = <[u8; 2]>::try_from(at) else { return };
    let stored = &*STORED;
    let file = &stored.files[usize::from(*which) % stored.files.len()];
    let sound = fs::read(file).expect("a table");
    let mut damaged = sound.clone();
    let at = usize::from(u16::from_le_bytes(at)) % damaged.len();
    damaged[at] ^= value;
    fs::write(file, damaged).expect("a damaged table");
    let found = costs(&stored.path).unwrap_or_default();
    fs::write(file, &sound).expect("a sound table");
    for (seed, cost) in found {
        assert_eq!(stored.costs.get(&seed), Some(&cost), "{} byte {at}", file.display());
    }
});
