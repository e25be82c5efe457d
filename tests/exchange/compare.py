"""Compares stored tables with what other tools read in the exported files, and with the program's own
tables: compare.py RESULTS. It has a folder for each experiment, with `stored`, `ioh` and `coco` in it.
"""

import sys
from collections import defaultdict
from pathlib import Path

import coco
import ioh
import report
import stored
from tally import Tally

LARGEST = 1e-9


def main(results):
    tally = defaultdict(Tally)
    for folder in sorted(Path(results).iterdir()):
        table = stored.trials(folder / "stored")
        optima = stored.optima(folder.name, table)
        ioh.compare(folder / "ioh", table, tally)
        data_sets = coco.compare(folder / "coco", table, optima, tally)
        report.compare(folder / "stored" / "tables", table, optima, data_sets, tally)
    width = max(map(len, tally))
    for name, counted in tally.items():
        print(f"{name:{width}} {counted.count:8} {counted.largest:10.1e}  {counted.where}")
    count, largest = sum(t.count for t in tally.values()), max(t.largest for t in tally.values())
    print(f"{count} comparisons, largest relative difference {largest:.1e}")
    return largest <= LARGEST


if __name__ == "__main__":
    sys.exit(not main(*sys.argv[1:]))
