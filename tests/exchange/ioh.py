"""The IOHprofiler files as iohinspector reads them."""

import iohinspector
import numpy as np
import polars as pl
from iohinspector.metrics import aggregate_running_time, get_data_ecdf, get_eaf_data

from stored import expected_running_time


def compare(folder, table, tally):
    """Every number of the files, and iohinspector's running times, ECDF and EAF."""
    manager = iohinspector.DataManager()
    manager.add_folder(str(folder))
    runs = manager.overview
    rows = manager.load(monotonic=False, include_meta_data=True)
    falling = manager.load(monotonic=True, include_meta_data=True)
    tally["ioh: runs"].compare(len(runs), sum(map(len, table.values())), "runs")
    for (group, optimiser), trials in table.items():
        here = pl.col("group").str.split("; ").list.contains(group)
        here &= pl.col("algorithm_name") == optimiser
        if "dimension=" in group:
            here &= pl.col("dimension") == int(group.rpartition("dimension=")[2])
        where = f"{group} {optimiser}"
        order = compare_rows(runs.filter(here), rows.filter(here), trials, tally, where)
        data = falling.filter(here)
        compare_running_times(data, order, tally, where)
        compare_curves(data, order, tally, where)


def compare_rows(runs, rows, trials, tally, where):
    """Overview and rows of every run; gives the trials in the order of `data_id`."""
    instances = sorted({trial.instance for trial in trials}, key=instance_number)
    # Runs stand in the order of instances, whatever their numbers.
    numbers = list(dict.fromkeys(runs.sort("data_id")["instance"]))
    if len(numbers) != len(instances):
        raise SystemExit(f"{where}: {len(numbers)} instances instead of {len(instances)}")
    of = dict(zip(instances, numbers))
    expected = {(of[trial.instance], trial.seed): trial for trial in trials}
    order = {}
    for run in runs.iter_rows(named=True):
        mine = rows.filter(pl.col("data_id") == run["data_id"])
        (seed,) = mine["seed"].unique()
        if (run["instance"], int(seed)) not in expected:
            raise SystemExit(f"{where}: no run on instance {run['instance']} with seed {seed}")
        trial = order[run["data_id"]] = expected.pop((run["instance"], int(seed)))
        at, cost = trial.at, trial.cost
        if not len(at) or at[0] > 1:
            at, cost = np.insert(at, 0, 1), np.insert(cost, 0, np.inf)
        if at[-1] < trial.evaluations:
            at, cost = np.append(at, trial.evaluations), np.append(cost, cost[-1])
        best = run["best_y"] if run["best_y"] is not None else np.inf
        tally["ioh: overview"].compare([run["evals"], best], [trial.evaluations, cost[-1]], where)
        tally["ioh: rows"].compare(mine["evaluations"], at, where)
        tally["ioh: rows"].compare(mine["raw_y"], cost, where)
    if expected:
        raise SystemExit(f"{where}: {len(expected)} runs are missing")
    return [order[key] for key in sorted(order)]


def instance_number(label):
    """Of a label that ends with `instance=NUMBER`."""
    _, _, number = label.rpartition("instance=")
    return int(number) if number.isdigit() else label


def compare_running_times(data, trials, tally, where):
    """iohinspector charges every failure the same."""
    finite = data.filter(pl.col("raw_y").is_finite() & (pl.col("raw_y") > 0))["raw_y"]
    if finite.is_empty():
        return
    charge = 12345
    table = aggregate_running_time(
        data, f_min=finite.min() / 2, f_max=finite.max(), eval_max=charge, return_as_pandas=False
    )
    for row in table.iter_rows(named=True):
        target = row["raw_y"]
        expected = expected_running_time(trials, target, charge)
        tally["ioh: running times"].compare(row["ERT"], expected, f"{where} at {target}")
        hits = sum(np.isfinite(trial.hit(target)) for trial in trials)
        tally["ioh: success rates"].compare(row["success_ratio"], hits / len(trials), where)


def compare_curves(data, trials, tally, where):
    """ECDF over costs from 1e-8 to 1e4 on a logarithmic scale, and best cost by evaluation."""
    last = max(trial.evaluations for trial in trials)
    marks = np.unique(np.geomspace(1, last, 30).astype(int))
    ecdf = get_data_ecdf(
        data, f_min=1e-8, f_max=1e4, eval_values=marks.tolist(), return_as_pandas=False
    )
    costs = np.array([[trial.best_at(mark) for trial in trials] for mark in marks])
    with np.errstate(divide="ignore"):
        height = 1 - np.clip((np.log10(costs) + 8) / 12, 0, 1)
    tally["ioh: ECDF"].compare(ecdf.sort("evaluations")["eaf"], height.mean(axis=1), where)
    surface = get_eaf_data(data, return_as_pandas=False).sort("data_id", "evaluations")
    expected = [
        trial.best_at(mark) for trial in trials for mark in surface["evaluations"].unique().sort()
    ]
    tally["ioh: EAF"].compare(surface["raw_y"], expected, where)
