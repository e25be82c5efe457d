//! Stored tables, as any reader of Parquet sees them.

use std::fs::File;
use std::path::Path;

use polars::prelude::*;

/// What two experiments that are the same may differ in: wall times, and with how many others they were taken.
const MEASURED: [&str; 4] = ["seconds", "seconds_in_problem", "threads", "date"];

/// All rows of a table, whatever files they stand in, sorted by run and evaluation, without what
/// was measured.
pub(crate) fn read(results: &Path, table: &str) -> DataFrame {
    let mut all = DataFrame::empty();
    for entry in std::fs::read_dir(results.join(table)).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "parquet") {
            let file = File::open(path).unwrap();
            all.vstack_mut_owned(ParquetReader::new(file).finish().unwrap()).unwrap();
        }
    }
    all.rechunk_mut();
    let all = all.drop_many(MEASURED);
    let by = ["key", "evaluation"].into_iter().filter(|name| all.column(name).is_ok());
    all.sort(by.collect::<Vec<_>>(), SortMultipleOptions::default()).unwrap()
}

/// The keys of a table's rows.
pub(crate) fn keys(table: &DataFrame) -> Vec<String> {
    let keys = table.column("key").unwrap().str().unwrap();
    keys.iter().map(|key| key.unwrap().to_owned()).collect()
}
