"""Runs `scp` and IPOPT, the latter in two forms, from the same starts of free-form motions and prints tables."""

import argparse
from pathlib import Path

import casadi
import numpy as np

from compare import COLUMNS, follow, keep_fastest, print_row, write
from model import Spline, Task
from shooting import Program, Shooting, densely

ROUNDS = 2
"""How often each solves every start; the fastest counts."""

CLOCK = "processor_seconds"
"""The seconds that count: those on the processor, so that what else the machine does matters little."""

SAME = 1e-5
"""Durations that differ by less than this share are one."""

REACHED_DEG = 1e-3
"""A residual below it, by the dense evaluation, is none; the discretisation leaves less."""

ENDED = {"optimal": "optimal", "Solve_Succeeded": "optimal"}
"""What says that a start was followed to its end."""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("ours", type=Path, help="the example `starts`, built")
    parser.add_argument("folder", type=Path, help="where compiled code and results go")
    parser.add_argument("starts", type=int, nargs="?", default=10)
    parser.add_argument("pieces", type=int, nargs="*", default=[20, 40])
    arguments = parser.parse_args()
    task = Task()
    for pieces in arguments.pieces or [20, 40]:
        compare(task, arguments, pieces)
    print(f"CasADi {casadi.__version__}, NumPy {np.__version__}")


def compare(task, arguments, pieces):
    """Every start in turn with this number of pieces."""
    program = Program(task, pieces)
    solvers = {
        "compiled": Shooting(task, program, program.derived(arguments.folder)),
        "plain": Shooting(task, program, program.plain()),
    }
    found = {name: {} for name in ("scp", *solvers)}
    for _ in range(ROUNDS):
        for seed in range(1, arguments.starts + 1):
            ours = follow(arguments.ours, seed, pieces)
            keep_fastest(found["scp"], judged(task, ours), CLOCK)
            for name, solver in solvers.items():
                result = solver.solve(ours["start_points"])
                keep_fastest(found[name], {"seed": seed, **result}, CLOCK)
    results = {name: list(by_seed.values()) for name, by_seed in found.items()}
    for name, each in results.items():
        write(arguments.folder / f"free-form-{pieces}-{name}.jsonl", each)
    print(f"\n## {pieces} pieces\n")
    print_starts(results)
    print()
    print_summary(results)
    print()
    print_check(task, solvers["compiled"], results["scp"])
    for name in solvers:
        print_ipopt_check(COLUMNS[name], results[name])


def judged(task, ours):
    """A result of `scp` with duration and residual by the dense evaluation, as IPOPT's have them."""
    motion = densely(task, Spline.of_points(ours["points"]))
    own = {"crate_t_f": ours["t_f"], "crate_residual_deg": ours["residual_deg"]}
    return {**ours, **own, "t_f": motion.shortest, "residual_deg": motion.residual_deg()}


def print_starts(results):
    """What every start came to, as a Markdown table."""
    parts = ["residual [°]", "ending", "seconds"]
    heads = [part for name in results for part in (f"{COLUMNS[name]}: t_f [s]", *parts)]
    print_row("start", heads, "")
    print_row("---", ["---"] * len(heads), "")
    for row in zip(*results.values()):
        cells = [
            [f"{r['t_f']:.6f}", f"{r['residual_deg']:.0e}", ending(r), f"{r[CLOCK]:.3f}"]
            for r in row
        ]
        print_row(str(row[0]["seed"]), sum(cells, []), "")


def ending(result):
    """What a solver says of its end, in one word where it is a minimum."""
    return ENDED.get(result["ending"], result["ending"])


def has_ended(result):
    """Whether a start was followed to a motion that reaches the goal."""
    return result["ending"] in ENDED and result["residual_deg"] < REACHED_DEG


