"""Runs `scp` and IPOPT from the same starts, in turns, and prints a table of both."""

import argparse
import json
import subprocess
from pathlib import Path

import casadi
import numpy as np

from ipopt import Solver
from model import Task, evaluate

BEST = 0.781850
"""What counts as the best `J` known, 0.7818493."""

ROUNDS = 3
"""How often each solves every start; the fastest counts."""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("ours", type=Path, help="the example `peer_ours`, built")
    parser.add_argument("folder", type=Path, help="where compiled code and results go")
    parser.add_argument("starts", type=int, nargs="?", default=100)
    arguments = parser.parse_args()
    task = Task()
    solver = Solver(task, arguments.folder)
    ours, ipopt = {}, {}
    for _ in range(ROUNDS):
        for seed in range(1, arguments.starts + 1):
            keep_fastest(ours, seed, follow(arguments.ours, seed))
            keep_fastest(ipopt, seed, {"seed": seed, **solver.solve(ours[seed]["start"])})
    ours, ipopt = list(ours.values()), list(ipopt.values())
    for name, results in (("scp", ours), ("ipopt", ipopt)):
        lines = [json.dumps(result) for result in results]
        (arguments.folder / f"{name}.jsonl").write_text("\n".join(lines) + "\n")
    print_table(ours, ipopt)
    print_checks(task, ours, ipopt)


def follow(ours, seed):
    """What the example says of one seed's start."""
    output = subprocess.run([ours, "1", str(seed)], capture_output=True, check=True)
    return json.loads(output.stdout)


def keep_fastest(results, seed, result):
    """Every round finds the same; only what else the machine does makes the times differ."""
    if seed not in results or result["seconds"] < results[seed]["seconds"]:
        results[seed] = result


def print_table(ours, ipopt):
    """Times and successes of both, as a Markdown table."""
    times = [[result["seconds"] for result in results] for results in (ours, ipopt)]
    costs = [[result["j"] for result in results] for results in (ours, ipopt)]
    hits = [sum(cost <= BEST for cost in values) for values in costs]
    quartiles = np.percentile(times, [25, 50, 75], axis=1)
    names = ("lower quartile", "median", "upper quartile")
    print(f"| {len(ours)} starts | `scp` | IPOPT | `scp` / IPOPT |\n|---|---|---|---|")
    for name, (a, b) in zip(names, quartiles):
        print(f"| seconds a start, {name} | {a:.4f} | {b:.4f} | {a / b:.2f} |")
    a, b = (sum(t) / hit if hit else np.inf for t, hit in zip(times, hits))
    print(f"| starts that end at J ≤ {BEST:.6f} | {hits[0]} | {hits[1]} | |")
    print(f"| seconds for each of these | {a:.3f} | {b:.3f} | {a / b:.2f} |")
    print("| median J | {:.6f} | {:.6f} | |".format(*np.median(costs, axis=1)))
    print("| best J | {:.7f} | {:.7f} | |".format(*np.min(costs, axis=1)))


def print_checks(task, ours, ipopt):
    """Whether both solved the problem that they were to solve."""
    shape = (len(task.links), task.terms)
    apart = max(
        abs(evaluate(task, np.reshape(result["coefficients"], shape)).cost(task) - result["j"])
        for result in ours
    )
    solved = [result for result in ipopt if result["ending"] == "Solve_Succeeded"]
    weight = task.base_weight / np.sin(np.radians(0.5))
    excess = max((result["excess"] for result in solved), default=np.nan)
    good = max((result["excess"] for result in solved if result["j"] < 1), default=np.nan)
    print(f"\nCasADi {casadi.__version__}, NumPy {np.__version__}")
    print(f"J of scp's motions, fine and by the dense evaluation here: {apart:.0e} apart at most")
    print(f"IPOPT says solved: {len(solved)} of {len(ipopt)}")
    print(f"  median iterations: {np.median([result['iterations'] for result in ipopt]):.0f}")
    print(f"  limits exceeded between the grid's times: t_f short by {excess:.1e} at most,")
    print(f"    where J < 1 by {good:.1e}")
    residual = max((result["residual_deg"] for result in solved), default=np.nan)
    print(f"  residual: {residual:.1e} degrees at most")
    largest = max((result["multiplier"] for result in solved), default=np.nan)
    print(f"  multiplier of the base's error: {largest:.1f} at most; the norm weighs {weight:.1f}")


if __name__ == "__main__":
    main()
