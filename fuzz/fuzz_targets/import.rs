//! Data of other tools: read, or refused with an error; what is read is planned or refused, and written and read again as the same
//! plan.
#![no_main]

use std::fs;

use driftless::experiment::{DataFormat, Experiment};
use driftless::import::read;
use driftless::input::Document;
use driftless::registry;
use libfuzzer_sys::fuzz_target;

// The first byte is the format; what stands behind the first zero is the table that an index may name.
fuzz_target!(|bytes: &[u8]| {
    let [which, bytes @ ..] = bytes else { return };
    let (format, index) = match which % 3 {
        0 => (DataFormat::Ioh, "IOHprofiler_f1.json"),
        1 => (DataFormat::Coco, "f1.info"),
        _ => (DataFormat::Csv, "runs.csv"),
    };
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    let held = tempfile::tempdir().expect("a folder");
    let folder = held.path();
    fs::write(folder.join(index), &bytes[..end]).expect("an index");
    let table = bytes.get(end + 1..).unwrap_or_default();
    for name in ["a.dat", "a.tdat"] {
        fs::write(folder.join(name), table).expect("a table");
    }
    let Ok(found) = read(format, &folder.join(index)) else { return };
    let Ok(plan) = found.foreign.experiment("imported").and_then(|experiment| experiment.plan())
    else {
        return;
    };
    assert_eq!(plan.runs.len(), found.foreign.runs.len());
    let written = plan.experiment.to_toml().expect("what was planned can be written");
    let again = Experiment::read(&Document::embedded("again.toml", &written), &registry());
    let again = again.and_then(|experiment| experiment.plan()).expect("and read and planned");
    let same = again.runs.iter().zip(&plan.runs).all(|(a, b)| a.key == b.key);
    assert!(same && again.runs.len() == plan.runs.len());
});
