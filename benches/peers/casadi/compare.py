"""Runs `scp` and IPOPT, the latter in two forms, from the same starts and prints a table of all."""

import argparse
import json
import subprocess
from pathlib import Path

import casadi
import numpy as np

from derived import derived
from ipopt import Solver
from model import Task, evaluate
from plain import plain

BEST = 0.781850
"""What counts as the best `J` known, 0.7818493."""

ROUNDS = 3
"""How often each solves every start; the fastest counts."""


COLUMNS = {
    "scp": "`scp`",
    "compiled": "IPOPT, hand-derived and compiled",
    "plain": "IPOPT, as written with CasADi",
}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("ours", type=Path, help="the example `starts`, built")
    parser.add_argument("folder", type=Path, help="where compiled code and results go")
    parser.add_argument("starts", type=int, nargs="?", default=100)
    arguments = parser.parse_args()
    task = Task()
    solvers = {
        "compiled": Solver(task, *derived(task, arguments.folder)),
        "plain": Solver(task, *plain(task)),
    }
    found = {name: {} for name in ("scp", *solvers)}
    for _ in range(ROUNDS):
        for seed in range(1, arguments.starts + 1):
            ours = follow(arguments.ours, seed)
            keep_fastest(found["scp"], ours)
            for name, solver in solvers.items():
                keep_fastest(found[name], {"seed": seed, **solver.solve(ours["start"])})
    results = {name: list(by_seed.values()) for name, by_seed in found.items()}
    for name, each in results.items():
        write(arguments.folder / f"{name}.jsonl", each)
    print_table(results)
    print(f"\nCasADi {casadi.__version__}, NumPy {np.__version__}")
    print_scp_check(task, results.pop("scp"))
    for name, each in results.items():
        print_ipopt_checks(task, name, each)


def follow(ours, seed, *more):
    """What the example says of one seed's start."""
    command = [str(part) for part in (ours, 1, seed, *more)]
    return json.loads(subprocess.run(command, capture_output=True, check=True).stdout)


def keep_fastest(results, result, clock="seconds"):
    """Every round finds the same; only what else the machine does makes the times differ."""
    seed = result["seed"]
    if seed not in results or result[clock] < results[seed][clock]:
        results[seed] = result


def write(file, results):
    """Writes a line of JSON for each."""
    file.write_text("".join(json.dumps(result) + "\n" for result in results))


def print_table(results):
    """Times and successes of all, as a Markdown table."""
    times = np.array([[result["seconds"] for result in each] for each in results.values()])
    costs = np.array([[result["j"] for result in each] for each in results.values()])
    quartiles = np.percentile(times, [25, 50, 75], axis=1)
    hits = np.sum(costs <= BEST, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        each_hit = times.sum(axis=1) / hits
        against_ours = each_hit / each_hit[0]
    print_row(f"{times.shape[1]} starts", (COLUMNS[name] for name in results), "")
    print_row("---", ["---"] * len(results), "")
    for name, values in zip(("lower quartile", "median", "upper quartile"), quartiles):
        print_row(f"seconds per start, {name}", values, ".4f")
    print_row("median, in medians of `scp`", quartiles[1] / quartiles[1][0], ".1f")
    print_row(f"starts that end at J ≤ {BEST:.6f}", hits, "d")
    print_row("seconds for each of these", each_hit, ".3f")
    print_row("the same, in those of `scp`", against_ours, ".1f")
    print_row("median J", np.median(costs, axis=1), ".6f")
    print_row("best J", np.min(costs, axis=1), ".7f")


def print_row(name, values, form):
    """One row of a Markdown table."""
    print("|", " | ".join([name, *(format(value, form) for value in values)]), "|")


def print_scp_check(task, ours):
    """Whether the crate and the dense evaluation here agree on the motions of `scp`."""
    shape = (len(task.links), task.terms)
    apart = max(
        abs(evaluate(task, np.reshape(result["coefficients"], shape)).cost(task) - result["j"])
        for result in ours
    )
    print(f"J of scp's motions, fine and by the dense evaluation here: {apart:.0e} apart at most")


def print_ipopt_checks(task, name, results):
    """Whether IPOPT solved the problem that it was to solve."""
    solved = [result for result in results if result["ending"] == "Solve_Succeeded"]
    weight = task.base_weight / np.sin(np.radians(0.5))
    excess = max((result["excess"] for result in solved), default=np.nan)
    good = max((result["excess"] for result in solved if result["j"] < 1), default=np.nan)
    print(f"{COLUMNS[name]} says solved: {len(solved)} of {len(results)}")
    print(f"  median iterations: {np.median([result['iterations'] for result in results]):.0f}")
    seconds, busy = ([result[key] for result in results] for key in ("seconds", "processor_seconds"))
    share = sum(busy) / sum(seconds)
    print(f"  had the processor for {share:.0%} of its seconds")
    print(f"  limits exceeded between the grid's times: t_f short by {excess:.1e} at most,")
    print(f"    where J < 1 by {good:.1e}")
    residual = max((result["residual_deg"] for result in solved), default=np.nan)
    print(f"  residual: {residual:.1e} degrees at most")
    largest = max((result["multiplier"] for result in solved), default=np.nan)
    print(f"  multiplier of the base's error: {largest:.1f} at most; the norm weighs {weight:.1f}")


if __name__ == "__main__":
    main()
