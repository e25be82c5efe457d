"""The tables of `driftless report`, against the stored runs and against cocopp."""

import re

import numpy as np
import polars as pl

from stored import expected_running_time

# The targets of the distribution of running times: differences from the optimum, as COCO has them.
DIFFERENCES = [10 ** (2 - i / 5) for i in range(51)]


def read(path):
    return pl.read_csv(path, schema_overrides={"instance": pl.String, "group": pl.String}).with_columns(
        pl.col("^instance|group$").fill_null("")
    )


def compare(folder, table, optima, data_sets, tally):
    """Expected running times and successes of every group, target and optimiser; the distribution of
    running times, restarts left aside, since they are drawn."""
    costs = {}
    for row in read(folder / "targets.csv").iter_rows(named=True):
        group = re.sub(r" instance=\d+$", "", row["instance"])
        if costs.setdefault((group, row["target"]), row["cost"]) != row["cost"]:
            raise SystemExit(f"several targets {row['target']} on {group}")
    for row in read(folder / "fixed-target.csv").iter_rows(named=True):
        compare_row(row, costs, table, optima, data_sets, tally)
    for row in read(folder / "running-time-distribution.csv").iter_rows(named=True):
        group, optimiser, evaluations = row["group"], row["optimiser"], row["evaluations"]
        if group == "all":
            mine = [(g, trials) for (g, o), trials in table.items() if o == optimiser]
        else:
            mine = [(group, table[group, optimiser])]
        reached = [
            trial.best_at(evaluations) <= optima[g] + difference
            for g, trials in mine
            for trial in trials
            for difference in DIFFERENCES
        ]
        where = f"{group} {optimiser} at {evaluations}"
        tally["report: distribution"].compare(row["share of runs"], np.mean(reached), where)


def compare_row(row, costs, table, optima, data_sets, tally):
    group, optimiser, ert = row["group"], row["optimiser"], float(row["ERT"])
    cost, trials = costs[group, row["target"]], table[group, optimiser]
    where = f"{group} {optimiser} at {cost}"
    tally["report: expected running times"].compare(ert, expected_running_time(trials, cost), where)
    hits = [trial.hit(cost) for trial in trials]
    successes = int(np.isfinite(hits).sum())
    tally["report: successes"].compare([row["successes"], row["runs"]], [successes, len(hits)], where)
    difference = cost - optima[group]
    # Only where the target is on the grid that cocopp rounds down to.
    if difference > 0 and abs(5 * np.log10(difference) - round(5 * np.log10(difference))) < 1e-12:
        (expected,) = data_sets[group, optimiser].detERT([difference])
        tally["report: expected running times of cocopp"].compare(ert, expected, where)
