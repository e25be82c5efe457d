"""Compares stored tables with what other tools read in the exported files: compare.py RESULTS [TABLE.csv …].

RESULTS has a folder for each experiment, with `stored`, `ioh` and `coco` in it. A table EXPERIMENT.csv of the
program's own expected running times, columns group, optimiser, target and ert, is compared, too.
"""

import sys
from collections import defaultdict
from pathlib import Path

import polars as pl

import coco
import ioh
import stored
from tally import Tally

LARGEST = 1e-9


def compare_table(path, table, tally):
    """A CSV file with the columns group, optimiser, target and ert, which is `inf` without success."""
    for row in pl.read_csv(path, schema_overrides={"group": pl.String}).iter_rows(named=True):
        group, optimiser, target = row["group"] or "", row["optimiser"], row["target"]
        expected = stored.expected_running_time(table[group, optimiser], target)
        where = f"{group} {optimiser} at {target}"
        tally["table: expected running times"].compare(float(row["ert"]), expected, where)


def main(results, *tables):
    tally = defaultdict(Tally)
    tables = {Path(path).stem: path for path in tables}
    for folder in sorted(Path(results).iterdir()):
        table = stored.trials(folder / "stored")
        ioh.compare(folder / "ioh", table, tally)
        coco.compare(folder / "coco", table, stored.optima(folder.name, table), tally)
        if folder.name in tables:
            compare_table(tables.pop(folder.name), table, tally)
    if tables:
        raise SystemExit(f"no experiment for {', '.join(tables)}")
    width = max(map(len, tally))
    for name, counted in tally.items():
        print(f"{name:{width}} {counted.count:8} {counted.largest:10.1e}  {counted.where}")
    count, largest = sum(t.count for t in tally.values()), max(t.largest for t in tally.values())
    print(f"{count} comparisons, largest relative difference {largest:.1e}")
    return largest <= LARGEST


if __name__ == "__main__":
    sys.exit(not main(*sys.argv[1:]))
