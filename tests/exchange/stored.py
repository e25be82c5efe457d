"""What the stored tables say, without the program and without the formats under test."""

import re
import tomllib
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import polars as pl

BEST_KNOWN = Path(__file__).parents[2] / "results" / "best-known.toml"


@dataclass
class Trial:
    """One run: evaluations spent, and its improvements with the last evaluation."""

    instance: str
    seed: int
    evaluations: int
    at: np.ndarray
    cost: np.ndarray

    def hit(self, target):
        """The evaluation that first reached the target; infinite where none did."""
        reached = self.cost <= target
        return self.at[np.argmax(reached)] if reached.any() else np.inf

    def best_at(self, evaluation):
        """The best cost after so many evaluations; infinite where none was finite."""
        made = np.searchsorted(self.at, evaluation, side="right")
        return self.cost[made - 1] if made else np.inf


def trials(folder):
    """The trials of every group and optimiser."""
    runs = pl.read_parquet(folder / "runs/**/*.parquet")
    traces = pl.read_parquet(folder / "traces/**/*.parquet").sort("key", "evaluation")
    traces = {key: rows for (key,), rows in traces.group_by("key", maintain_order=True)}
    table = defaultdict(list)
    for run in runs.sort("problem", "instance", "optimiser", "seed").iter_rows(named=True):
        rows = traces.get(run["key"])
        at, cost = ([], []) if rows is None else (rows["evaluation"], rows["j"])
        group = re.sub(r" instance=\d+$", "", run["instance"])
        table[group, run["optimiser"]].append(
            Trial(
                run["instance"],
                run["seed"],
                run["evaluations"],
                np.array(at, dtype=float),
                np.array(cost, dtype=float),
            )
        )
    return dict(table)


def expected_running_time(trials, target, failure=None):
    """All evaluations until the target or until the end, for each success. Instead of what it spent a
    failure may be charged a fixed number."""
    hits = [trial.hit(target) for trial in trials]
    successes = np.isfinite(hits).sum()
    if not successes:
        return np.inf
    spent = [
        hit if np.isfinite(hit) else failure or trial.evaluations for hit, trial in zip(hits, trials)
    ]
    return sum(spent) / successes


def optima(name, table):
    """The optimum of every group: zero for test functions, of the paper's task the best known cost, else the
    least found."""
    motions = tomllib.loads(BEST_KNOWN.read_text())["motion"]
    known = {
        f"terms={motion['terms']}": motion["j"]
        for motion in motions
        if "terms" in motion and motion["task"]["robot"] == "xiao2023"
    }
    known[""] = known["terms=2"]
    least = defaultdict(lambda: np.inf)
    for (group, _), trials in table.items():
        costs = [trial.cost[-1] for trial in trials if len(trial.cost)]
        least[group] = min([least[group], *costs])
    return {
        group: 0.0 if name in ("functions", "others") else known.get(group, least[group]) for group, _ in table
    }