def print_summary(results):
    """Times, and durations beside those of `scp`, as a Markdown table."""
    ours = results["scp"]
    times = {name: np.array([r[CLOCK] for r in each]) for name, each in results.items()}
    ended = {name: np.array([has_ended(r) for r in each]) for name, each in results.items()}
    durations = {name: np.array([r["t_f"] for r in each]) for name, each in results.items()}
    best = min(np.min(durations[name][ended[name]], initial=np.inf) for name in results)
    hits = {name: ended[name] & (durations[name] <= best * (1 + SAME)) for name in results}
    quotients = {name: times[name] / times["scp"] for name in results}
    both = {name: ended[name] & ended["scp"] for name in results}
    shares = {name: (durations[name] / durations["scp"] - 1)[both[name]] for name in results}
    with np.errstate(divide="ignore"):
        each_hit = {name: times[name].sum() / np.sum(hits[name]) for name in results}
    rows = [
        ("seconds per start, median", "{:.3f}", lambda name: np.median(times[name])),
        ("seconds, in those of `scp` from the same start: least", "{:.1f}",
         lambda name: np.min(quotients[name])),
        ("— median", "{:.1f}", lambda name: np.median(quotients[name])),
        ("— most", "{:.1f}", lambda name: np.max(quotients[name])),
        ("starts that end at an optimum that reaches the goal", "{:d}",
         lambda name: np.sum(ended[name])),
        ("of those where `scp` does too, t_f shorter than by `scp`", "{:d}",
         lambda name: np.sum(shares[name] < -SAME)),
        ("— equal within 1e-5", "{:d}", lambda name: np.sum(np.abs(shares[name]) <= SAME)),
        ("— longer", "{:d}", lambda name: np.sum(shares[name] > SAME)),
        (f"starts that end at t_f ≤ {best * (1 + SAME):.5f} s, the best", "{:d}",
         lambda name: np.sum(hits[name])),
        ("seconds for each of these", "{:.3f}", lambda name: each_hit[name]),
        ("median t_f [s]", "{:.6f}", lambda name: np.median(durations[name])),
        ("best t_f [s]", "{:.6f}", lambda name: np.min(durations[name])),
    ]
    print_row(f"{len(ours)} starts", (COLUMNS[name] for name in results), "")
    print_row("---", ["---"] * len(results), "")
    for title, form, value in rows:
        print_row(title, [form.format(value(name)) for name in results], "")


def print_check(task, solver, ours):
    """Whether the crate, the dense evaluation and the program agree on the same control points."""
    ends, durations, defects = [], [], []
    for result in ours:
        guess = solver.guess(Spline.of_points(result["start_points"]))
        ends.append(np.abs(guess[-5:-1] - result["start_end"]).max())
        durations.append(abs(guess[-1] - result["start_t_f"]))
        defects.append(np.abs(solver.defects(guess)).max())
    print("From the starts' control points, by the program and by the crate:")
    print(f"  quaternions at the end {max(ends):.0e} apart at most,")
    print(f"  shortest durations {max(durations):.0e} s; the program's defects {max(defects):.0e}")
    apart = max(abs(result["t_f"] - result["crate_t_f"]) for result in ours)
    missed = max(abs(result["residual_deg"] - result["crate_residual_deg"]) for result in ours)
    print(f"scp's motions, by the dense evaluation and by the crate: t_f {apart:.0e} s apart at most,")
    print(f"  residuals {missed:.0e} degrees")


def print_ipopt_check(title, results):
    """Whether IPOPT solved the problem that it was to solve."""
    solved = [result for result in results if result["ending"] in ENDED]
    best = min((result["t_f"] for result in solved), default=np.nan)
    near = [result for result in solved if result["t_f"] <= best * (1 + SAME)]

    def most(key, results=solved):
        return max((abs(result[key]) for result in results), default=np.nan)

    print(f"{title} says solved: {len(solved)} of {len(results)}")
    print(f"  median iterations: {np.median([result['iterations'] for result in results]):.0f}")
    print(f"  residual {most('residual_deg'):.0e} degrees, joints miss by {most('joints_miss'):.0e} rad")
    print(f"  limits exceeded between the program's times: t_f short by {most('excess'):.0e} at most,")
    print(f"    by {most('excess', near):.0e} where it is the best")


if __name__ == "__main__":
    main()
